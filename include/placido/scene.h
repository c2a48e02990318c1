/* Scenes, and how they are seen through a point spread function. */
#ifndef PLACIDO_SCENE_H
#define PLACIDO_SCENE_H

#include <placido/convolution.h>
#include <placido/image.h>
#include <placido/notes.h>
#include <placido/psf.h>
#include <placido/status.h>
#include <stdbool.h>

/* How a picture is brought to the PSF's scale. */
enum placido_resampling {
  PLACIDO_RESAMPLING_AREA,   /* the mean light over each bucket; never rings */
  PLACIDO_RESAMPLING_BICUBIC /* Keys' cubic (a = -1/2), as wide as the buckets: sharper */
};

/* The light's spectrum. */
enum placido_spectrum {
  PLACIDO_SPECTRUM_DISPLAY_SRGB, /* a display's three primaries: colours have spectra */
  PLACIDO_SPECTRUM_EQUAL_ENERGY,
  PLACIDO_SPECTRUM_DAYLIGHT,     /* D65 */
  PLACIDO_SPECTRUM_INCANDESCENT, /* illuminant A */
  PLACIDO_SPECTRUM_LINE          /* one wavelength */
};

/* Under which conditions it is looked at. A PSF follows none of them, a plan (plan.h) all. */
typedef struct placido_conditions {
  double luminance_cd_m2;    /* of white; NaN: not known */
  double distance_m;         /* where the eye looks; INFINITY: far */
  char depth_path[1024];     /* the file from which depth_D was read; "": none */
  enum placido_spectrum spectrum;
  double wavelength_nm;      /* of PLACIDO_SPECTRUM_LINE, else NaN */
  double tolerance;          /* linear light relative to white that leaving effects out may cost */
} placido_conditions;

/* What is looked at: an image in linear light with its scale. */
typedef struct placido_scene {
  char name[128];          /* also the stem of the output picture */
  placido_image image;     /* linear light, relative to white; 1, 3 or 4 planes */
  double arcmin_per_px;    /* in the picture's middle */
  int bleed_px;            /* on every side: there to be looked at, spreads its light into the
                              picture and is then cut off; 0 for photographs */
  int bits;                /* of the file's samples, 8, 16 or 32; 8 for charts */
  bool allow_coarse;       /* be seen though its pixels are larger than the PSF's buckets */
  enum placido_resampling resampling;
  placido_conditions conditions;
  float *depth_D;          /* vergence of every pixel of `image`, its bleed included: 1 / distance in
                              m, 0: far; NULL: all at conditions.distance_m */
} placido_scene;

/* Which lines a chart in ETDRS lines has (`sloan`, `landolt`, `e-lines`): from first_logmar down to
 * last_logmar in steps of 0.1, within 2 to -1; equal: one line. */
typedef struct placido_chart_lines {
  double first_logmar, last_logmar;
  int directions; /* of Landolt rings, 4 or 8 */
} placido_chart_lines;

/* Loads a scene: a file `placido-scene/1` (docs/formats.md), or a generated chart by name. Charts
 * have a bleed as wide as half of the default PSF, so that the dark beyond does not reach the
 * picture. They are drawn at chart_arcmin_per_px, 0.05 to 4 (0: 0.5), which should be the PSF's
 * bucket. Free with placido_scene_free. Returns PLACIDO_OK, PLACIDO_INPUT, PLACIDO_SYSTEM,
 * PLACIDO_MEMORY. */
int placido_scene_load(placido_scene *scene, const char *name_or_path, double chart_arcmin_per_px,
                       placido_notes *notes, placido_error *err);

/* Draws the chart called `name` as a scene, with these lines (NULL: its own). Free with
 * placido_scene_free. Returns PLACIDO_OK, PLACIDO_INPUT (no such chart, or an argument out of
 * range), PLACIDO_MEMORY. */
int placido_scene_draw(placido_scene *scene, const char *name, const placido_chart_lines *lines,
                       double arcmin_per_px, placido_error *err);
void placido_scene_free(placido_scene *scene);

/* Calls `each` with the name and a sentence for every generated chart. */
void placido_chart_list(void (*each)(void *user, const char *name, const char *help), void *user);

/* Whether a scene's pixels are larger than the PSF's buckets: the blur hides in them. */
bool placido_scene_coarse(const placido_scene *scene, const placido_psf *psf);

/* The scene as seen through the PSF: resampled to the PSF's bucket where it is finer, convolved in
 * linear light with zero padding, R, G and B alike, its bleed cut off. Where a picture has alpha,
 * colours spread weighted by it and alpha spreads with them, so that what cannot be seen through a
 * hole does not darken its rim. `seen` gets linear light; free with placido_image_free. A scene
 * coarser than the bucket is refused with the reason, unless it says allow_coarse: then its pixels
 * are squares of even light (area), or interpolated (bicubic). Samples that are no numbers, or
 * beyond 1e12 times white, are refused. `threads` 0: one. Returns PLACIDO_OK, PLACIDO_INPUT,
 * PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_scene_see(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                      int threads, placido_error *err);

/* The same, convolved as said: in double precision, in tiles, with what was measured before.
 * `notes` (may be NULL) gets what became of `how`. */
int placido_scene_see_as(placido_image *seen, const placido_scene *scene, const placido_psf *psf,
                         const placido_convolution *how, placido_notes *notes,
                         placido_error *err);

#endif
