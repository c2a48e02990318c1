/* The point spread function: what becomes of a distant point of light. */
#ifndef PLACIDO_PSF_H
#define PLACIDO_PSF_H

#include <placido/eye.h>
#include <placido/notes.h>
#include <placido/status.h>
#include <placido/surface.h>
#include <stdbool.h>

#define PLACIDO_PSF_BUCKETS_MAX 4095 /* a side */

/* How a pupil is filled with rays. */
enum placido_pattern_kind {
  PLACIDO_PATTERN_CROSSHATCH,  /* N×N nodes over the pupil's square and the (N-1)×(N-1) middles */
  PLACIDO_PATTERN_EQUAL_AREA,  /* a sunflower: every ray stands for the same area */
  PLACIDO_PATTERN_QUASI_RANDOM /* a sequence that fills gaps as it goes on (R2) */
};

/* How light becomes numbers. */
enum placido_light_kind {
  PLACIDO_LIGHT_SPREAD, /* each ray's over what its cell of the pupil becomes on the retina, a cell
                           that the rim crosses counting by its area inside: no speckle */
  PLACIDO_LIGHT_COUNTED /* as the seed: a ray inside the pupil is one in the bucket that it meets */
};

/* How it is computed; zero means the default in brackets. */
typedef struct placido_optics {
  int samples;          /* crosshatch of N×N plus (N-1)×(N-1) rays over the pupil's square [400,
                           100 with cwhatuc] */
  long rays;            /* in place of samples, 1 to 50,000,000: of the crosshatch over the pupil's
                           square, the least that has so many; of other patterns inside the pupil */
  enum placido_pattern_kind pattern; /* [crosshatch] */
  enum placido_light_kind light;     /* [spread; counted with cwhatuc] */
  int buckets;          /* of the PSF a side, odd, 3 to PLACIDO_PSF_BUCKETS_MAX [257] */
  double bucket_arcmin; /* [0.5] */
  double grow;          /* where over 0.1 % of the light would fall outside, the PSF gets more
                           buckets, up to so many times as many a side and no more than
                           PLACIDO_PSF_BUCKETS_MAX; 1 to 16 [4; 1 with cwhatuc] */
  double wavelength_nm; /* diffraction of this wavelength in place of rays, 300 to 1200 [rays] */
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
  double wavelength_nm;      /* of diffraction, in whose case rays are the samples of the pupil;
                                0: rays */
  long rays, rays_entered, rays_landed; /* pattern; inside the pupil and refracted; in a bucket */
  long rays_missed;          /* inside the pupil, not entered; never silently dropped. Of these: */
  long rays_grazed;          /* met the surface from behind or at more than 80 degrees */
  long rays_reflected;       /* totally; what is left of rays_missed is beside the surface */
  double outside;            /* share of the entered rays that fell outside the PSF */
  double strehl_g;           /* largest value over the sum of all; counted: the fullest bucket's
                                count divided by rays_landed */
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

struct placido_plan;

/* Writes psf.csv and psf.json (docs/formats.md) by way of temporary names. `plan` tells of the
 * effects for a scene that is seen through this pupil, NULL: none ran. `seconds` is the time that the
 * PSF took. */
int placido_psf_save_csv(const placido_psf *psf, const char *path, placido_error *err);
int placido_psf_save_json(const placido_psf *psf, const struct placido_plan *plan, double seconds,
                          const char *path, placido_error *err);

#endif
