/* The point spread function: what is open in the eye is searched, then the pupil traced. */
#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/psf/diffraction_psf.h"
#include "simulate/psf/geometric.h"
#include "simulate/psf/settle.h"
#include "simulate/trace.h"

#include <placido/simulate.h>

#include <math.h>

static const double missed_share_max = 0.05; /* of the pupil's rays, beyond which it is refused */
static const double outside_share_told = 0.001;
static const double uncovered_share_told = 0.005;

static int check_pupil_filled(const placido_rays *rays, const placido_surface *surface,
                              const placido_eye *eye, placido_error *err) {
  double inside = (double)rays->count + (double)rays->missed;
  if ((double)rays->missed <= missed_share_max * inside) {
    return PLACIDO_OK;
  }
  return placido_error_set(err, PLACIDO_QUALITY,
                           "the surface fills only %.0f %% of the pupil of %g mm at (%g, %g) mm; "
                           "it is defined to a radius of %g mm",
                           100 * (double)rays->count / inside, eye->pupil_mm, eye->pupil_x_mm,
                           eye->pupil_y_mm, placido_surface_radius_mm(surface));
}

static void tell_cover(double pupil_mm, const placido_rays *rays, placido_notes *notes) {
  double uncovered = (double)rays->uncovered / (double)rays->count;
  if (uncovered > uncovered_share_told) {
    placido_notes_add(notes, "pupil %g mm: %.1f %% of it lies where no data support the surface",
                      pupil_mm, 100 * uncovered);
  }
}

static void tell(const placido_psf *psf, const placido_rays *rays, placido_notes *notes) {
  double inside = (double)(psf->rays_entered + psf->rays_missed);
  const struct { long count; const char *what; } lost[] = {
    {psf->rays_missed - psf->rays_grazed - psf->rays_reflected, "do not meet the surface"},
    {psf->rays_grazed, "meet the surface from behind or at more than 80 degrees"},
    {psf->rays_reflected, "are totally reflected"},
  };
  for (size_t i = 0; i < sizeof lost / sizeof *lost; i++) {
    if (lost[i].count > 0) {
      placido_notes_add(notes, "pupil %g mm: %.2f %% of its rays %s", psf->pupil_mm,
                        100 * (double)lost[i].count / inside, lost[i].what);
    }
  }
  if (psf->outside > outside_share_told) {
    placido_notes_add(notes, "pupil %g mm: %.3g %% of the light falls outside the PSF's %.4g'",
                      psf->pupil_mm, 100 * psf->outside, psf->n * psf->bucket_arcmin);
  }
  tell_cover(psf->pupil_mm, rays, notes);
}

/* Decides what is open in `eye`, and the point of fixation. */
static int find_focus(placido_eye *eye, double fixation_mm[2], const placido_surface *surface,
                      const placido_apex *apex, const placido_rays *sparse,
                      const placido_optics *optics, placido_error *err) {
  placido_rays dense;
  int status =
    placido_rays_new(&dense, surface, apex, eye, PLACIDO_FOCUS_SETTLE_SAMPLES, err);
  if (status == PLACIDO_OK) {
    placido_focus focus = {.sparse = sparse, .dense = &dense, .apex = apex, .optics = optics};
    status = placido_focus_search(&focus, eye, err);
    if (status == PLACIDO_OK) {
      status = placido_focus_peak(&focus, eye, fixation_mm, err);
    }
  }
  placido_rays_free(&dense);
  return status;
}

static int fill(placido_psf *psf, const placido_surface *surface, const placido_apex *apex,
                const placido_eye *eye, const placido_optics *optics, const double fixation_mm[2],
                placido_error *err) {
  return optics->wavelength_nm > 0
           ? placido_diffraction_fill(psf, surface, apex, eye, optics, fixation_mm, err)
           : placido_geometric_fill(psf, surface, apex, eye, optics, fixation_mm, err);
}

/* What the search leaves behind. */
typedef struct searched {
  placido_rays rays;
  placido_apex apex;
  double fixation_mm[2];
} searched;

/* Decides the eye; everything in `eye` and `optics` is settled. Free `found->rays`. */
static int search(searched *found, placido_eye *eye, const placido_surface *surface,
                  const placido_optics *optics, placido_error *err) {
  const int samples = PLACIDO_FOCUS_SEARCH_SAMPLES;
  *found = (searched){.fixation_mm = {0, 0}};
  int status = placido_apex_find(&found->apex, surface, eye, err);
  if (status == PLACIDO_OK) {
    status = placido_rays_new(&found->rays, surface, &found->apex, eye, samples, err);
  }
  if (status == PLACIDO_OK) {
    status = check_pupil_filled(&found->rays, surface, eye, err);
  }
  if (status == PLACIDO_OK) {
    status = find_focus(eye, found->fixation_mm, surface, &found->apex, &found->rays, optics, err);
  }
  return status;
}

/* Decides the eye and traces it. */
static int make(placido_psf *psf, placido_eye *eye, const placido_surface *surface,
                const placido_optics *optics, placido_notes *notes, placido_error *err) {
  searched found;
  int status = search(&found, eye, surface, optics, err);
  if (status == PLACIDO_OK) {
    status = fill(psf, surface, &found.apex, eye, optics, found.fixation_mm, err);
  }
  if (status == PLACIDO_OK) {
    tell(psf, &found.rays, notes);
  }
  placido_rays_free(&found.rays);
  return status;
}

int placido_psf_settle(placido_eye *found, double fixation_mm[2], const placido_surface *surface,
                       const placido_eye *eye, placido_notes *notes, placido_error *err) {
  const placido_optics usual = {0};
  placido_optics optics;
  searched by = {.fixation_mm = {0, 0}};
  int status = placido_eye_settle(found, eye, err);
  if (status == PLACIDO_OK) {
    status = placido_optics_settle(&optics, &usual, err);
  }
  if (status == PLACIDO_OK) {
    status = search(&by, found, surface, &optics, err);
  }
  if (status == PLACIDO_OK) {
    fixation_mm[0] = by.fixation_mm[0];
    fixation_mm[1] = by.fixation_mm[1];
    found->correct = PLACIDO_CORRECT_NONE;
    tell_cover(found->pupil_mm, &by.rays, notes);
  }
  placido_rays_free(&by.rays);
  return status;
}

int placido_psf_new(placido_psf *psf, placido_eye *found, const placido_surface *surface,
                    const placido_eye *eye, const placido_optics *optics, placido_notes *notes,
                    placido_error *err) {
  placido_eye settled;
  placido_optics how;
  *psf = (placido_psf){0};
  int status = placido_eye_settle(&settled, eye, err);
  if (status == PLACIDO_OK) {
    status = placido_optics_settle(&how, optics, err);
  }
  if (status == PLACIDO_OK) {
    status = make(psf, &settled, surface, &how, notes, err);
  }
  if (status != PLACIDO_OK) {
    placido_psf_free(psf);
    return status;
  }
  if (found != NULL) {
    *found = settled;
    found->correct = false; /* decided: tracing it again searches nothing */
  }
  return PLACIDO_OK;
}

void placido_psf_free(placido_psf *psf) {
  if (psf != NULL) {
    placido_memory_free(psf->values);
    *psf = (placido_psf){0};
  }
}
