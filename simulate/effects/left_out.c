/* The effects that geometric optics of the cornea alone leaves out, with closed-form estimates. */
#include "simulate/effects/left_out.h"

#include "simulate/eye.h"

#include <math.h>

/* Radius of the Airy disc, 1.22 lambda / D, at 555 nm. */
static double airy_arcmin(const placido_psf *psf) {
  return 1.21966989 * 555e-6 / psf->pupil_mm / PLACIDO_ARCMIN_RAD;
}

/* Blur disc of the eye's defocus between 486 and 555 nm: Thibos et al., Applied Optics 31 (1992)
 * 3594, Rx = 1.68524 - 633.46 / (lambda - 214.102) D; disc = pupil × defocus. */
static double chromatic_arcmin(const placido_psf *psf) {
  double defocus_D = 633.46 / (486 - 214.102) - 633.46 / (555 - 214.102);
  return psf->pupil_mm * defocus_D / 1000 / PLACIDO_ARCMIN_RAD;
}

/* Share of the light that cones pick up less than at the pupil's centre: efficiency
 * 10^(-0.05 r²), Applegate and Lakshminarayanan, JOSA A 10 (1993) 1611, averaged over the pupil. */
static double stiles_crawford_share(const placido_psf *psf) {
  double exponent = 0.05 * log(10) * psf->pupil_mm * psf->pupil_mm / 4;
  return 1 - (1 - exp(-exponent)) / exponent;
}

/* Share scattered beyond 1 degree by an eye of 35 years: CIE 135/1 total glare function. */
static double straylight_share(const placido_psf *psf) {
  (void)psf;
  return 0.078;
}

/* Half a minute: the distance of foveal cones. */
static double cone_arcmin(const placido_psf *psf) {
  (void)psf;
  return 0.5;
}

static double unknown(const placido_psf *psf) {
  (void)psf;
  return NAN;
}

static const placido_left_out left_out[] = {
  {"diffraction", "arcmin", "rays, not waves; the estimate is the Airy disc's radius at 555 nm",
   airy_arcmin},
  {"chromatic-aberration", "arcmin",
   "one refractive index; the estimate is the blur disc of 486 nm light in focus at 555 nm",
   chromatic_arcmin},
  {"stiles-crawford", "share",
   "every ray counts alike; the estimate is the light that cones would miss",
   stiles_crawford_share},
  {"object-distance", "D", "everything is seen at infinity", unknown},
  {"rest-of-the-eye", "um", "one refracting surface, no posterior cornea and no lens", unknown},
  {"field", "arcmin", "the spread is that on the axis, for the whole picture", unknown},
  {"straylight", "share",
   "clear media; the estimate is the light scattered beyond 1 degree at 35 years",
   straylight_share},
  {"receptors", "arcmin", "the retina is continuous; the estimate is the distance of foveal cones",
   cone_arcmin},
};

const placido_left_out *placido_left_out_list(size_t *count) {
  *count = sizeof left_out / sizeof *left_out;
  return left_out;
}

double placido_psf_rms_arcmin(const placido_psf *psf) {
  double sum = 0, x = 0, y = 0, square = 0;
  for (int row = 0; row < psf->n; row++) {
    for (int column = 0; column < psf->n; column++) {
      double value = psf->values[(size_t)row * (size_t)psf->n + (size_t)column];
      sum += value;
      x += value * column;
      y += value * row;
      square += value * ((double)column * column + (double)row * row);
    }
  }
  if (!(sum > 0)) {
    return NAN;
  }
  double variance = square / sum - x / sum * (x / sum) - y / sum * (y / sum);
  return sqrt(fmax(variance, 0)) * psf->bucket_arcmin;
}
