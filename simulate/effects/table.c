/* The effects, a row each, in the order in which they act. */
#include "simulate/effects/effect.h"

#include <string.h>

static const placido_effect *const effects[] = {
  &placido_effect_rest_of_eye,
  &placido_effect_pupil,
  &placido_effect_stiles_crawford,
  &placido_effect_longitudinal_chromatic,
  &placido_effect_transverse_chromatic,
  &placido_effect_diffraction,
  &placido_effect_object_distance,
  &placido_effect_field,
  &placido_effect_straylight,
  &placido_effect_receptors,
  NULL,
};

enum { EFFECTS = sizeof effects / sizeof *effects - 1 };

const placido_effect *const *placido_effect_table(size_t *count) {
  *count = EFFECTS;
  return effects;
}

int placido_effect_find(const char *name) {
  for (int i = 0; i < EFFECTS; i++) {
    if (strcmp(effects[i]->name, name) == 0) {
      return i;
    }
  }
  return -1;
}

bool placido_effect_at(size_t index, const char **name, const char **summary) {
  if (index >= EFFECTS) {
    return false;
  }
  *name = effects[index]->name;
  *summary = effects[index]->summary;
  return true;
}
