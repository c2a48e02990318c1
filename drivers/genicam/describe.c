/* What a feature is now, which entries it has, and which features there are. */
#include "drivers/genicam/feature.h"

#include "base/text.h"
#include "drivers/genicam/value.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The unit of a feature, or of what stands behind it. */
static int find_unit(placido_genicam *features, uint32_t node, char *unit, size_t size,
                     placido_error *err) {
  for (int depth = 0; node != NODE_NONE && depth < PLACIDO_GENICAM_DEPTH_MAX; depth++) {
    const uint32_t property = placido_genicam_first(features, node, TAG_UNIT);
    if (property) {
      snprintf(unit, size, "%s", placido_genicam_text(features, property));
      placido_text_line(unit);
      return PLACIDO_OK;
    }
    const int status = placido_genicam_target(features, node, &node, err);
    if (status) {
      return status;
    }
  }
  return PLACIDO_OK;
}

static bool is_number(enum placido_feature_kind kind) {
  return kind == PLACIDO_FEATURE_INTEGER || kind == PLACIDO_FEATURE_FLOAT ||
         kind == PLACIDO_FEATURE_BOOLEAN || kind == PLACIDO_FEATURE_ENUMERATION;
}

static int describe(placido_genicam *features, uint32_t node, placido_feature *feature,
                    placido_error *err) {
  unsigned access;
  int status = placido_genicam_access(features, node, &access, err);
  feature->can_read = !status && (access & ACCESS_READ);
  feature->can_write = !status && (access & ACCESS_WRITE);
  /* The limits of what is not there lie in registers that may not be there either. */
  if (status || !access || !is_number(feature->kind)) {
    return status;
  }
  struct limits limits;
  status = placido_genicam_limits(features, node, &limits, err);
  if (status) {
    return status;
  }
  feature->min = limits.min.real;
  feature->max = limits.max.real;
  feature->step = limits.step.real;
  return find_unit(features, node, feature->unit, sizeof feature->unit, err);
}

int placido_genicam_describe(placido_genicam *features, const char *name,
                             placido_feature *feature, placido_error *err) {
  *feature = (placido_feature){.kind = PLACIDO_FEATURE_NONE, .min = NAN, .max = NAN};
  const uint32_t node = placido_genicam_find(features, name);
  if (node == NODE_MISSING) {
    return PLACIDO_OK;
  }
  feature->kind = placido_genicam_feature_kind(features->nodes[node].kind);
  if (feature->kind == PLACIDO_FEATURE_NONE) {
    return PLACIDO_OK;
  }
  const unsigned outer = placido_genicam_begin(features);
  const int status = describe(features, node, feature, err);
  placido_genicam_end(features, outer);
  return status;
}

static int each_entry(placido_genicam *features, uint32_t node,
                      int (*each)(void *user, const char *entry, int64_t value), void *user,
                      placido_error *err) {
  int status = PLACIDO_OK;
  for (uint32_t p = placido_genicam_first(features, node, TAG_ENTRY); p && !status;
       p = placido_genicam_next(features, p, TAG_ENTRY)) {
    const uint32_t entry = features->properties[p].node;
    struct number value;
    unsigned access;
    status = placido_genicam_access(features, entry, &access, err);
    if (!status && access) {
      status = placido_genicam_node_get(features, entry, &value, err);
      if (!status) {
        status = each(user, placido_genicam_name(features, entry), value.whole);
      }
    }
  }
  return status;
}

int placido_genicam_entries(placido_genicam *features, const char *name,
                            int (*each)(void *user, const char *entry, int64_t value), void *user,
                            placido_error *err) {
  uint32_t node;
  int status = placido_genicam_feature(features, name, &node, err);
  if (status) {
    return status;
  }
  if (features->nodes[node].kind != KIND_ENUMERATION) {
    return placido_error_set(err, PLACIDO_INPUT, "the camera's feature %s is no enumeration",
                             name);
  }
  const unsigned outer = placido_genicam_begin(features);
  status = each_entry(features, node, each, user, err);
  placido_genicam_end(features, outer);
  return status;
}

/* The features of a category and of those within it. */
static int each_feature(placido_genicam *features, uint32_t category,
                        int (*each)(void *user, const char *name, const char *category),
                        void *user, placido_error *err) {
  int status = placido_genicam_enter(features, category, err);
  if (status) {
    return status;
  }
  const char *within = placido_genicam_name(features, category);
  for (uint32_t p = placido_genicam_first(features, category, TAG_FEATURE); p && !status;
       p = placido_genicam_next(features, p, TAG_FEATURE)) {
    const uint32_t node = features->properties[p].node;
    if (node == NODE_MISSING) {
      continue; /* real descriptions list features that this model does not have */
    }
    const enum kind kind = features->nodes[node].kind;
    if (kind == KIND_CATEGORY) {
      status = each_feature(features, node, each, user, err);
    } else if (placido_genicam_feature_kind(kind)) {
      status = each(user, placido_genicam_name(features, node), within);
    }
  }
  placido_genicam_leave(features);
  return status;
}

int placido_genicam_each(placido_genicam *features,
                         int (*each)(void *user, const char *name, const char *category),
                         void *user, placido_error *err) {
  const uint32_t root = placido_genicam_find(features, "Root");
  if (root == NODE_MISSING || features->nodes[root].kind != KIND_CATEGORY) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's description has no category Root");
  }
  const unsigned outer = placido_genicam_begin(features);
  const int status = each_feature(features, root, each, user, err);
  placido_genicam_end(features, outer);
  return status;
}
