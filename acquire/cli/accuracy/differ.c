/* Differences of surfaces, transfer functions and images. */
#include "acquire/cli/accuracy/differ.h"

#include "simulate/quality/otf.h"

#include <math.h>

#define STEP_MM 0.1
#define HALF 30          /* steps to the rim of 6 mm */
#define INNER_MM 0.25    /* radius within which axial power has no place */
#define KERATOMETRIC_D_MM 337.5

/* Transfer functions are compared on rays of the half plane, the other half being its conjugate. */
#define RADII 30
#define STEP_CPD 2.0
#define DIRECTIONS 24
#define PLACES (RADII * DIRECTIONS)
#define SHIFT_STEPS 4

static const double pi = 3.14159265358979323846;

static double axial_D(const placido_jet *jet, double x_mm, double y_mm) {
  const double r = hypot(x_mm, y_mm), slope = (jet->sx * x_mm + jet->sy * y_mm) / r;
  return KERATOMETRIC_D_MM * slope / (r * sqrt(1 + slope * slope));
}

static bool both_at(placido_jet *a, placido_jet *b, const placido_surface *one,
                    const placido_surface *other, double x_mm, double y_mm) {
  return placido_surface_covered(one, x_mm, y_mm) && placido_surface_covered(other, x_mm, y_mm) &&
         placido_surface_at(one, x_mm, y_mm, a) && placido_surface_at(other, x_mm, y_mm, b);
}

struct sums {
  double points, covered, height, height2, powered, power2;
};

static void add_point(struct sums *sums, const placido_surface *one, const placido_surface *other,
                      double x_mm, double y_mm) {
  placido_jet a, b;
  sums->points++;
  if (!both_at(&a, &b, one, other, x_mm, y_mm)) {
    return;
  }
  const double height_um = 1e3 * (b.sag - a.sag);
  sums->covered++;
  sums->height += height_um;
  sums->height2 += height_um * height_um;
  if (hypot(x_mm, y_mm) > INNER_MM) {
    const double power_D = axial_D(&a, x_mm, y_mm) - axial_D(&b, x_mm, y_mm);
    sums->powered++;
    sums->power2 += power_D * power_D;
  }
}

void accuracy_differ_surfaces(double *elevation_um, double *axial, const placido_surface *one,
                              const placido_surface *other) {
  struct sums sums = {0};
  for (int row = -HALF; row <= HALF; row++) {
    for (int column = -HALF; column <= HALF; column++) {
      if (row * row + column * column <= HALF * HALF) {
        add_point(&sums, one, other, STEP_MM * column, STEP_MM * row);
      }
    }
  }
  const bool enough = sums.covered >= 0.5 * sums.points;
  const double mean = sums.height / sums.covered;
  if (elevation_um) {
    *elevation_um = enough ? sqrt(fmax(sums.height2 / sums.covered - mean * mean, 0)) : NAN;
  }
  if (axial) {
    *axial = enough ? sqrt(sums.power2 / sums.powered) : NAN;
  }
}

/* A transfer function where it is compared. */
struct transfer {
  double real[PLACES], imaginary[PLACES];
};

static void place_of(double cpd[2], int place) {
  const double radius = STEP_CPD * (1 + place / DIRECTIONS);
  const double angle = pi * (place % DIRECTIONS) / DIRECTIONS;
  cpd[0] = radius * cos(angle);
  cpd[1] = radius * sin(angle);
}

static int transfer_of(struct transfer *transfer, const placido_psf *psf, placido_error *err) {
  placido_otf otf;
  const int status = placido_otf_new(&otf, psf, err);
  const double finest_cpd = 30.0 / psf->bucket_arcmin;
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int i = 0; i < PLACES; i++) {
    double cpd[2];
    place_of(cpd, i);
    transfer->real[i] = transfer->imaginary[i] = 0;
    if (fmax(fabs(cpd[0]), fabs(cpd[1])) < (1 - 1e-9) * finest_cpd) {
      placido_otf_at(&otf, cpd[0], cpd[1], &transfer->real[i], &transfer->imaginary[i]);
    }
  }
  placido_otf_free(&otf);
  return PLACIDO_OK;
}

/* One at `place` when its image is moved by `shift_deg`. */
static void moved_at(double value[2], const struct transfer *t, int place, const double cpd[2],
                     const double shift_deg[2]) {
  const double phase = -2 * pi * (cpd[0] * shift_deg[0] + cpd[1] * shift_deg[1]);
  const double c = cos(phase), s = sin(phase);
  value[0] = c * t->real[place] - s * t->imaginary[place];
  value[1] = s * t->real[place] + c * t->imaginary[place];
}

/* A step of Gauss and Newton towards the shift of `one` that leaves the least sum of squares. */
static void improve_shift(double shift_deg[2], const struct transfer *one,
                          const struct transfer *other) {
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
  for (int i = 0; i < PLACES; i++) {
    double cpd[2], value[2];
    place_of(cpd, i);
    moved_at(value, one, i, cpd, shift_deg);
    const double power = value[0] * value[0] + value[1] * value[1];
    const double turned = value[0] * other->imaginary[i] - value[1] * other->real[i];
    xx += power * cpd[0] * cpd[0];
    xy += power * cpd[0] * cpd[1];
    yy += power * cpd[1] * cpd[1];
    x -= turned * cpd[0] / (2 * pi);
    y -= turned * cpd[1] / (2 * pi);
  }
  const double determinant = xx * yy - xy * xy;
  if (determinant > 0) {
    shift_deg[0] += (yy * x - xy * y) / determinant;
    shift_deg[1] += (xx * y - xy * x) / determinant;
  }
}

static double largest(const struct transfer *one, const struct transfer *other,
                      const double shift_deg[2]) {
  double most = 0;
  for (int i = 0; i < PLACES; i++) {
    double cpd[2], value[2];
    place_of(cpd, i);
    moved_at(value, one, i, cpd, shift_deg);
    most = fmax(most, hypot(value[0] - other->real[i], value[1] - other->imaginary[i]));
  }
  return most;
}

int accuracy_differ_psfs(double *otf, const placido_psf *one, const placido_psf *other,
                         placido_error *err) {
  struct transfer a, b;
  const double stay_deg[2] = {0, 0};
  double shift_deg[2] = {0, 0};
  *otf = NAN;
  int status = transfer_of(&a, one, err);
  if (status == PLACIDO_OK) {
    status = transfer_of(&b, other, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  for (int i = 0; i < SHIFT_STEPS; i++) {
    improve_shift(shift_deg, &a, &b);
  }
  *otf = fmin(largest(&a, &b, stay_deg), largest(&a, &b, shift_deg));
  return PLACIDO_OK;
}

double accuracy_differ_images(const placido_image *one, const placido_image *other) {
  const size_t count =
      (size_t)one->width_px * (size_t)one->height_px * (size_t)one->planes;
  double most = 0;
  if (one->width_px != other->width_px || one->height_px != other->height_px ||
      one->planes != other->planes) {
    return NAN;
  }
  for (size_t i = 0; i < count; i++) {
    most = fmax(most, fabs((double)one->data[i] - (double)other->data[i]));
  }
  return most;
}
