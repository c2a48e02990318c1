/* What is known of a nominal instrument before any picture: a workshop's and a data sheet's
 * tolerances. */
#include <placido/calibrate.h>

#include <math.h>

#define FOCAL_SHARE 0.02
#define PRINCIPAL_PX 20.0
#define POSITION_MM 0.5
#define POSITION_Z_MM 2.0
#define EDGE_MM 0.2
/* What a term of the distortion moves the picture's corner by. The sixth power is told from the
 * fourth by nothing that a lens of small angle shows. */
static const double DISTORTION_PX[5] = {3, 3, 2, 2, 1};

int placido_calibrate_prior(placido_uncertainty *prior, const placido_instrument *nominal,
                            placido_error *err) {
  int status = placido_uncertainty_new(prior, nominal->edge_count, 0, err);
  if (status) {
    return status;
  }
  const double *f = nominal->focal_px;
  double *s = prior->sigma;
  double corner = 0.5 * hypot(nominal->width_px / f[0], nominal->height_px / f[1]);
  const double power[5] = {3, 5, 2, 2, 7};
  for (int i = 0; i < 2; i++) {
    s[i] = FOCAL_SHARE * f[i];
    s[2 + i] = PRINCIPAL_PX;
    s[9 + i] = POSITION_MM;
  }
  for (int i = 0; i < 5; i++) {
    s[4 + i] = DISTORTION_PX[i] / (f[0] * pow(corner, power[i]));
  }
  /* a telecentric camera sees the same from any distance */
  s[11] = nominal->model == PLACIDO_PINHOLE ? POSITION_Z_MM : 0;
  for (int i = PLACIDO_UNCERTAINTY_CAMERA; i < prior->parameter_count; i++) {
    s[i] = EDGE_MM;
  }
  return PLACIDO_OK;
}
