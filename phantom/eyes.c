/* The built-in eyes: a table of surfaces, each the sum of a few parts. */
#include <placido/phantom.h>
#include <stdio.h>
#include <string.h>

#define PARTS_MAX 3

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
    /* The ends of what is healthy: 46 D, and 41 D. */
    {"steep", 1, {{PLACIDO_PART_BICONIC, {.biconic = {7.4, -0.28, 7.34, -0.26, 175, 0, 0}}}}},
    {"flat", 1, {{PLACIDO_PART_BICONIC, {.biconic = {8.3, -0.18, 8.2, -0.16, 10, 0, 0}}}}},
    /* 43 and 45 D: astigmatism with the rule. */
    {"with-the-rule",
     1,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.849, -0.25, 7.5, -0.25, 0, 0, 0}}}}},
    /* 3.2 D of regular astigmatism, oblique. */
    {"astigmatic", 1, {{PLACIDO_PART_BICONIC, {.biconic = {8.04, -0.22, 7.47, -0.18, 28, 0, 0}}}}},
    /* A cone below and to the side of the middle, some 10 D steeper. Coma-like aberrations are 1.7 µm
     * over 6 mm: grade I of J. L. Alió, M. H. Shabayek, J. Refract. Surg. 22 (2006) 539. */
    {"keratoconus",
     2,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.74, -0.3, 7.58, -0.28, 12, 0, 0}}},
      {PLACIDO_PART_BUMP, {.bump = {0.036, 1.2, 1.05, 0.45, -1.15, 20}}}}},
    /* Their grade III (4.0 µm): a cone of 90 µm, and the irregularity that comes with it. */
    {"keratoconus-advanced",
     3,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.6, -0.3, 7.45, -0.3, 0, 0, 0}}},
      {PLACIDO_PART_BUMP, {.bump = {0.09, 1.2, 1.05, 0.3, -0.9, 20}}},
      {PLACIDO_PART_ZERNIKE,
       {.zernike = {{[6] = 2, [9] = -1.5, [10] = 1.2, [11] = 1.5, [14] = 1}, 4}}}}},
    /* Their grade IV (5.2 µm): 120 µm, as steep as a cone gets before it is grafted. */
    {"keratoconus-severe",
     3,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.5, -0.3, 7.3, -0.3, 0, 0, 0}}},
      {PLACIDO_PART_BUMP, {.bump = {0.12, 1.2, 1.05, 0.3, -0.8, 20}}},
      {PLACIDO_PART_ZERNIKE,
       {.zernike = {{[6] = 6, [9] = -5, [10] = 5, [11] = 5, [13] = -4, [14] = 4, [15] = 3,
                     [20] = 2.5, [21] = -2, [27] = 2},
                    4}}}}},
    /* Myopia of 4.5 D ablated over 6 mm. */
    {"post-prk",
     2,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.7, -0.2, 7.7, -0.2, 0, 0, 0}}},
      {PLACIDO_PART_ABLATION, {.ablation = {4.5, 6, 1.6, 7.7, 1.376, 0, 0}}}}},
    /* As lasers did it at first: 6 D over 5 mm with hardly a transition, a millimetre off the middle,
     * where a central island of 10 µm was left. */
    {"post-prk-early",
     3,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.7, -0.2, 7.65, -0.2, 0, 0, 0}}},
      {PLACIDO_PART_ABLATION, {.ablation = {6, 5, 0.3, 7.7, 1.376, 0.9, -0.45}}},
      {PLACIDO_PART_BUMP, {.bump = {0.01, 0.7, 0.7, 0.9, -0.45, 0}}}}},
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
    /* A sharper crease nearer to the middle, with the trefoil and coma of a scar: images 14' apart. */
    {"diplopic-scar",
     3,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.8, -0.1, 7.7, -0.1, 0, 0, 0}}},
      {PLACIDO_PART_RIDGE, {.ridge = {0.012, 0.08, 0.3, 10}}},
      {PLACIDO_PART_ZERNIKE,
       {.zernike = {{[6] = 3, [7] = 2.2, [9] = 1.5, [10] = 1.2, [11] = 1.2, [14] = 1.2}, 4}}}}},
    /* Looking past the camera. */
    {"decentred",
     1,
     {{PLACIDO_PART_BICONIC, {.biconic = {7.8, -0.22, 7.66, -0.2, 90, 0.35, -0.2}}}}},
};

static const char *const names[] = {
    "sphere",       "normal",               "steep",
    "flat",         "with-the-rule",        "astigmatic",
    "keratoconus",  "keratoconus-advanced", "keratoconus-severe",
    "post-prk",     "post-prk-early",       "irregular",
    "diplopic",     "diplopic-scar",        "decentred",
    NULL,
};

const char *const *placido_phantom_eyes(void) {
  return names;
}

/* "sphere, normal, steep": all of them. */
static void list_names(char *text, size_t size) {
  size_t length = 0;
  text[0] = '\0';
  for (const char *const *name = names; *name && length < size; name++) {
    length += (size_t)snprintf(text + length, size - length, "%s%s", name == names ? "" : ", ",
                               *name);
  }
}

int placido_phantom_eye(placido_surface **surface, const char *name, placido_error *err) {
  *surface = NULL;
  for (size_t i = 0; i < sizeof eyes / sizeof *eyes; i++) {
    if (strcmp(eyes[i].name, name) == 0) {
      return placido_surface_new(surface, 0, radius_mm, eyes[i].parts, eyes[i].part_count, NULL,
                                 err);
    }
  }
  char text[400];
  list_names(text, sizeof text);
  return placido_error_set(err, PLACIDO_INPUT, "no built-in eye is called \"%.100s\"; there are %s",
                           name, text);
}
