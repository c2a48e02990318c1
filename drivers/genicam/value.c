/* The value of a node by its kind: straight, from a formula, or from a register. */
#include "drivers/genicam/value.h"

#include "drivers/genicam/formula.h"
#include "drivers/genicam/registers.h"

#include <string.h>

static int missing(const placido_genicam *features, uint32_t node, uint32_t property,
                   placido_error *err) {
  return placido_error_set(err, PLACIDO_INPUT,
                           "%s of the camera's description names %s, which is not there",
                           placido_genicam_name(features, node),
                           placido_genicam_text(features, property));
}

int placido_genicam_property_get(placido_genicam *features, uint32_t node, uint32_t property,
                                 struct number *value, placido_error *err) {
  const struct property *from = &features->properties[property];
  *value = from->number;
  if (from->node == NODE_MISSING) {
    return missing(features, node, property, err);
  }
  if (from->node != NODE_NONE) {
    return placido_genicam_node_get(features, from->node, value, err);
  }
  if (!from->has_number) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s of the camera's description: \"%s\" is no number",
                             placido_genicam_name(features, node),
                             placido_genicam_text(features, property));
  }
  return PLACIDO_OK;
}

int placido_genicam_setting(placido_genicam *features, uint32_t node, enum tag tag,
                            int64_t fallback, int64_t *value, placido_error *err) {
  const uint32_t property = placido_genicam_first(features, node, tag);
  *value = fallback;
  if (!property) {
    return PLACIDO_OK;
  }
  struct number number;
  const int status = placido_genicam_property_get(features, node, property, &number, err);
  if (!status && !placido_genicam_round(&number, value)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s of the camera's description: %g is beyond 64 bits",
                             placido_genicam_name(features, node), number.real);
  }
  return status;
}

/* The value of that index, or the one for all others. */
static int indexed(placido_genicam *features, uint32_t node, uint32_t index, uint32_t *property,
                   placido_error *err) {
  struct number at;
  const int status = placido_genicam_property_get(features, node, index, &at, err);
  if (status) {
    return status;
  }
  int64_t wanted;
  uint32_t found = 0;
  if (placido_genicam_round(&at, &wanted)) {
    for (found = placido_genicam_first(features, node, TAG_VALUE_INDEXED); found;
         found = placido_genicam_next(features, found, TAG_VALUE_INDEXED)) {
      struct number label;
      if (placido_genicam_number_read(&label, placido_genicam_label(features, found)) &&
          label.is_whole && label.whole == wanted) {
        break;
      }
    }
  }
  *property = found ? found : placido_genicam_first(features, node, TAG_VALUE_DEFAULT);
  return PLACIDO_OK;
}

int placido_genicam_source(placido_genicam *features, uint32_t node, uint32_t *property,
                           placido_error *err) {
  *property = 0;
  const uint32_t index = placido_genicam_first(features, node, TAG_INDEX);
  if (index) {
    const int status = indexed(features, node, index, property, err);
    if (status || *property) {
      return status;
    }
  }
  *property = placido_genicam_first(features, node, TAG_VALUE);
  return PLACIDO_OK;
}

int placido_genicam_target(placido_genicam *features, uint32_t node, uint32_t *target,
                           placido_error *err) {
  uint32_t property;
  *target = NODE_NONE;
  const int status = placido_genicam_source(features, node, &property, err);
  if (status) {
    return status;
  }
  if (features->properties[property].node == NODE_MISSING) {
    return missing(features, node, property, err);
  }
  *target = features->properties[property].node;
  return PLACIDO_OK;
}

static int without_value(const placido_genicam *features, uint32_t node, placido_error *err) {
  return placido_error_set(err, PLACIDO_INPUT, "%s of the camera's description holds no number",
                           placido_genicam_name(features, node));
}

static int get_plain(placido_genicam *features, uint32_t node, struct number *value,
                     placido_error *err) {
  uint32_t property;
  int status = placido_genicam_source(features, node, &property, err);
  if (status) {
    return status;
  }
  if (!property) {
    return without_value(features, node, err);
  }
  status = placido_genicam_property_get(features, node, property, value, err);
  if (status) {
    return status;
  }
  const enum kind kind = features->nodes[node].kind;
  int64_t whole, on;
  if (kind == KIND_FLOAT) {
    *value = placido_genicam_real(value->is_whole ? (double)value->whole : value->real);
    return PLACIDO_OK;
  }
  if (!placido_genicam_round(value, &whole)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s is %g, beyond 64 bits",
                             placido_genicam_name(features, node), value->real);
  }
  if (kind == KIND_BOOLEAN) {
    status = placido_genicam_setting(features, node, TAG_ON, 1, &on, err);
    whole = whole == on;
  }
  *value = placido_genicam_whole(whole);
  return status;
}

/* Into the node or the element that holds the value, and into those that follow it. */
static int put(placido_genicam *features, uint32_t node, const struct number *value,
               placido_error *err) {
  uint32_t property;
  int status = placido_genicam_source(features, node, &property, err);
  if (status) {
    return status;
  }
  struct property *to = &features->properties[property];
  if (!property) {
    return without_value(features, node, err);
  }
  if (to->node == NODE_MISSING) {
    return missing(features, node, property, err);
  }
  if (to->node != NODE_NONE) {
    status = placido_genicam_node_set(features, to->node, value, err);
  } else {
    to->number = *value;
    to->has_number = true;
    placido_genicam_forget(features);
  }
  for (uint32_t copy = placido_genicam_first(features, node, TAG_VALUE_COPY); copy && !status;
       copy = placido_genicam_next(features, copy, TAG_VALUE_COPY)) {
    const uint32_t follower = features->properties[copy].node;
    status = follower == NODE_MISSING ? missing(features, node, copy, err)
                                      : placido_genicam_node_set(features, follower, value, err);
  }
  return status;
}

static int set_plain(placido_genicam *features, uint32_t node, const struct number *value,
                     placido_error *err) {
  struct number checked = *value;
  const int status = placido_genicam_limits_check(features, node, &checked, err);
  return status ? status : put(features, node, &checked, err);
}

static int set_boolean(placido_genicam *features, uint32_t node, const struct number *value,
                       placido_error *err) {
  const bool is_on = value->real != 0;
  int64_t whole;
  const int status = placido_genicam_setting(features, node, is_on ? TAG_ON : TAG_OFF, is_on,
                                             &whole, err);
  if (status) {
    return status;
  }
  const struct number number = placido_genicam_whole(whole);
  return put(features, node, &number, err);
}

static int evaluate(placido_genicam *features, uint32_t node, enum tag tag,
                    const char *input_name, const struct number *input, struct number *value,
                    placido_error *err) {
  const enum kind kind = features->nodes[node].kind;
  const uint32_t formula = placido_genicam_first(features, node, tag);
  return placido_genicam_formula(features, node, placido_genicam_text(features, formula),
                                 kind == KIND_INT_KNIFE || kind == KIND_INT_CONVERTER, input_name,
                                 input, value, err);
}

static int get_knife(placido_genicam *features, uint32_t node, struct number *value,
                     placido_error *err) {
  return evaluate(features, node, TAG_FORMULA, NULL, NULL, value, err);
}

int placido_genicam_from_raw(placido_genicam *features, uint32_t node, const struct number *raw,
                             struct number *value, placido_error *err) {
  return evaluate(features, node, TAG_FORMULA_FROM, "TO", raw, value, err);
}

static int get_converter(placido_genicam *features, uint32_t node, struct number *value,
                         placido_error *err) {
  const uint32_t property = placido_genicam_first(features, node, TAG_VALUE);
  struct number raw;
  if (!property) {
    return without_value(features, node, err);
  }
  const int status = placido_genicam_property_get(features, node, property, &raw, err);
  return status ? status : placido_genicam_from_raw(features, node, &raw, value, err);
}

static int set_converter(placido_genicam *features, uint32_t node, const struct number *value,
                         placido_error *err) {
  struct number checked = *value, raw;
  int status = placido_genicam_limits_check(features, node, &checked, err);
  if (!status) {
    status = evaluate(features, node, TAG_FORMULA_TO, "FROM", &checked, &raw, err);
  }
  return status ? status : put(features, node, &raw, err);
}

/* How the value of a kind is read and written. NULL: it is not. */
static const struct {
  int (*get)(placido_genicam *features, uint32_t node, struct number *value, placido_error *err);
  int (*set)(placido_genicam *features, uint32_t node, const struct number *value,
             placido_error *err);
} table[KIND_COUNT] = {
    [KIND_INTEGER] = {get_plain, set_plain},
    [KIND_FLOAT] = {get_plain, set_plain},
    [KIND_BOOLEAN] = {get_plain, set_boolean},
    [KIND_COMMAND] = {get_plain, put},
    [KIND_ENUMERATION] = {get_plain, put},
    [KIND_ENUM_ENTRY] = {get_plain, NULL},
    [KIND_KNIFE] = {get_knife, NULL},
    [KIND_INT_KNIFE] = {get_knife, NULL},
    [KIND_CONVERTER] = {get_converter, set_converter},
    [KIND_INT_CONVERTER] = {get_converter, set_converter},
    [KIND_INT_REG] = {placido_genicam_integer_get, placido_genicam_integer_set},
    [KIND_MASKED_INT_REG] = {placido_genicam_integer_get, placido_genicam_integer_set},
    [KIND_STRUCT_ENTRY] = {placido_genicam_integer_get, placido_genicam_integer_set},
    [KIND_FLOAT_REG] = {placido_genicam_float_get, placido_genicam_float_set},
};

int placido_genicam_node_get(placido_genicam *features, uint32_t node, struct number *value,
                             placido_error *err) {
  *value = placido_genicam_whole(0);
  int status = placido_genicam_enter(features, node, err);
  if (status) {
    return status;
  }
  const enum kind kind = features->nodes[node].kind;
  status = table[kind].get ? table[kind].get(features, node, value, err)
                           : without_value(features, node, err);
  placido_genicam_leave(features);
  return status;
}

int placido_genicam_node_set(placido_genicam *features, uint32_t node, const struct number *value,
                             placido_error *err) {
  int status = placido_genicam_enter(features, node, err);
  if (status) {
    return status;
  }
  const enum kind kind = features->nodes[node].kind;
  status = table[kind].set ? table[kind].set(features, node, value, err)
                           : placido_error_set(err, PLACIDO_UNSUPPORTED,
                                               "%s of the camera cannot be written",
                                               placido_genicam_name(features, node));
  placido_genicam_leave(features);
  return status;
}

/* An enumeration's entries belong to the name of the enumeration, not to the description. */
int placido_genicam_entry_value(placido_genicam *features, uint32_t node, const char *name,
                                struct number *value, placido_error *err) {
  for (uint32_t p = placido_genicam_first(features, node, TAG_ENTRY); p;
       p = placido_genicam_next(features, p, TAG_ENTRY)) {
    const uint32_t entry = features->properties[p].node;
    if (strcmp(placido_genicam_name(features, entry), name) == 0) {
      return placido_genicam_node_get(features, entry, value, err);
    }
  }
  return placido_error_set(err, PLACIDO_INPUT, "%s of the camera has no entry %s",
                           placido_genicam_name(features, node), name);
}
