/* The schematic eye of Navarro, Santamaria and Bescos (JOSA A 2 (1985) 1273): conicoids, a lens of
 * one index that accommodates, and media that disperse.
 *
 * Indices follow Herzberger's formula from four spectral lines (Applied Optics 8 (1969) 93; the
 * line indices are those of Le Grand's eye). In the paper the second coefficient of the first line
 * lacks a digit: it is -0.40352796, as only with that an index at the line is its own. */
#include "simulate/ocular/navarro.h"

#include <math.h>

enum { LINES = 4, MEDIA = 4 };

/* Weights of the indices at 365, 486.1, 656.3 and 1014 nm: 1, l², 1 / (l² - l0²) and its square, l
 * in micrometres. */
static const double herzberger[LINES][4] = {
  {0.66147196, -0.40352796, -0.28046790, 0.03385979},
  {-4.20146383, 2.73508956, 1.50543784, -0.11593235},
  {6.29834237, -4.69409935, -1.57508650, 0.10293038},
  {-1.75835059, 2.36253794, 0.35011657, -0.02085782},
};
static const double herzberger_um2 = 0.028; /* l0² */

enum medium { CORNEA, AQUEOUS, LENS, VITREOUS };

static const double lines[MEDIA][LINES] = {
  [CORNEA] = {1.3975, 1.3807, 1.37405, 1.3668},
  [AQUEOUS] = {1.3593, 1.3422, 1.3354, 1.3278},
  [LENS] = {1.4492, 1.42625, 1.4175, 1.4097},
  [VITREOUS] = {1.3565, 1.3407, 1.3341, 1.3273},
};

static const double cornea_mm = 0.55, cornea_back_mm = 6.5;

static double index_of(enum medium medium, double wavelength_nm) {
  double square = 1e-6 * wavelength_nm * wavelength_nm, pole = 1 / (square - herzberger_um2);
  double index = 0;
  for (int i = 0; i < LINES; i++) {
    const double *a = herzberger[i];
    index += lines[medium][i] * (a[0] + a[1] * square + a[2] * pole + a[3] * pole * pole);
  }
  return index;
}

placido_navarro placido_navarro_at(double accommodation_D, double wavelength_nm) {
  double a = accommodation_D, grown = log(a + 1);
  double cornea = index_of(CORNEA, wavelength_nm), aqueous = index_of(AQUEOUS, wavelength_nm);
  double lens = index_of(LENS, wavelength_nm) + 9e-5 * (10 * a + a * a);
  double front_mm = cornea_mm + 3.05 - 0.05 * grown, back_mm = front_mm + 4 + 0.1 * grown;
  return (placido_navarro){{
    {cornea_mm, 1 / cornea_back_mm, 0, cornea, aqueous},
    {front_mm, 1 / (10.2 - 1.75 * grown), -3.1316 - 0.34 * grown, aqueous, lens},
    {back_mm, 1 / (-6 + 0.2294 * grown), -1 - 0.125 * grown, lens,
     index_of(VITREOUS, wavelength_nm)},
  }};
}

double placido_navarro_cornea(const placido_navarro *eye) { return eye->surfaces[0].before; }

double placido_navarro_vitreous(const placido_navarro *eye) {
  return eye->surfaces[PLACIDO_NAVARRO_SURFACES - 1].behind;
}

/* Follows the axial point from which or to which light goes: depth `at_mm` in the cornea. */
static double image_mm(const placido_navarro *eye, double at_mm) {
  for (int i = 0; i < PLACIDO_NAVARRO_SURFACES; i++) {
    const placido_conic *s = &eye->surfaces[i];
    double vergence = s->before / (at_mm - s->vertex_mm);
    at_mm = s->vertex_mm + s->behind / (vergence + (s->behind - s->before) * s->curvature);
  }
  return at_mm;
}

double placido_navarro_focus_mm(const placido_navarro *eye, double vergence_D) {
  return image_mm(eye, 1000 * placido_navarro_cornea(eye) / vergence_D);
}

double placido_navarro_cornea_image_mm(const placido_navarro *eye) { return image_mm(eye, 0); }
