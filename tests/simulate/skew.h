/* A reference for tests: skew rays one by one through surfaces of revolution, by Newton's method
 * and in steps of its own, so that it has no formula in common with what it is held against. */
#ifndef PLACIDO_TESTS_SKEW_H
#define PLACIDO_TESTS_SKEW_H

#include <stdbool.h>

/* x² + y² + (1 + q) z² = 2 r z behind the vertex; index behind it. */
typedef struct skew_surface {
  double vertex_mm, radius_mm, q, index;
} skew_surface;

enum { SKEW_SURFACES_MAX = 4 };

typedef struct skew_eye {
  int count;
  skew_surface surfaces[SKEW_SURFACES_MAX];
  double retina_mm, retina_radius_mm; /* radius 0: flat */
} skew_eye;

/* A cornea alone; Navarro's eye behind a cornea, by the paper's numbers, with the indices given:
 * cornea, aqueous, lens, vitreous. */
skew_eye skew_cornea(double radius_mm, double q, double index, double retina_mm);
skew_eye skew_navarro(double radius_mm, double q, double accommodation_D, const double index[4],
                      double retina_mm);

/* Indices of those media at 589.3 nm as the paper has them. */
extern const double skew_paper_index[4];

/* A ray from the direction with these tangents through the point `entry_mm` of the plane 3.05 mm
 * behind the vertex: its landing point, direction there, and path from the plane wave through the
 * vertex. False where it does not arrive. */
bool skew_land(const skew_eye *eye, const double tangent[2], const double entry_mm[2],
               double landing[3], double direction[3], double *path_mm);

/* How the chief ray's landing point follows the tangents of the direction, by differences: mm a
 * radian, upside down. */
void skew_follow(const skew_eye *eye, const double tangent[2], double j[2][2]);

/* Power of the whole, dioptres, and where light near the axis is focused. */
double skew_power_D(const skew_eye *eye, double *focus_mm);

#endif
