/* Small scenes through chromatic eyes, for tests. Functions fail the test that calls them. */
#ifndef PLACIDO_TESTS_SIMULATE_CHROMATIC_H
#define PLACIDO_TESTS_SIMULATE_CHROMATIC_H

#include "simulate/effects/effect.h"

#include <placido/image.h>
#include <placido/scene.h>

/* Half a minute of arc a sample. */
static const double sample_arcmin = 0.5;

/* Dark, in a spectrum; the caller frees it with placido_scene_free. */
placido_scene dark_scene(int width_px, int height_px, int planes, enum placido_spectrum spectrum);

/* As a perfect cornea sees it for 555 nm, in focus, through `eye`'s pupil (which stays) with these
 * effects running in `wavelengths` waves, each PSF of buckets² half minutes; the caller frees
 * it. */
placido_image seen_with(const placido_scene *scene, const placido_eye *eye,
                        const placido_effect *const *effects, size_t count, int wavelengths,
                        int nodes, int buckets);

/* What `effect` answers about `eye` before `scene`; its strokes in *strokes. */
placido_answer asked(const placido_effect *effect, const placido_scene *scene,
                     const placido_eye *eye, placido_strokes *strokes);

/* Power above that for 555 nm (Thibos et al. 1992). */
double thibos_D(double wavelength_nm);

/* Luminous efficiency, from the CIE's table of 1924 every 10 nm, 380 to 780; straight between. */
double tabled_efficiency(double wavelength_nm);

#endif
