/* How far two corneas, and what is seen through them, differ: the errors of an accuracy table. */
#ifndef PLACIDO_CLI_ACCURACY_DIFFER_H
#define PLACIDO_CLI_ACCURACY_DIFFER_H

#include <placido/image.h>
#include <placido/psf.h>
#include <placido/status.h>
#include <placido/surface.h>

/* Over those points of a 0.1 mm grid that both surfaces cover: rms of the difference in height
 * within 6 mm, its mean removed, micrometres; and of axial power without the inner 0.5 mm, 337.5 D.
 * NaN where less than half of the 6 mm is covered. Either may be NULL. */
void accuracy_differ_surfaces(double *elevation_um, double *axial_D, const placido_surface *one,
                              const placido_surface *other);

/* The largest difference of the optical transfer functions up to 60 cycles a degree. A shift
 * between the images, which nobody sees, is taken out: that which fits both best. What is finer
 * than two buckets an image does not have. Returns PLACIDO_OK, PLACIDO_QUALITY (no light),
 * PLACIDO_MEMORY. */
int accuracy_differ_psfs(double *otf, const placido_psf *one, const placido_psf *other,
                         placido_error *err);

/* The largest difference of a sample; NaN where the images are not of one size. */
double accuracy_differ_images(const placido_image *one, const placido_image *other);

#endif
