/* Features by name: numbers, texts and commands, read and written with their access checked. */
#include "drivers/genicam/feature.h"

#include "base/text.h"
#include "drivers/genicam/registers.h"
#include "drivers/genicam/value.h"

#include <stdio.h>
#include <string.h>

enum placido_feature_kind placido_genicam_feature_kind(enum kind kind) {
  static const enum placido_feature_kind kinds[KIND_COUNT] = {
      [KIND_INTEGER] = PLACIDO_FEATURE_INTEGER,
      [KIND_FLOAT] = PLACIDO_FEATURE_FLOAT,
      [KIND_BOOLEAN] = PLACIDO_FEATURE_BOOLEAN,
      [KIND_COMMAND] = PLACIDO_FEATURE_COMMAND,
      [KIND_ENUMERATION] = PLACIDO_FEATURE_ENUMERATION,
      [KIND_STRING] = PLACIDO_FEATURE_STRING,
      [KIND_KNIFE] = PLACIDO_FEATURE_FLOAT,
      [KIND_INT_KNIFE] = PLACIDO_FEATURE_INTEGER,
      [KIND_CONVERTER] = PLACIDO_FEATURE_FLOAT,
      [KIND_INT_CONVERTER] = PLACIDO_FEATURE_INTEGER,
      [KIND_INT_REG] = PLACIDO_FEATURE_INTEGER,
      [KIND_MASKED_INT_REG] = PLACIDO_FEATURE_INTEGER,
      [KIND_FLOAT_REG] = PLACIDO_FEATURE_FLOAT,
      [KIND_STRING_REG] = PLACIDO_FEATURE_STRING,
      [KIND_STRUCT_ENTRY] = PLACIDO_FEATURE_INTEGER,
  };
  return kinds[kind];
}

int placido_genicam_feature(const placido_genicam *features, const char *name, uint32_t *node,
                            placido_error *err) {
  *node = placido_genicam_find(features, name);
  if (*node == NODE_MISSING ||
      !placido_genicam_feature_kind(features->nodes[*node].kind)) {
    return placido_error_set(err, PLACIDO_INPUT, "the camera has no feature %s", name);
  }
  return PLACIDO_OK;
}

unsigned placido_genicam_begin(placido_genicam *features) {
  const unsigned outer = features->steps;
  features->steps = PLACIDO_GENICAM_STEPS_MAX;
  return outer;
}

void placido_genicam_end(placido_genicam *features, unsigned outer) {
  features->steps = outer;
}

static int wrong_kind(const char *name, const char *wanted, placido_error *err) {
  return placido_error_set(err, PLACIDO_INPUT, "the camera's feature %s is no %s", name, wanted);
}

/* Finds a feature that can be accessed so now. */
static int open_feature(placido_genicam *features, const char *name, unsigned wanted,
                        uint32_t *node, placido_error *err) {
  unsigned access;
  int status = placido_genicam_feature(features, name, node, err);
  if (!status) {
    status = placido_genicam_access(features, *node, &access, err);
  }
  if (!status && !(access & wanted)) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "the camera's feature %s cannot be %s %s", name,
                             wanted == ACCESS_READ ? "read" : "written",
                             access ? "now" : "now: it is not available");
  }
  return status;
}

static bool is_number(const placido_genicam *features, const char *name) {
  const uint32_t node = placido_genicam_find(features, name);
  const enum placido_feature_kind kind =
      node == NODE_MISSING ? PLACIDO_FEATURE_INTEGER /* told by who looks it up */
                           : placido_genicam_feature_kind(features->nodes[node].kind);
  return kind != PLACIDO_FEATURE_COMMAND && kind != PLACIDO_FEATURE_STRING;
}

static int get_number(placido_genicam *features, const char *name, struct number *value,
                      placido_error *err) {
  if (!is_number(features, name)) {
    return wrong_kind(name, "number", err);
  }
  const unsigned outer = placido_genicam_begin(features);
  uint32_t node;
  int status = open_feature(features, name, ACCESS_READ, &node, err);
  if (!status) {
    status = placido_genicam_node_get(features, node, value, err);
  }
  placido_genicam_end(features, outer);
  return status;
}

/* The entry of an enumeration with that value, one that is available where there are several;
 * NODE_NONE where there is none. */
static int entry_of(placido_genicam *features, uint32_t node, int64_t wanted, uint32_t *found,
                    unsigned *access, placido_error *err) {
  *found = NODE_NONE;
  *access = ACCESS_NONE;
  for (uint32_t p = placido_genicam_first(features, node, TAG_ENTRY); p && !*access;
       p = placido_genicam_next(features, p, TAG_ENTRY)) {
    const uint32_t entry = features->properties[p].node;
    struct number value;
    int status = placido_genicam_node_get(features, entry, &value, err);
    if (!status && value.whole == wanted) {
      *found = *found ? *found : entry;
      status = placido_genicam_access(features, entry, access, err);
      *found = *access ? entry : *found;
    }
    if (status) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static int check_entry(placido_genicam *features, uint32_t node, const struct number *value,
                       placido_error *err) {
  uint32_t entry = NODE_NONE;
  unsigned access = ACCESS_NONE;
  int64_t whole;
  if (placido_genicam_round(value, &whole)) {
    const int status = entry_of(features, node, whole, &entry, &access, err);
    if (status) {
      return status;
    }
  }
  const char *name = placido_genicam_name(features, node);
  if (!entry) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's feature %s has no entry of the value %.15g", name,
                             value->real);
  }
  if (!access) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "%s of the camera's feature %s is not available now",
                             placido_genicam_name(features, entry), name);
  }
  return PLACIDO_OK;
}

static int set_number(placido_genicam *features, const char *name, const struct number *value,
                      placido_error *err) {
  if (!is_number(features, name)) {
    return wrong_kind(name, "number", err);
  }
  const unsigned outer = placido_genicam_begin(features);
  uint32_t node;
  int status = open_feature(features, name, ACCESS_WRITE, &node, err);
  if (!status && features->nodes[node].kind == KIND_ENUMERATION) {
    status = check_entry(features, node, value, err);
  }
  if (!status && features->nodes[node].kind == KIND_BOOLEAN && value->real != 0 &&
      value->real != 1) {
    status = placido_error_set(err, PLACIDO_INPUT, "%s: %.15g is neither 0 nor 1", name,
                               value->real);
  }
  if (!status) {
    status = placido_genicam_node_set(features, node, value, err);
  }
  placido_genicam_end(features, outer);
  return status;
}

int placido_genicam_get_integer(placido_genicam *features, const char *name, int64_t *value,
                                placido_error *err) {
  struct number number = placido_genicam_whole(0);
  *value = 0;
  const int status = get_number(features, name, &number, err);
  if (!status && !placido_genicam_round(&number, value)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's feature %s is %g, which is no integer", name,
                             number.real);
  }
  return status;
}

int placido_genicam_set_integer(placido_genicam *features, const char *name, int64_t value,
                                placido_error *err) {
  const struct number number = placido_genicam_whole(value);
  return set_number(features, name, &number, err);
}

int placido_genicam_get_float(placido_genicam *features, const char *name, double *value,
                              placido_error *err) {
  struct number number = placido_genicam_whole(0);
  *value = 0;
  const int status = get_number(features, name, &number, err);
  *value = status ? 0 : number.is_whole ? (double)number.whole : number.real;
  return status;
}

int placido_genicam_set_float(placido_genicam *features, const char *name, double value,
                              placido_error *err) {
  const struct number number = placido_genicam_real(value);
  return set_number(features, name, &number, err);
}

static int get_entry_name(placido_genicam *features, uint32_t node, char *text, size_t size,
                          placido_error *err) {
  struct number value;
  uint32_t entry;
  unsigned access;
  int status = placido_genicam_node_get(features, node, &value, err);
  if (!status) {
    status = entry_of(features, node, value.whole, &entry, &access, err);
  }
  if (status) {
    return status;
  }
  if (!entry) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's feature %s is %lld, which none of its entries is",
                             placido_genicam_name(features, node), (long long)value.whole);
  }
  snprintf(text, size, "%s", placido_genicam_name(features, entry));
  return PLACIDO_OK;
}

/* Follows String nodes to the register; else *literal is the property that holds the text. */
static int find_string(placido_genicam *features, uint32_t *node, uint32_t *literal,
                       placido_error *err) {
  *literal = 0;
  for (int depth = 0; features->nodes[*node].kind == KIND_STRING; depth++) {
    uint32_t target;
    int status = placido_genicam_target(features, *node, &target, err);
    if (!status && target == NODE_NONE) {
      return placido_genicam_source(features, *node, literal, err);
    }
    if (!status && depth == PLACIDO_GENICAM_DEPTH_MAX) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "the camera's description goes round in a circle at %s",
                               placido_genicam_name(features, *node));
    }
    if (status) {
      return status;
    }
    *node = target;
  }
  if (features->nodes[*node].kind != KIND_STRING_REG) {
    return placido_error_set(err, PLACIDO_INPUT, "%s of the camera's description holds no text",
                             placido_genicam_name(features, *node));
  }
  return PLACIDO_OK;
}

static int get_string(placido_genicam *features, uint32_t node, char *text, size_t size,
                      placido_error *err) {
  uint32_t literal;
  const int status = find_string(features, &node, &literal, err);
  if (status) {
    return status;
  }
  if (features->nodes[node].kind == KIND_STRING_REG) {
    return placido_genicam_string_get(features, node, text, size, err);
  }
  snprintf(text, size, "%s", placido_genicam_text(features, literal));
  placido_text_line(text);
  return PLACIDO_OK;
}

/* Whether the feature holds a text: an enumeration's entry, or a string. */
static int open_text(placido_genicam *features, const char *name, unsigned wanted,
                     uint32_t *node, bool *is_entry, placido_error *err) {
  const int status = open_feature(features, name, wanted, node, err);
  if (status) {
    return status;
  }
  const enum placido_feature_kind kind =
      placido_genicam_feature_kind(features->nodes[*node].kind);
  *is_entry = kind == PLACIDO_FEATURE_ENUMERATION;
  return *is_entry || kind == PLACIDO_FEATURE_STRING ? PLACIDO_OK : wrong_kind(name, "text", err);
}

int placido_genicam_get_text(placido_genicam *features, const char *name, char *text, size_t size,
                             placido_error *err) {
  if (size > 0) {
    text[0] = '\0';
  }
  const unsigned outer = placido_genicam_begin(features);
  uint32_t node;
  bool is_entry;
  int status = open_text(features, name, ACCESS_READ, &node, &is_entry, err);
  if (!status) {
    status = is_entry ? get_entry_name(features, node, text, size, err)
                      : get_string(features, node, text, size, err);
  }
  placido_genicam_end(features, outer);
  return status;
}

static int set_entry(placido_genicam *features, uint32_t node, const char *text,
                     placido_error *err) {
  struct number value;
  int status = placido_genicam_entry_value(features, node, text, &value, err);
  if (!status) {
    status = check_entry(features, node, &value, err);
  }
  return status ? status : placido_genicam_node_set(features, node, &value, err);
}

static int set_string(placido_genicam *features, uint32_t node, const char *text,
                      placido_error *err) {
  uint32_t literal;
  const int status = find_string(features, &node, &literal, err);
  return status ? status : placido_genicam_string_set(features, node, text, err);
}

int placido_genicam_set_text(placido_genicam *features, const char *name, const char *text,
                             placido_error *err) {
  const unsigned outer = placido_genicam_begin(features);
  uint32_t node;
  bool is_entry;
  int status = open_text(features, name, ACCESS_WRITE, &node, &is_entry, err);
  if (!status) {
    status = is_entry ? set_entry(features, node, text, err)
                      : set_string(features, node, text, err);
  }
  placido_genicam_end(features, outer);
  return status;
}

int placido_genicam_execute(placido_genicam *features, const char *name, placido_error *err) {
  const unsigned outer = placido_genicam_begin(features);
  uint32_t node;
  int64_t value;
  int status = open_feature(features, name, ACCESS_WRITE, &node, err);
  if (!status && features->nodes[node].kind != KIND_COMMAND) {
    status = wrong_kind(name, "command", err);
  }
  if (!status) {
    status = placido_genicam_setting(features, node, TAG_COMMAND, 1, &value, err);
  }
  if (!status) {
    const struct number number = placido_genicam_whole(value);
    status = placido_genicam_node_set(features, node, &number, err);
  }
  placido_genicam_end(features, outer);
  return status;
}
