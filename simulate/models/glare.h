/* Light that the eye scatters: the total glare function of the CIE. */
#ifndef PLACIDO_SIMULATE_GLARE_H
#define PLACIDO_SIMULATE_GLARE_H

#include <placido/eye.h>

/* Where the glare function takes over from light that is traced. */
#define PLACIDO_GLARE_CORE_DEG 0.5
#define PLACIDO_GLARE_END_DEG 90

/* What decides how much an eye scatters. */
typedef struct placido_glare {
  double age_years;
  double pigment; /* p: 0 dark, 0.5 brown, 1 green, 1.2 blue */
} placido_glare;

/* The eye's, with defaults filled in. */
placido_glare placido_glare_of(const placido_eye *eye);

/* Veiling luminance per illuminance from one direction, 1/sr, at `angle_deg` from it (0 to 100):
 * the image of a point, all of it, core and scatter. Divided by 1 + p (0.0417 + 0.055 a), it
 * integrates to 1.01 to 1.03. Source: CIE 135/1 (1999), J. J. Vos and T. J. T. P. van den Berg. */
double placido_glare_per_sr(const placido_glare *glare, double angle_deg);

/* The share of a point's light between two angles, 0 < from_deg < to_deg <= 100: what is above
 * over the sphere. To 1e-6. */
double placido_glare_share(const placido_glare *glare, double from_deg, double to_deg);

/* What is scattered: the glare function beyond the core; within it a parabola that goes on where
 * the function leaves off, with its slope. The function itself grows a hundred thousandfold
 * towards the middle: that is what is traced, and would count twice. Were nothing scattered there,
 * every lamp would have a dark hole around it and a bright ring around that; an even light would
 * be a disc with an edge. What the parabola adds, 5 % of the light at 35 years to the 11 % beyond,
 * is nowhere more than the function has.
 * Per square radian of a picture in which distances from the point are angles; 0 beyond
 * PLACIDO_GLARE_END_DEG. */
double placido_glare_veil(const placido_glare *glare, double angle_deg);

/* The share of a point's light that is scattered: the integral of the veil. */
double placido_glare_veil_share(const placido_glare *glare);

#endif
