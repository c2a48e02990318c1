/* The grid on which plans are held to their word: scenes, eyes and pupils. */
#ifndef PLACIDO_TESTS_SIMULATE_GRID_H
#define PLACIDO_TESTS_SIMULATE_GRID_H

#include <placido/plan.h>

enum { GRID_SCENES = 7, GRID_EYES = 6, GRID_PUPILS = 4 };

extern const char *const grid_scenes[GRID_SCENES];
extern const char *const grid_eyes[GRID_EYES];
extern const double grid_pupils_mm[GRID_PUPILS]; /* 0: what the luminance gives */

/* The cornea called grid_eyes[number]; free with placido_surface_free. */
placido_surface *grid_cornea(int number);

/* Part of the scene grid_scenes[number], drawn at arcmin_per_px: side_px a side at most, where there
 * is much to be seen, its rim continued outwards as a bleed. All but "colours" are grey. Free with
 * placido_scene_free. */
placido_scene grid_scene(int number, double arcmin_per_px, int side_px);

#endif
