/* What one cornea sees through one pupil: computed, pictured and let go, so that of a large study no
 * more is in memory than there are threads. */
#include "acquire/cli/study.h"

#include <placido/quality.h>
#include <placido/wavefront.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define WAVEFRONT_MM 6.0
#define QUICK_SAMPLES 100
#define FINEST_CPD 60.0 /* 20/10, where the seed's chart ends */
#define FREQUENCIES 1201

static int make_folder(char path[PLACIDO_PATH_MAX], const struct study *study, const char *name,
                       placido_error *err) {
  const int status = placido_path_join(path, study->directory.temporary, name, err);
  if (status == PLACIDO_OK && mkdir(path, 0777) != 0 && errno != EEXIST) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s: cannot be made: %s", path, strerror(errno));
  }
  return status;
}

/* Radial order of an OSA index. */
static int order_of(int index) {
  return (int)floor(0.5 * (sqrt(8.0 * index + 1) - 1));
}

static void measure_wavefront(placido_study_eye *eye, const placido_surface *surface,
                              const struct settings *settings) {
  placido_wavefront front;
  const placido_eye through = {.pupil_mm = WAVEFRONT_MM, .index = settings->index};
  eye->higher_um = eye->coma_like_um = (double)NAN;
  if (placido_wavefront_new(&front, surface, &through, NULL, NULL, NULL) != PLACIDO_OK) {
    return;
  }
  double odd = 0, even = 0;
  for (int j = 6; j < front.term_count; j++) {
    const double square = front.coefficients_um[j] * front.coefficients_um[j];
    *(order_of(j) % 2 ? &odd : &even) += square;
  }
  eye->higher_um = sqrt(odd + even);
  eye->coma_like_um = sqrt(odd);
  placido_wavefront_free(&front);
}

int study_examine_eye(struct study *study, size_t index, placido_error *err) {
  placido_study_eye *eye = &study->eyes[index];
  char folder[PLACIDO_PATH_MAX], path[PLACIDO_PATH_MAX];
  measure_wavefront(eye, study->surfaces[index], study->settings);
  int status = make_folder(folder, study, eye->folder, err);
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, folder, "surface.json", err);
  }
  if (status == PLACIDO_OK) {
    status = placido_surface_save(study->surfaces[index], path, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, folder, "axial.png", err);
  }
  return status == PLACIDO_OK ? study_draw_map(study, index, path, err) : status;
}

static int find_psf(placido_psf *psf, placido_study_cell *cell, const struct study *study,
                    size_t eye, placido_notes *notes, placido_error *err) {
  const struct settings *settings = study->settings;
  const placido_eye through = {.pupil_mm = cell->pupil_mm,
                               .index = settings->index,
                               .correct = PLACIDO_CORRECT_FULL};
  const placido_optics optics = {.samples = settings->quick ? QUICK_SAMPLES : 0,
                                 .cwhatuc = settings->cwhatuc,
                                 .threads = 1};
  const int status = placido_psf_new(psf, &cell->eye, study->surfaces[eye], &through, &optics,
                                     notes, err);
  if (status == PLACIDO_OK) {
    cell->strehl_g = psf->strehl_g;
    cell->bucket_arcmin = psf->bucket_arcmin;
    cell->buckets = psf->n;
    cell->outside = psf->outside;
    cell->rays_entered = psf->rays_entered;
    cell->rays_missed = psf->rays_missed;
  }
  return status;
}

static void write_acuity(placido_study_cell *cell) {
  static const char *const before[] = {
      [PLACIDO_ACUITY_FOUND] = "",
      [PLACIDO_ACUITY_BEYOND_CHART] = "worse than ",
      [PLACIDO_ACUITY_BEYOND_WINDOW] = "worse than ",
      [PLACIDO_ACUITY_ALL_READ] = "better than ",
  };
  const placido_acuity *acuity = &cell->acuity;
  const bool found = acuity->verdict == PLACIDO_ACUITY_FOUND;
  snprintf(cell->acuity_text, sizeof cell->acuity_text, "%s20/%.0f", before[acuity->verdict],
           placido_acuity_snellen(found ? acuity->logmar : acuity->bound_logmar, 20));
}

/* How fine bars may be, from coarse to fine, until they lose too much contrast; upright and lying
 * ones on the mean, as the letters have them. Light outside the PSF lies evenly on everything. */
static int find_bars(placido_study_cell *cell, const placido_psf *psf, placido_error *err) {
  placido_mtf mtf;
  const double step_cpd = FINEST_CPD / (FREQUENCIES - 1);
  const double least = PLACIDO_STUDY_CONTRAST / fmax(1 - psf->outside, 1e-6);
  const int status = placido_mtf_new(&mtf, psf, FREQUENCIES, step_cpd, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  int last = 0;
  while (last + 1 < FREQUENCIES &&
         0.5 * (mtf.meridian[0][last + 1] + mtf.meridian[2][last + 1]) >= least) {
    last++;
  }
  placido_mtf_free(&mtf);
  const double stroke = 30 / (last * step_cpd); /* two strokes are a period */
  const bool all = last + 1 == FREQUENCIES;
  cell->bars_logmar = last > 0 ? log10(stroke) : (double)NAN;
  if (last == 0) {
    snprintf(cell->bars_text, sizeof cell->bars_text, "none");
  } else {
    snprintf(cell->bars_text, sizeof cell->bars_text, "20/%.0f%s", 20 * stroke,
             all ? " or better" : "");
  }
  return PLACIDO_OK;
}

/* Images are told apart by who reads the letters: at their stroke. */
static int judge(placido_study_cell *cell, const struct study *study, const placido_psf *psf,
                 placido_error *err) {
  const int status = placido_acuity_find(&cell->acuity, study->observer, psf, NULL, 0, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  write_acuity(cell);
  const int barred = find_bars(cell, psf, err);
  if (barred != PLACIDO_OK) {
    return barred;
  }
  const bool found = cell->acuity.verdict == PLACIDO_ACUITY_FOUND;
  const double widest = 0.25 * psf->n * psf->bucket_arcmin;
  const double stroke = found ? fmin(pow(10, cell->acuity.logmar), widest) : 0;
  return placido_ghosts_find(&cell->ghosts, psf, stroke, err);
}

static int save_scene(placido_study_cell *cell, const struct study *study, const placido_psf *psf,
                      size_t scene, const char *folder, placido_notes *notes,
                      placido_error *err) {
  placido_image seen;
  placido_error reason = {0};
  char name[96], path[PLACIDO_PATH_MAX];
  int status = placido_scene_see(&seen, &study->scenes[scene], psf, 1, &reason);
  if (status == PLACIDO_QUALITY) {
    placido_notes_add(notes, "left out: %s", reason.text);
    return PLACIDO_OK;
  }
  if (status != PLACIDO_OK) {
    return placido_error_set(err, status, "%s", reason.text);
  }
  placido_image_to_srgb(&seen);
  snprintf(name, sizeof name, "%s.png", study->stems[scene]);
  status = placido_path_join(path, folder, name, err);
  if (status == PLACIDO_OK) {
    status = placido_image_save_png_bits(&seen, study->scenes[scene].bits, path, err);
  }
  placido_image_free(&seen);
  cell->scenes[scene] = status == PLACIDO_OK;
  return status;
}

static int save_cell(placido_study_cell *cell, const struct study *study, const placido_psf *psf,
                     const char *folder, double seconds, placido_notes *notes,
                     placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, folder, "psf.json", err);
  if (status == PLACIDO_OK) {
    status = placido_psf_save_json(psf, NULL, seconds, path, err);
  }
  if (status == PLACIDO_OK) {
    status = study_draw_psf(psf, folder, err);
  }
  for (size_t k = 0; k < study->scene_count && status == PLACIDO_OK; k++) {
    status = save_scene(cell, study, psf, k, folder, notes, err);
  }
  return status;
}

static double now_s(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int study_examine_cell(struct study *study, size_t eye, size_t pupil, placido_error *err) {
  const size_t index = eye * study->settings->pupils_mm.count + pupil;
  placido_study_cell *cell = &study->cells[index];
  placido_notes *notes = &study->cell_notes[index];
  placido_psf psf;
  placido_error reason = {0};
  char folder[PLACIDO_PATH_MAX], name[192];
  const double started = now_s();
  int status = find_psf(&psf, cell, study, eye, notes, &reason);
  if (status == PLACIDO_QUALITY) {
    snprintf(cell->failure, sizeof cell->failure, "%s", reason.text);
    placido_notes_add(notes, "left out: %s", reason.text);
    return PLACIDO_OK;
  }
  const double seconds = now_s() - started;
  if (status == PLACIDO_OK) {
    status = judge(cell, study, &psf, &reason);
  }
  if (status == PLACIDO_OK) {
    snprintf(name, sizeof name, "%s/pupil-%gmm", study->eyes[eye].folder, cell->pupil_mm);
    status = make_folder(folder, study, name, &reason);
  }
  if (status == PLACIDO_OK) {
    status = save_cell(cell, study, &psf, folder, seconds, notes, &reason);
  }
  placido_psf_free(&psf);
  return status == PLACIDO_OK ? PLACIDO_OK
                              : placido_error_set(err, status, "%s, pupil %g mm: %s",
                                                  study->eyes[eye].name, cell->pupil_mm,
                                                  reason.text);
}
