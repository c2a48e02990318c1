/* Variables of formulas: other nodes, their limits, and the entries of enumerations. */
#include "drivers/genicam/variable.h"

#include "drivers/genicam/value.h"

#include <string.h>

static bool is_label(const placido_genicam *features, uint32_t property, const char *name,
                     size_t length) {
  const char *label = placido_genicam_label(features, property);
  return strlen(label) == length && strncmp(label, name, length) == 0;
}

uint32_t placido_genicam_definition(const placido_genicam *features, uint32_t node,
                                    const char *name, enum tag *tag) {
  static const enum tag tags[] = {TAG_VARIABLE, TAG_CONSTANT, TAG_EXPRESSION};
  const size_t lengths[] = {strlen(name), strcspn(name, ".")};
  const size_t count = lengths[0] == lengths[1] ? 1 : 2;
  for (size_t i = 0; i < count; i++) {
    for (size_t k = 0; k < sizeof tags / sizeof *tags; k++) {
      for (uint32_t p = placido_genicam_first(features, node, tags[k]); p;
           p = placido_genicam_next(features, p, tags[k])) {
        if (is_label(features, p, name, lengths[i])) {
          *tag = tags[k];
          return p;
        }
      }
    }
  }
  return 0;
}

static int limit(placido_genicam *features, uint32_t node, uint32_t of, const char *aspect,
                 struct number *value, placido_error *err) {
  struct limits limits;
  const int status = placido_genicam_limits(features, of, &limits, err);
  if (status) {
    return status;
  }
  const struct {
    const char *aspect;
    const struct number *number;
  } rows[] = {{"Min", &limits.min}, {"Max", &limits.max}, {"Inc", &limits.step}};
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    if (strcmp(aspect, rows[i].aspect) == 0) {
      *value = *rows[i].number;
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "a formula of %s asks for .%.60s; there are .Value, .Min, .Max, .Inc "
                           "and .Entry.NAME",
                           placido_genicam_name(features, node), aspect);
}

int placido_genicam_variable(placido_genicam *features, uint32_t node, uint32_t property,
                             const char *name, struct number *value, placido_error *err) {
  const char *point = strchr(name, '.');
  const char *aspect = point ? point + 1 : "Value";
  const uint32_t of = features->properties[property].node;
  if (of == NODE_NONE || of == NODE_MISSING || strcmp(aspect, "Value") == 0) {
    return placido_genicam_property_get(features, node, property, value, err);
  }
  if (strncmp(aspect, "Entry.", 6) == 0 || strncmp(aspect, "Enum.", 5) == 0) {
    return placido_genicam_entry_value(features, of, strchr(aspect, '.') + 1, value, err);
  }
  return limit(features, node, of, aspect, value, err);
}
