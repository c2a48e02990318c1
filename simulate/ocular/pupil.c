/* The pupil for light from any direction: exact rays from a lattice on the cornea, brought to the
 * regular grid of samples. */
#include "simulate/ocular/ocular.h"

#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/ocular/lattice.h"

#include <math.h>

enum { SAMPLES_LEAST = 96, SAMPLES_MOST = 1024, SAMPLES_FEWEST = 8, MARGIN = 3 };
enum { RIM = 64, STEPS_MAX = 8 };

static const double sample_mm = 0.025;    /* as placido_pupil_of_surface */
static const double step_max_mm = 0.05;   /* of the lattice, beyond which it skips detail */
static const double near_enough = 0.02;   /* of the lattice's step */
static const double lost_max = 0.05;      /* share of the samples */
static const double roundness = 0.01;     /* beyond which the rim is drawn as it is */

/* A pupil while it is filled. */
typedef struct filling {
  placido_sight sight;
  placido_lattice lattice;
  double radius_mm;          /* of the disc of samples */
  bool cut;                  /* the rim is not the disc's */
  double entry[2][2];        /* how the place on the cornea follows that in the pupil, about */
  double middle[2];          /* on the cornea */
  int n, threads;
  double spacing_mm;
  double *opd_um, *amplitude;
  double *x_mm, *y_mm;       /* where the light of each sample crosses the entrance pupil */
} filling;

/* Rays of the rim: where they meet the cornea, and where they stand. */
typedef struct rim {
  int count;
  double x_mm[RIM], y_mm[RIM], place[RIM][2];
} rim;

static void trace_rim(rim *r, const placido_sight *sight) {
  double block[PLACIDO_BEAM_COLUMNS * RIM];
  placido_beam beam = placido_beam_of(block, RIM);
  for (int i = 0; i < RIM; i++) {
    double angle = 2 * acos(-1) * i / RIM, radius_mm = sight->pupil_mm / 2;
    placido_sight_aim(sight, &beam, (size_t)i, sight->pupil_x_mm + radius_mm * cos(angle),
                      sight->pupil_y_mm + radius_mm * sin(angle));
  }
  placido_sight_depart(sight, &beam);
  r->count = 0;
  for (int i = 0; i < RIM; i++) {
    placido_standing at = placido_sight_stand(sight, &beam, (size_t)i);
    if (isfinite(at.opd_mm)) {
      r->x_mm[r->count] = beam.x_mm[i];
      r->y_mm[r->count] = beam.y_mm[i];
      r->place[r->count][0] = at.place[0];
      r->place[r->count][1] = at.place[1];
      r->count++;
    }
  }
}

/* The disc that the samples fill. */
static void measure(filling *f, const rim *r) {
  const double *slope = f->sight.incidence.slope;
  double sum = 0, least = INFINITY, most = 0;
  for (int i = 0; i < r->count; i++) {
    double radius_mm = hypot(r->place[i][0], r->place[i][1]);
    sum += radius_mm;
    least = fmin(least, radius_mm);
    most = fmax(most, radius_mm);
  }
  f->radius_mm = r->count > 0 ? sum / r->count : f->sight.pupil_mm / 2;
  f->cut = (slope[0] != 0 || slope[1] != 0) && most - least > roundness * f->radius_mm;
  f->radius_mm = f->cut ? most + f->radius_mm / SAMPLES_LEAST : f->radius_mm;
}

/* The linear map that fits the rim best; the likeness of the pupil where it is not there. */
static void fit_entry(filling *f, const rim *r) {
  double product[2][2] = {{0}}, square[2][2] = {{0}}, mean[4] = {0};
  for (int i = 0; i < r->count; i++) {
    mean[0] += r->x_mm[i] / r->count;
    mean[1] += r->y_mm[i] / r->count;
    mean[2] += r->place[i][0] / r->count;
    mean[3] += r->place[i][1] / r->count;
  }
  for (int i = 0; i < r->count; i++) {
    const double from[2] = {r->place[i][0] - mean[2], r->place[i][1] - mean[3]};
    for (int k = 0; k < 2; k++) {
      product[0][k] += (r->x_mm[i] - mean[0]) * from[k];
      product[1][k] += (r->y_mm[i] - mean[1]) * from[k];
      square[0][k] += from[0] * from[k];
      square[1][k] += from[1] * from[k];
    }
  }
  double det = square[0][0] * square[1][1] - square[0][1] * square[0][1];
  for (int i = 0; i < 2; i++) {
    f->entry[i][0] = (product[i][0] * square[1][1] - product[i][1] * square[0][1]) / det;
    f->entry[i][1] = (product[i][1] * square[0][0] - product[i][0] * square[0][1]) / det;
    f->middle[i] = mean[i] - f->entry[i][0] * mean[2] - f->entry[i][1] * mean[3];
  }
}

/* The samples' grid, and the lattice under it: wider by a tenth, as the map is not linear. */
static int lay_out(filling *f, int samples, placido_error *err) {
  double pupil_mm = 2 * f->radius_mm;
  double asked = fmin(fmax(pupil_mm / sample_mm, SAMPLES_LEAST), SAMPLES_MOST);
  double across = samples > 0 ? fmax(samples, SAMPLES_FEWEST) : ceil(asked);
  f->spacing_mm = pupil_mm / across;
  f->n = (int)across + 2 * MARGIN;
  double low[2], high[2], reach_mm = 1.1 * f->radius_mm + (MARGIN + 1) * f->spacing_mm;
  for (int i = 0; i < 2; i++) {
    double half_mm = reach_mm * hypot(f->entry[i][0], f->entry[i][1]);
    low[i] = f->middle[i] - half_mm;
    high[i] = f->middle[i] + half_mm;
  }
  return placido_lattice_new(&f->lattice, &f->sight, low, high,
                             fmin(f->spacing_mm, step_max_mm), f->threads, err);
}

/* The place on the cornea from which light stands at `place`, found from where that is off for the
 * sample before it; `node` is what is there. False where there is none. */
static bool find_entry(const filling *f, const double place[2], double off_mm[2],
                       placido_node *node) {
  double x = f->middle[0] + f->entry[0][0] * place[0] + f->entry[0][1] * place[1];
  double y = f->middle[1] + f->entry[1][0] * place[0] + f->entry[1][1] * place[1];
  double change_mm = INFINITY;
  for (int step = 0; step < STEPS_MAX && change_mm > near_enough * f->lattice.step_mm; step++) {
    if (!placido_lattice_at(&f->lattice, x + off_mm[0], y + off_mm[1], node)) {
      return false;
    }
    double u = place[0] - node->standing.place[0], v = place[1] - node->standing.place[1];
    double more[2] = {f->entry[0][0] * u + f->entry[0][1] * v,
                      f->entry[1][0] * u + f->entry[1][1] * v};
    off_mm[0] += more[0];
    off_mm[1] += more[1];
    node->entry_mm[0] += more[0];
    node->entry_mm[1] += more[1];
    change_mm = fabs(more[0]) + fabs(more[1]);
  }
  node->standing.opd_mm =
    placido_lattice_opd_mm(&f->lattice, x + off_mm[0], y + off_mm[1], place);
  return isfinite(node->standing.opd_mm);
}

static void fill_line(const filling *f, int row) {
  double middle = 0.5 * (f->n - 1), off_mm[2] = {0, 0};
  double limit_mm = f->radius_mm + (MARGIN + 0.5) * f->spacing_mm;
  for (int column = 0; column < f->n; column++) {
    size_t at = (size_t)row * (size_t)f->n + (size_t)column;
    const double place[2] = {(column - middle) * f->spacing_mm, (row - middle) * f->spacing_mm};
    placido_node node;
    bool wanted = place[0] * place[0] + place[1] * place[1] <= limit_mm * limit_mm;
    bool known = wanted && find_entry(f, place, off_mm, &node);
    f->opd_um[at] = known ? 1e3 * node.standing.opd_mm : NAN;
    f->x_mm[at] = known ? node.entry_mm[0] : NAN;
    f->y_mm[at] = known ? node.entry_mm[1] : NAN;
    if (!known) {
      off_mm[0] = off_mm[1] = 0;
    }
  }
}

/* Share of a sample's light that the rim of the entrance pupil leaves. */
static double open_share(const filling *f, size_t at) {
  double beyond_mm = hypot(f->x_mm[at], f->y_mm[at]) - f->sight.pupil_mm / 2;
  return fmin(fmax(0.5 - beyond_mm / f->spacing_mm, 0), 1);
}

/* The light that a sample stands for is the area through which it came: the amplitude's square. */
static void find_amplitude(const filling *f, int row) {
  size_t n = (size_t)f->n;
  for (size_t column = 0; column < n; column++) {
    size_t at = (size_t)row * n + column;
    f->amplitude[at] = NAN;
    if (row > 0 && column > 0 && row + 1 < f->n && column + 1 < n) {
      double xx = f->x_mm[at + 1] - f->x_mm[at - 1], xy = f->x_mm[at + n] - f->x_mm[at - n];
      double yx = f->y_mm[at + 1] - f->y_mm[at - 1], yy = f->y_mm[at + n] - f->y_mm[at - n];
      double share = f->cut ? open_share(f, at) : 1;
      f->amplitude[at] = sqrt(fmax(share * (xx * yy - xy * yx), 0)) / (2 * f->spacing_mm);
    }
  }
}

static int fill(filling *f, placido_error *err) {
  size_t area = (size_t)f->n * (size_t)f->n;
  f->opd_um = placido_memory_new(area, sizeof *f->opd_um, err);
  f->amplitude = placido_memory_new(area, sizeof *f->amplitude, err);
  f->x_mm = placido_memory_new(area, 2 * sizeof *f->x_mm, err);
  if (f->opd_um == NULL || f->amplitude == NULL || f->x_mm == NULL) {
    return PLACIDO_MEMORY;
  }
  f->y_mm = f->x_mm + area;
#pragma omp parallel for num_threads(f->threads) schedule(static, 8) if (f->threads > 1)
  for (int row = 0; row < f->n; row++) {
    fill_line(f, row);
  }
#pragma omp parallel for num_threads(f->threads) schedule(static, 8) if (f->threads > 1)
  for (int row = 0; row < f->n; row++) {
    find_amplitude(f, row);
  }
  return PLACIDO_OK;
}

/* Refuses a pupil of which too much is dark. */
static int check_lost(const filling *f, const double field_deg[2], placido_error *err) {
  double middle = 0.5 * (f->n - 1), square = f->radius_mm * f->radius_mm;
  double inside = 0, lost = 0;
  for (int row = 0; row < f->n; row++) {
    for (int column = 0; column < f->n; column++) {
      double x = (column - middle) * f->spacing_mm, y = (row - middle) * f->spacing_mm;
      bool in = x * x + y * y <= square;
      inside += in;
      lost += in && isnan(f->opd_um[(size_t)row * (size_t)f->n + (size_t)column]);
    }
  }
  if (lost <= lost_max * inside) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "%.0f %% of the light from (%.3g, %.3g) degrees through the pupil of "
                           "%g mm does not reach the retina; the surface is defined to a radius "
                           "of %g mm",
                           100 * lost / inside, field_deg[0], field_deg[1], f->sight.pupil_mm,
                           placido_surface_radius_mm(f->sight.surface));
}

static int make(filling *f, int samples, const double field_deg[2], placido_error *err) {
  rim r;
  trace_rim(&r, &f->sight);
  if (r.count < RIM / 2) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "half of the light from (%.3g, %.3g) degrees at the rim of the pupil "
                             "of %g mm does not reach the retina",
                             field_deg[0], field_deg[1], f->sight.pupil_mm);
  }
  measure(f, &r);
  fit_entry(f, &r);
  int status = lay_out(f, samples, err);
  if (status == PLACIDO_OK) {
    status = fill(f, err);
  }
  return status == PLACIDO_OK ? check_lost(f, field_deg, err) : status;
}

int placido_ocular_pupil(placido_pupil *pupil, const placido_surface *surface,
                         const placido_eye *eye, const placido_ocular *ocular,
                         const double field_deg[2], const double offset_arcmin[2],
                         double wavelength_nm, int samples, int threads, placido_error *err) {
  filling f = {.threads = threads};
  placido_eye settled;
  *pupil = (placido_pupil){0};
  int status = placido_eye_settle(&settled, eye, err);
  if (status == PLACIDO_OK) {
    status = placido_sight_new(&f.sight, surface, &settled, ocular, field_deg, offset_arcmin,
                               wavelength_nm, err);
  }
  if (status == PLACIDO_OK) {
    status = make(&f, samples, field_deg, err);
  }
  placido_lattice_free(&f.lattice);
  placido_memory_free(f.x_mm);
  if (status != PLACIDO_OK) {
    placido_memory_free(f.opd_um);
    placido_memory_free(f.amplitude);
    return status;
  }
  *pupil = (placido_pupil){.n = f.n,
                           .spacing_mm = f.spacing_mm,
                           .pupil_mm = 2 * f.radius_mm,
                           .opd_um = f.opd_um,
                           .amplitude = f.amplitude};
  return PLACIDO_OK;
}
