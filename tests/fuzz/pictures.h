/* What is true of pictures that were read. */
#ifndef PLACIDO_TESTS_FUZZ_PICTURES_H
#define PLACIDO_TESTS_FUZZ_PICTURES_H

#include <placido/image.h>
#include <placido/scene.h>

/* Sizes within their limits; `light`: every sample is finite and at least 0. */
void fuzz_check_image(const placido_image *image, bool light);

/* A scene as placido_scene_load promises it. */
void fuzz_check_scene(const placido_scene *scene);

#endif
