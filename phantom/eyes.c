/* The built-in eyes: a table of surfaces, each the sum of a few parts. */
#include <placido/phantom.h>
#include <string.h>

#define PARTS_MAX 2

/* A surface of the table; its vertex is the origin. */
typedef struct eye {
  const char *name;
  size_t part_count;
  placido_part parts[PARTS_MAX];
} eye;

/* Far enough out for all mires and the soft border around them. */
static const double radius_mm = 5.6;

static const eye eyes[] = {
    /* A ball of calibration glass. */
    {"sphere", 1, {{PLACIDO_PART_BICONIC, {.biconic = {7.8, 0, 7.8, 0, 0, 0, 0}}}}},
    /* Mean radius and asphericity of healthy eyes, half a dioptre with the rule. */
    {"normal", 1, {{PLACIDO_PART_BICONIC, {.biconic = {7.84, -0.24, 7.75, -0.2, 4, 0, 0}}}}},
    /* 3.2 D of regular astigmatism, oblique. */
    {"astigmatic", 1, {{PLACIDO_PART_BICONIC, {.biconic = {8.04, -0.22, 7.47, -0.18, 28, 0, 0}}}}},
    /* A cone below and to the side of the middle, some 10 D steeper. */
    {"keratoconus",
     2,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.74, -0.3, 7.58, -0.28, 12, 0, 0}}},
      {PLACIDO_PART_BUMP, {.bump = {0.036, 1.2, 1.05, 0.45, -1.15, 20}}}}},
    /* Myopia of 4.5 D ablated over 6 mm. */
    {"post-prk",
     2,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.7, -0.2, 7.7, -0.2, 0, 0, 0}}},
      {PLACIDO_PART_ABLATION, {.ablation = {4.5, 6, 1.6, 7.7, 1.376, 0, 0}}}}},
    /* Trefoil, coma and smaller terms, as after a scar. */
    {"irregular",
     2,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.88, -0.12, 7.56, -0.05, 150, 0, 0}}},
      {PLACIDO_PART_ZERNIKE,
       {.zernike =
            {{[6] = -1.4, [7] = 2.1, [8] = -1.2, [9] = 0.9, [11] = 0.8, [12] = -0.7, [16] = 0.5},
             4}}}}},
    /* A crease that turns the upper third by 5 mrad: two images with one eye. */
    {"diplopic",
     2,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.8, -0.22, 7.7, -0.2, 0, 0, 0}}},
      {PLACIDO_PART_RIDGE, {.ridge = {0.005, 0.15, 0.6, 10}}}}},
    /* Looking past the camera. */
    {"decentred",
     1,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.8, -0.22, 7.66, -0.2, 90, 0.35, -0.2}}}}},
};

static const char *const names[] = {
    "sphere",    "normal",   "astigmatic", "keratoconus", "post-prk",
    "irregular", "diplopic", "decentred",  NULL,
};

const char *const *placido_phantom_eyes(void) {
  return names;
}

int placido_phantom_eye(placido_surface **surface, const char *name, placido_error *err) {
  *surface = NULL;
  for (size_t i = 0; i < sizeof eyes / sizeof *eyes; i++) {
    if (strcmp(eyes[i].name, name) == 0) {
      return placido_surface_new(surface, 0, radius_mm, eyes[i].parts, eyes[i].part_count, NULL,
                                 err);
    }
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "no built-in eye is called \"%s\"; there are sphere, normal, "
                           "astigmatic, keratoconus, post-prk, irregular, diplopic, decentred",
                           name);
}
