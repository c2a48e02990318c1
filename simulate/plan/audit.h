/* Holding plans to their word: the scene with everything on, as the eye of a plan would see it, and
 * what each effect is worth in it. For tests and benchmarks: it takes as long as everything does. */
#ifndef PLACIDO_SIMULATE_AUDIT_H
#define PLACIDO_SIMULATE_AUDIT_H

#include <placido/plan.h>

/* An eye before a scene. */
typedef struct placido_audit {
  placido_plan *everything;        /* all effects forced on */
  placido_plan_settings settings;  /* its; who measures may change them before anything is seen */
} placido_audit;

/* Plans everything, at the finest for `tolerance`. `eye`, bucket_arcmin and threads as for
 * placido_plan_new, whose errors it returns; surface and scene are borrowed. Free with
 * placido_audit_free, whatever it returns. */
int placido_audit_new(placido_audit *audit, const placido_surface *surface, const placido_eye *eye,
                      const placido_scene *scene, double bucket_arcmin, double tolerance,
                      int threads, placido_error *err);
void placido_audit_free(placido_audit *audit);

/* At most so many nodes a side and wavelengths a light, in single precision: as fine as the question
 * asks for, which may be what one effect is worth. */
void placido_audit_coarsen(placido_audit *audit, int nodes, int wavelengths);

/* Sees the scene with everything on but effect number `without` (-1: none) and those that cannot be
 * without it. Free with placido_image_free. Errors as placido_plan_run. */
int placido_audit_see(placido_image *seen, const placido_audit *audit, int without,
                      placido_error *err);

/* Whether everything has effect number `effect` in it and can be seen without it: false where it does
 * not apply, and where it has settled the eye. */
bool placido_audit_has(const placido_audit *audit, size_t effect);

/* The largest difference of two pictures of one size, what is above white being white; their first
 * three planes, or one. */
double placido_audit_difference(const placido_image *one, const placido_image *other);

#endif
