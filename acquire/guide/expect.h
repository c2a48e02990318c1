/* Where a cornea of revolution on the instrument's axis shows the mires' edges. */
#ifndef PLACIDO_GUIDE_EXPECT_H
#define PLACIDO_GUIDE_EXPECT_H

#include <placido/instrument.h>

/* A conic: apical radius, asphericity Q (0 a sphere, negative flatter outwards), vertex. */
typedef struct placido_guide_cornea {
  double radius_mm, asphericity;
  double z_mm; /* + towards the camera */
} placido_guide_cornea;

/* Radii in the image, one an edge; NaN for those that it does not mirror into the camera. */
void placido_guide_expect(double *radius_px, const placido_instrument *instrument,
                          const placido_guide_cornea *cornea);

/* How far the centre of the innermost mires moves on the cornea while the eye moves by 1. */
double placido_guide_follow(const placido_instrument *instrument, double radius_mm);

/* Where the camera sees the image point (u, v) in the plane z = 0, mm. */
void placido_guide_place(double place_mm[2], const placido_instrument *instrument,
                         const double uv_px[2]);

#endif
