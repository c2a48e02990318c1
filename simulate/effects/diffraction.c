/* Diffraction: no pupil brings light closer together than its Airy disc, of radius 1.22 wavelengths
 * over its diameter (J. W. Goodman, Introduction to Fourier Optics, 4.4.2). Where aberrations
 * spread it farther, rays do. */
#include "simulate/effects/effect.h"
#include "simulate/eye.h"
#include "simulate/plan/view.h"
#include "simulate/spectrum/spectrum.h"

#include <math.h>
#include <stdio.h>

/* Root mean square distance of the rays from their middle, arcmin. */
static double blur_arcmin(const placido_sketch_rays *rays) {
  double x = 0, y = 0, square = 0, weight = 0;
  for (int i = 0; i < rays->count; i++) {
    double w = (double)rays->weight[i], at_x = (double)rays->angle_x[i];
    double at_y = (double)rays->angle_y[i];
    x += w * at_x;
    y += w * at_y;
    square += w * (at_x * at_x + at_y * at_y);
    weight += w;
  }
  return weight > 0 ? sqrt(fmax(square / weight - (x * x + y * y) / (weight * weight), 0)) : 0;
}

static double airy_arcmin(double pupil_mm, double wavelength_nm) {
  return 1.22 * 1e-6 * wavelength_nm / (pupil_mm * PLACIDO_ARCMIN_RAD);
}

static void ask(const placido_question *question, placido_answer *answer) {
  const double pupil_mm = question->eye->pupil_mm;
  double airy = airy_arcmin(pupil_mm, placido_spectrum_focus_nm(&question->scene->conditions));
  double blur = blur_arcmin(question->rays);
  answer->applies = true;
  answer->strokes->waves = true;
  snprintf(answer->reason, sizeof answer->reason,
           "a point's Airy disc has a radius of %.2f' behind %.1f mm, aberrations alone spread it "
           "over %.2f' (rms)",
           airy, pupil_mm, blur);
}

static int apply(void *state, placido_view *view, placido_error *err) {
  (void)state;
  (void)err;
  view->waves = true;
  return PLACIDO_OK;
}

const placido_effect placido_effect_diffraction = {
  .name = "diffraction",
  .summary = "light is a wave: a small pupil spreads it",
  .stage = PLACIDO_STAGE_PSF,
  .ask = ask,
  .apply = apply,
};
