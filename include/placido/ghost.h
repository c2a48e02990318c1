/* Ghost images: separate images of one point of light beside the main one, monocular diplopia. */
#ifndef PLACIDO_GHOST_H
#define PLACIDO_GHOST_H

#include <placido/psf.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

#define PLACIDO_GHOSTS_MAX 8
#define PLACIDO_GHOST_LISTED 0.05    /* of the main image's light, the least that is listed */
#define PLACIDO_GHOST_DIPLOPIA 0.2   /* likewise, from which on it is told as diplopia */

/* A secondary image, against the main one. */
typedef struct placido_ghost {
  double separation_arcmin;
  double direction_deg; /* in the visual field as the patient sees it: 0 to the patient's right, 90
                           up, to 360 */
  double clock_h;       /* the same as a clock's hour, 12 up; above 0, to 12 */
  double share;         /* its light over that of the main image */
} placido_ghost;

/* The images of a PSF: those apart from the main one, the brightest first. */
typedef struct placido_ghosts {
  int count;              /* of those listed, at most PLACIDO_GHOSTS_MAX */
  placido_ghost items[PLACIDO_GHOSTS_MAX];
  double main_share;      /* of the light in the PSF that belongs to the main image */
  double scale_arcmin;    /* width at half height of what it was smoothed with */
  bool diplopia;          /* the brightest has PLACIDO_GHOST_DIPLOPIA or more, and lies twice the
                             scale or more away */
} placido_ghosts;

/* Looks for images in a PSF smoothed to `scale_arcmin` (0: 2'), which should be the stroke of the
 * smallest letter that is read: what is finer is not seen as an image. An image is a maximum with
 * all light whose uphill way leads to it (watershed); it is apart where that way dips to under
 * 0.7 of the lower maximum, and where its light lies to one side of the main image rather than
 * around it, which a halo does. Returns PLACIDO_OK, PLACIDO_INPUT (not a PSF, or a scale not within
 * 0 to a quarter of its width), PLACIDO_MEMORY. */
int placido_ghosts_find(placido_ghosts *ghosts, const placido_psf *psf, double scale_arcmin,
                        placido_error *err);

/* One sentence: "No ghost image.", "A ghost image 12' towards 12 o'clock with 45 % of ...". */
void placido_ghosts_write(char *text, size_t size, const placido_ghosts *ghosts);

#endif
