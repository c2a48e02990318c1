/* Writes the result's directory: tables and pictures side by side, then the page, then the
 * record. */
#include "acquire/cli/save.h"

#include "acquire/cli/figures.h"
#include "acquire/cli/record.h"
#include "base/memory.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

void jobs_add(struct jobs *jobs, save_function *save, size_t a, size_t b, const char *format, ...) {
  if (jobs->count < JOBS_MAX) {
    struct job *job = &jobs->items[jobs->count];
    *job = (struct job){.save = save, .a = a, .b = b};
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(job->name, sizeof job->name, format, arguments);
    va_end(arguments);
  }
  jobs->count++;
}

static int save_mires(const struct examination *examination, size_t a, size_t b,
                      const char *path, placido_error *err) {
  (void)a;
  (void)b;
  return placido_mires_save(&examination->mires, path, err);
}

static int save_surface(const struct examination *examination, size_t a, size_t b,
                        const char *path, placido_error *err) {
  (void)a;
  (void)b;
  return placido_surface_save(examination->surface, path, err);
}

static int save_maps(const struct examination *examination, size_t a, size_t b, const char *path,
                     placido_error *err) {
  (void)a;
  (void)b;
  return placido_maps_save(&examination->maps, path, err);
}

static int save_more_maps(const struct examination *examination, size_t a, size_t b,
                          const char *path, placido_error *err) {
  (void)a;
  (void)b;
  return placido_maps_save_more(&examination->maps, path, err);
}

static int save_sigmas(const struct examination *examination, size_t a, size_t b,
                       const char *path, placido_error *err) {
  (void)a;
  (void)b;
  return placido_maps_save_sigma(&examination->maps, path, err);
}

static int save_indices(const struct examination *examination, size_t a, size_t b,
                        const char *path, placido_error *err) {
  (void)a;
  (void)b;
  return placido_indices_save(examination->indices, examination->index_count, path, err);
}

static int save_wavefronts(const struct examination *examination, size_t a, size_t b,
                           const char *path, placido_error *err) {
  (void)a;
  (void)b;
  return wavefronts_save(&examination->wavefronts, path, err);
}

static int save_psf_table(const struct examination *examination, size_t pupil, size_t b,
                          const char *path, placido_error *err) {
  (void)b;
  return placido_psf_save_csv(&examination->views.items[pupil].psf, path, err);
}

static int save_psf_figures(const struct examination *examination, size_t pupil, size_t b,
                            const char *path, placido_error *err) {
  (void)b;
  const struct view *view = &examination->views.items[pupil];
  return placido_psf_save_json(&view->psf, views_first_plan(view), view->seconds, path, err);
}

static int save_focus(const struct examination *examination, size_t pupil, size_t b,
                      const char *path, placido_error *err) {
  (void)b;
  return placido_focus_curve_save_csv(&examination->views.items[pupil].focus, path, err);
}

static int save_acuity(const struct examination *examination, size_t pupil, size_t b,
                       const char *path, placido_error *err) {
  (void)b;
  const struct view *view = &examination->views.items[pupil];
  return acuity_save(&view->acuity, view->psf.pupil_mm, path, err);
}

static int save_scene(const struct examination *examination, size_t pupil, size_t scene,
                      const char *path, placido_error *err) {
  const struct views *views = &examination->views;
  return placido_image_save_png_bits(&views->items[pupil].sights[scene].image,
                                     views->scenes[scene].bits, path, err);
}

static int save_plan(const struct examination *examination, size_t pupil, size_t scene,
                     const char *path, placido_error *err) {
  return placido_plan_save(examination->views.items[pupil].sights[scene].plan, path, err);
}

static void add_measured(struct jobs *jobs, const struct examination *examination) {
  if (examination->frame.data) {
    jobs_add(jobs, save_mires, 0, 0, "mires.csv");
  }
  jobs_add(jobs, save_surface, 0, 0, "surface.json");
  jobs_add(jobs, save_maps, 0, 0, "maps.csv");
  jobs_add(jobs, save_more_maps, 0, 0, "maps_more.csv");
  jobs_add(jobs, save_sigmas, 0, 0, "maps_sigma.csv");
  jobs_add(jobs, save_indices, 0, 0, "indices.json");
  if (examination->wavefronts.count > 0) {
    jobs_add(jobs, save_wavefronts, 0, 0, "wavefront.json");
  }
}

static void add_views(struct jobs *jobs, const struct views *views) {
  for (size_t i = 0; i < views->count; i++) {
    const struct view *view = &views->items[i];
    jobs_add(jobs, save_psf_table, i, 0, "%s/psf.csv", view->directory);
    jobs_add(jobs, save_psf_figures, i, 0, "%s/psf.json", view->directory);
    if (view->focus.count > 0) {
      jobs_add(jobs, save_focus, i, 0, "%s/focus.csv", view->directory);
    }
    if (view->acuity.count > 0) {
      jobs_add(jobs, save_acuity, i, 0, "%s/acuity.json", view->directory);
    }
    for (size_t k = 0; k < views->scene_count; k++) {
      const struct sight *sight = &view->sights[k];
      if (sight->image.data) {
        jobs_add(jobs, save_scene, i, k, "%s/%s.png", view->directory, views->stems[k]);
      }
      if (sight->image.data && sight->plan) {
        jobs_add(jobs, save_plan, i, k, "%s/%s.plan.json", view->directory, views->stems[k]);
      }
    }
  }
}

static int make_folder(const char *directory, const char *name, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  const int status = placido_path_join(path, directory, name, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (mkdir(path, 0777) != 0 && errno != EEXIST) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s: cannot be made: %s", path,
                             strerror(errno));
  }
  return PLACIDO_OK;
}

/* The folders of all jobs, so that none of them needs to look. */
static int make_folders(const struct jobs *jobs, const char *directory, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 0; i < jobs->count && status == PLACIDO_OK; i++) {
    char folder[JOB_NAME_SIZE];
    snprintf(folder, sizeof folder, "%s", jobs->items[i].name);
    char *slash = strchr(folder, '/');
    if (slash) {
      *slash = '\0';
      status = make_folder(directory, folder, err);
    }
  }
  return status;
}

static int run_job(const struct job *job, const struct examination *examination,
                   placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  const int status =
      placido_path_join(path, examination->directory.temporary, job->name, err);
  return status == PLACIDO_OK ? job->save(examination, job->a, job->b, path, err) : status;
}

/* Runs all jobs; of several failures the first in the list is told. */
static int run_jobs(const struct jobs *jobs, const struct examination *examination,
                    placido_error *err) {
  int status = PLACIDO_OK;
  size_t failed = jobs->count;
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < jobs->count; i++) {
    placido_error reason = {0};
    const int ended = run_job(&jobs->items[i], examination, &reason);
#pragma omp critical(placido_cli_jobs)
    if (ended != PLACIDO_OK && i < failed) {
      failed = i;
      status = placido_error_set(err, ended, "%s", reason.text);
    }
  }
  return status;
}

static int save_files(struct jobs *jobs, const struct examination *examination,
                      placido_error *err) {
  figures_add(jobs, examination);
  if (examination->fit) {
    add_measured(jobs, examination);
  }
  add_views(jobs, &examination->views);
  if (jobs->count > JOBS_MAX) {
    return placido_error_set(err, STATUS_USAGE, "%zu files are too many at once, at most %d: "
                             "give fewer pupils or scenes", jobs->count, JOBS_MAX);
  }
  const int status = make_folders(jobs, examination->directory.temporary, err);
  return status == PLACIDO_OK ? run_jobs(jobs, examination, err) : status;
}

int step_save(struct examination *examination, placido_error *err) {
  struct stages *stages = &examination->outcome->stages;
  stages_next(stages, "files and figures");
  struct jobs *jobs = placido_memory_new(1, sizeof *jobs, err);
  if (!jobs) {
    return PLACIDO_MEMORY;
  }
  int status = save_files(jobs, examination, err);
  placido_memory_free(jobs);
  if (status == PLACIDO_OK && examination->views.count > 0) {
    stages_next(stages, "report");
    status = figures_report(examination, err);
  }
  char path[PLACIDO_PATH_MAX];
  if (status == PLACIDO_OK) {
    status = placido_path_join(path, examination->directory.temporary,
                               examination->recipe->marker, err);
  }
  return status == PLACIDO_OK ? record_save(examination, path, err) : status;
}
