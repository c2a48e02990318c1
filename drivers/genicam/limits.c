/* Limits of a number: what the description says, else those of what stands behind it. */
#include "drivers/genicam/value.h"

#include "drivers/genicam/registers.h"

#include <float.h>
#include <math.h>
#include <string.h>

static struct limits widest_whole(void) {
  return (struct limits){.min = placido_genicam_whole(INT64_MIN),
                         .max = placido_genicam_whole(INT64_MAX),
                         .step = placido_genicam_whole(1)};
}

static struct limits widest_real(void) {
  return (struct limits){.min = placido_genicam_real(-DBL_MAX),
                         .max = placido_genicam_real(DBL_MAX),
                         .step = placido_genicam_real(0)};
}

static bool is_whole_kind(enum kind kind) {
  return kind != KIND_FLOAT && kind != KIND_FLOAT_REG && kind != KIND_KNIFE &&
         kind != KIND_CONVERTER;
}

/* The nearest number of the node's kind; beyond 64 bits the last that fits. */
static struct number fit(const struct number *number, bool is_whole) {
  const double real = number->real;
  int64_t whole;
  if (!is_whole) {
    return placido_genicam_real(real);
  }
  if (real >= 0x1p63) {
    return placido_genicam_whole(INT64_MAX);
  }
  return placido_genicam_whole(placido_genicam_round(number, &whole) ? whole : INT64_MIN);
}

/* Min, Max and Inc of a node that stands for another. */
static int plain_limits(placido_genicam *features, uint32_t node, struct limits *limits,
                        placido_error *err) {
  const struct {
    enum tag tag;
    struct number *number;
  } rows[] = {{TAG_MIN, &limits->min}, {TAG_MAX, &limits->max}, {TAG_STEP, &limits->step}};
  const bool is_whole = features->nodes[node].kind == KIND_INTEGER;
  uint32_t target;
  int status = placido_genicam_target(features, node, &target, err);
  if (!status && target != NODE_NONE) {
    status = placido_genicam_limits(features, target, limits, err);
    if (!status && !is_whole && is_whole_kind(features->nodes[target].kind) &&
        limits->min.whole == INT64_MIN && limits->max.whole == INT64_MAX) {
      const struct number step = limits->step;
      *limits = widest_real();
      limits->step = step;
    }
  }
  for (size_t i = 0; i < sizeof rows / sizeof *rows && !status; i++) {
    const uint32_t property = placido_genicam_first(features, node, rows[i].tag);
    if (property) {
      status = placido_genicam_property_get(features, node, property, rows[i].number, err);
    }
    *rows[i].number = fit(rows[i].number, is_whole);
  }
  if (is_whole && limits->step.whole < 1) {
    limits->step = placido_genicam_whole(1);
  }
  return status;
}

static int register_limits(placido_genicam *features, uint32_t node, struct limits *limits,
                           placido_error *err) {
  int64_t min, max;
  const int status = placido_genicam_integer_range(features, node, &min, &max, err);
  if (!status) {
    limits->min = placido_genicam_whole(min);
    limits->max = placido_genicam_whole(max);
  }
  return status;
}

static bool is_widest(const struct number *number) {
  return number->is_whole ? number->whole == INT64_MIN || number->whole == INT64_MAX
                          : fabs(number->real) >= DBL_MAX;
}

/* A limit of what is converted, converted. *is_known is false where there is none, or the formula
 * cannot make a number of it (as 1/0). */
static int convert(placido_genicam *features, uint32_t node, const struct number *raw,
                   struct number *limit, bool *is_known, placido_error *err) {
  *is_known = false;
  if (is_widest(raw)) {
    return PLACIDO_OK;
  }
  const int status = placido_genicam_from_raw(features, node, raw, limit, err);
  *is_known = !status;
  return status == PLACIDO_INPUT ? PLACIDO_OK : status;
}

static int converter_limits(placido_genicam *features, uint32_t node, struct limits *limits,
                            placido_error *err) {
  const uint32_t slope = placido_genicam_first(features, node, TAG_SLOPE);
  uint32_t target;
  int status = placido_genicam_target(features, node, &target, err);
  if (status || target == NODE_NONE ||
      strcmp(placido_genicam_text(features, slope), "Varying") == 0) {
    return status;
  }
  struct limits raw;
  struct number ends[2];
  bool is_known[2] = {false, false};
  status = placido_genicam_limits(features, target, &raw, err);
  if (!status) {
    status = convert(features, node, &raw.min, &ends[0], &is_known[0], err);
  }
  if (!status) {
    status = convert(features, node, &raw.max, &ends[1], &is_known[1], err);
  }
  /* Of one end alone nobody knows which it becomes. */
  if (status || !is_known[0] || !is_known[1]) {
    return status;
  }
  /* The slope shows in where the ends go; files that tell it wrong are read right this way. */
  const bool is_falling = ends[0].is_whole ? ends[0].whole > ends[1].whole
                                           : ends[0].real > ends[1].real;
  limits->min = ends[is_falling];
  limits->max = ends[!is_falling];
  return PLACIDO_OK;
}

static int boolean_limits(placido_genicam *features, uint32_t node, struct limits *limits,
                          placido_error *err) {
  (void)features;
  (void)node;
  (void)err;
  limits->min = placido_genicam_whole(0);
  limits->max = placido_genicam_whole(1);
  return PLACIDO_OK;
}

static int enumeration_limits(placido_genicam *features, uint32_t node, struct limits *limits,
                              placido_error *err) {
  int status = PLACIDO_OK;
  bool is_first = true;
  for (uint32_t p = placido_genicam_first(features, node, TAG_ENTRY); p && !status;
       p = placido_genicam_next(features, p, TAG_ENTRY)) {
    struct number value;
    status = placido_genicam_node_get(features, features->properties[p].node, &value, err);
    if (is_first || value.whole < limits->min.whole) {
      limits->min = value;
    }
    if (is_first || value.whole > limits->max.whole) {
      limits->max = value;
    }
    is_first = false;
  }
  return status;
}

/* How the limits of a kind are found. NULL: the widest. */
static int (*const table[KIND_COUNT])(placido_genicam *features, uint32_t node,
                                      struct limits *limits, placido_error *err) = {
    [KIND_INTEGER] = plain_limits,
    [KIND_FLOAT] = plain_limits,
    [KIND_BOOLEAN] = boolean_limits,
    [KIND_ENUMERATION] = enumeration_limits,
    [KIND_CONVERTER] = converter_limits,
    [KIND_INT_CONVERTER] = converter_limits,
    [KIND_INT_REG] = register_limits,
    [KIND_MASKED_INT_REG] = register_limits,
    [KIND_STRUCT_ENTRY] = register_limits,
};

int placido_genicam_limits(placido_genicam *features, uint32_t node, struct limits *limits,
                           placido_error *err) {
  const enum kind kind = features->nodes[node].kind;
  *limits = is_whole_kind(kind) ? widest_whole() : widest_real();
  int status = placido_genicam_enter(features, node, err);
  if (status) {
    return status;
  }
  if (table[kind]) {
    status = table[kind](features, node, limits, err);
  }
  placido_genicam_leave(features);
  return status;
}

static int check_whole(const placido_genicam *features, uint32_t node,
                       const struct limits *limits, struct number *value, placido_error *err) {
  const char *name = placido_genicam_name(features, node);
  const int64_t min = limits->min.whole, max = limits->max.whole, step = limits->step.whole;
  int64_t whole;
  if (!placido_genicam_round(value, &whole) || whole < min || whole > max) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %.15g is not from %lld to %lld", name,
                             value->real, (long long)min, (long long)max);
  }
  const uint64_t above = (uint64_t)whole - (min == INT64_MIN ? 0 : (uint64_t)min);
  if (step > 1 && above % (uint64_t)step != 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %lld is not in steps of %lld from %lld",
                             name, (long long)whole, (long long)step,
                             (long long)(min == INT64_MIN ? 0 : min));
  }
  *value = placido_genicam_whole(whole);
  return PLACIDO_OK;
}

static int check_real(const placido_genicam *features, uint32_t node,
                      const struct limits *limits, struct number *value, placido_error *err) {
  /* Far less than a camera can resolve, and more than formulas lose there and back. */
  const double share = 1e-9;
  const double min = limits->min.real, max = limits->max.real, real = value->real;
  if (!(real >= min - share * fabs(min) && real <= max + share * fabs(max))) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %.15g is not from %.15g to %.15g",
                             placido_genicam_name(features, node), real, min, max);
  }
  *value = placido_genicam_real(real < min ? min : real > max ? max : real);
  return PLACIDO_OK;
}

int placido_genicam_limits_check(placido_genicam *features, uint32_t node, struct number *value,
                                 placido_error *err) {
  struct limits limits;
  const int status = placido_genicam_limits(features, node, &limits, err);
  if (status) {
    return status;
  }
  return is_whole_kind(features->nodes[node].kind)
             ? check_whole(features, node, &limits, value, err)
             : check_real(features, node, &limits, value, err);
}
