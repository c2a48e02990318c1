/* What an eye with this cornea sees: rays through the surface to a planar retina, point spread
 * function, search of the correction, and scenes as the patient sees them. A library of its own:
 * surface in, pictures out. After D. Garcia, CWhatUC (Berkeley 2000). */
#ifndef PLACIDO_SIMULATE_H
#define PLACIDO_SIMULATE_H

#include <placido/image.h>
#include <placido/notes.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <stdbool.h>
#include <stddef.h>

/* A thin lens on the cornea, in power-vector form: dioptres, J0 and J45 of its cross-cylinder. */
typedef struct placido_correction {
  double m_D, j0_D, j45_D;
} placido_correction;

/* Sphere, minus-cylinder and axis (0..180) of a power vector; the axis is NaN where the cylinder
 * is zero. Thibos et al. 1997. */
void placido_correction_clinical(const placido_correction *correction, double *sphere_D,
                                 double *cylinder_D, double *axis_deg);

/* The eye behind the cornea: a value. Zero means the default in brackets. */
typedef struct placido_eye {
  double pupil_mm;             /* diameter of the entrance pupil, 0.1 to 12; no default */
  double pupil_x_mm, pupil_y_mm;
  double index;                /* refractive index behind the surface [1.3375] */
  double retina_mm;            /* distance from the surface's point on the axis; [searched] */
  bool correct;                /* search the cross-cylinder too, else use `correction` as it is */
  placido_correction correction;
} placido_eye;

/* How it is computed; zero means the default in brackets. */
typedef struct placido_optics {
  int samples;          /* crosshatch of N×N plus (N-1)×(N-1) rays over the pupil's square [400,
                           100 with cwhatuc] */
  int buckets;          /* of the PSF, odd [257] */
  double bucket_arcmin; /* [0.5] */
  bool cwhatuc;         /* the seed's fixed 2.5 µm buckets, each called half a minute */
  int threads;          /* [1] */
} placido_optics;

/* A point spread function as the patient sees it: row 0 is up, column 0 is left in the visual
 * field. Values sum to the share of the entered rays that landed within it. */
typedef struct placido_psf {
  int n;
  double bucket_arcmin, bucket_um;
  double *values;            /* n * n, rows outer */
  double pupil_mm;
  double index, retina_mm;
  placido_correction correction;
  long rays, rays_entered, rays_landed; /* pattern; inside the pupil and refracted; in a bucket */
  long rays_missed;          /* outside the surface or totally reflected; never silently dropped */
  double strehl_g;           /* maximum count of a bucket divided by rays_landed */
  double centre_x_um, centre_y_um; /* retinal point at the middle of the centre bucket: the point of
                                      fixation, where the light is densest within about 1' */
} placido_psf;

/* Searches what is left open in `eye` (retina distance, cross-cylinder) for the best focus, traces
 * the rays and fills the PSF. Angles on the retina are those at the nodal point, retina_mm less the
 * apical radius at the pupil's centre. `found` (may be NULL) receives the eye with everything
 * decided and `correct` cleared: it traces to the same PSF. Free with placido_psf_free. Returns
 * PLACIDO_OK, PLACIDO_INPUT (an argument out of range), PLACIDO_QUALITY (surface does not fill the
 * pupil, or no focus), PLACIDO_MEMORY. */
int placido_psf_new(placido_psf *psf, placido_eye *found, const placido_surface *surface,
                    const placido_eye *eye, const placido_optics *optics, placido_notes *notes,
                    placido_error *err);
void placido_psf_free(placido_psf *psf);

/* Writes psf.csv and psf.json (docs/formats.md) by way of temporary names. `seconds` is the time
 * that it took. */
int placido_psf_save_csv(const placido_psf *psf, const char *path, placido_error *err);
int placido_psf_save_json(const placido_psf *psf, double seconds, const char *path,
                          placido_error *err);

/* What is looked at: an image in linear light with its scale. */
typedef struct placido_scene {
  char name[128];          /* also the stem of the output picture */
  placido_image image;     /* linear light, relative to white; 1, 3 or 4 planes */
  double arcmin_per_px;
  int bleed_px;            /* on every side: there to be looked at, spreads its light into the
                              picture and is then cut off; 0 for photographs */
} placido_scene;

/* Loads a scene: a file `placido-scene/1` (docs/formats.md), or a generated chart by name
 * (`tumbling-e`, `fan`), which has a bleed of white as wide as half of the default PSF, so that
 * the dark beyond does not reach the picture. Charts are drawn at chart_arcmin_per_px, 0.05 to 4
 * (0: 0.5), which should be the PSF's bucket. Free with placido_scene_free. Returns PLACIDO_OK,
 * PLACIDO_INPUT, PLACIDO_SYSTEM, PLACIDO_UNSUPPORTED (a chart that this build does not draw),
 * PLACIDO_MEMORY. */
int placido_scene_load(placido_scene *scene, const char *name_or_path, double chart_arcmin_per_px,
                       placido_notes *notes, placido_error *err);
void placido_scene_free(placido_scene *scene);

/* Calls `each` with the name and a sentence for every generated chart. */
void placido_chart_list(void (*each)(void *user, const char *name, const char *help), void *user);

/* The scene as seen through the PSF: resampled to the PSF's bucket where it is finer, convolved in
 * linear light with zero padding, R, G and B alike, its bleed cut off. `seen` gets linear light;
 * free with placido_image_free. A scene coarser than the bucket is refused with the reason.
 * Returns PLACIDO_OK, PLACIDO_INPUT, PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_scene_see(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                      int threads, placido_error *err);

#endif
