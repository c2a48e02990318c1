/* The point spread function: what is open in the eye is searched, then the pupil traced. */
#include "base/memory.h"
#include "simulate/eye.h"
#include "simulate/focus.h"
#include "simulate/psf/diffraction_psf.h"
#include "simulate/psf/geometric.h"
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

static void tell(const placido_psf *psf, const placido_rays *rays, placido_notes *notes) {
  double inside = (double)(psf->rays_entered + psf->rays_missed);
  double uncovered = (double)rays->uncovered / (double)rays->count;
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
    placido_notes_add(notes, "pupil %g mm: %.3g %% of the light falls outside the PSF's %.0f'",
                      psf->pupil_mm, 100 * psf->outside, psf->n * psf->bucket_arcmin);
  }
  if (uncovered > uncovered_share_told) {
    placido_notes_add(notes, "pupil %g mm: %.1f %% of it lies where no data support the surface",
                      psf->pupil_mm, 100 * uncovered);
  }
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

/* Decides the eye and traces it; everything in `eye` and `optics` is settled. */
static int make(placido_psf *psf, placido_eye *eye, const placido_surface *surface,
                const placido_optics *optics, placido_notes *notes, placido_error *err) {
  const int samples = PLACIDO_FOCUS_SEARCH_SAMPLES;
  placido_rays rays = {0};
  placido_apex apex;
  double fixation_mm[2];
  int status = placido_apex_find(&apex, surface, eye, err);
  if (status != PLACIDO_OK ||
      (status = placido_rays_new(&rays, surface, &apex, eye, samples, err)) != 0 ||
      (status = check_pupil_filled(&rays, surface, eye, err)) != 0 ||
      (status = find_focus(eye, fixation_mm, surface, &apex, &rays, optics, err)) != 0 ||
      (status = fill(psf, surface, &apex, eye, optics, fixation_mm, err)) != 0) {
    goto done;
  }
  tell(psf, &rays, notes);
done:
  placido_rays_free(&rays);
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
