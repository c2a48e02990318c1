/* Eyes drawn at random and how they are seen: a cornea of one of some families, a topographer that
 * is not quite what its file says, a distance that is not quite known, noise, and mires that are
 * hidden. */
#ifndef PLACIDO_TESTS_STABILITY_DRAWN_EYE_H
#define PLACIDO_TESTS_STABILITY_DRAWN_EYE_H

#include <placido/instrument.h>
#include <placido/mires.h>
#include <placido/reconstruct.h>
#include <placido/surface.h>
#include <placido/uncertainty.h>
#include <stdint.h>

#define DRAWN_FAMILIES 11
#define DRAWN_MERIDIANS 180

/* What goes wrong besides the points' noise. */
enum drawn_source { DRAWN_DISTANCE = 1, DRAWN_GEOMETRY = 2 };

struct drawn_eye {
  int family, number;
  placido_surface *cornea;      /* the truth */
  placido_instrument nominal;   /* as the file has it */
  placido_instrument real;      /* as it is */
  placido_uncertainty geometry; /* that the one was drawn from about the other; may have no modes */
  double axis_z_mm, axis_z_sigma_mm; /* as it was measured */
  double noise_px;
  int hidden;                   /* how mires are hidden: 0 not at all */
  bool rendered;                /* the mires were found in a picture */
  placido_mires mires;
};

/* Of each family as many among `of` eyes as its share says: which one eye `number` belongs to. */
int drawn_family(int number, int of);
const char *drawn_family_name(int family);

/* Draws the eye; `rendered`: as a picture, else as exact points with noise. Returns the status of
 * finding the mires in it. Free with drawn_eye_free in either case. */
int drawn_eye_new(struct drawn_eye *eye, uint64_t seed, int number, int of, int sources,
                  bool rendered);
void drawn_eye_free(struct drawn_eye *eye);

/* The topographer's covariance, as a careful workshop leaves it with the correlations that
 * calibrations have, `size` times as large. Free with placido_uncertainty_free. */
placido_uncertainty drawn_workshop(const placido_instrument *instrument, double size);

/* Moves every point across its edge by noise. */
void drawn_noise(placido_mires *mires, uint64_t seed, uint64_t stream, double sigma_px);

/* The fit as `placido exam` makes it; options->axis_z_mm and the like are filled in. */
int drawn_eye_fit(placido_fit **fit, struct drawn_eye *eye, placido_error *err);

#endif
