/* Whether a node can be read and written now. */
#include "drivers/genicam/value.h"

#include <string.h>

/* Of the node that a property names. */
static int access_of(placido_genicam *features, uint32_t node, uint32_t property,
                     unsigned *access, placido_error *err) {
  const uint32_t named = features->properties[property].node;
  *access = ACCESS_NONE;
  if (named == NODE_MISSING) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s of the camera's description names %s, which is not there",
                             placido_genicam_name(features, node),
                             placido_genicam_text(features, property));
  }
  return placido_genicam_access(features, named, access, err);
}

/* A value that stands in the description itself can be changed there. */
static int plain_access(placido_genicam *features, uint32_t node, unsigned *access,
                        placido_error *err) {
  uint32_t property;
  const int status = placido_genicam_source(features, node, &property, err);
  if (status || !property) {
    *access = ACCESS_NONE;
    return status;
  }
  if (features->properties[property].node == NODE_NONE) {
    const bool is_text = features->nodes[node].kind == KIND_STRING;
    *access = is_text ? ACCESS_READ : ACCESS_BOTH;
    return PLACIDO_OK;
  }
  return access_of(features, node, property, access, err);
}

/* A formula cannot be evaluated while one of its variables cannot be read. A variable that is not
 * there at all is told when the formula really needs it. */
static int knife_access(placido_genicam *features, uint32_t node, unsigned *access,
                        placido_error *err) {
  *access = ACCESS_READ;
  for (uint32_t p = placido_genicam_first(features, node, TAG_VARIABLE); p;
       p = placido_genicam_next(features, p, TAG_VARIABLE)) {
    unsigned variable;
    if (features->properties[p].node == NODE_MISSING) {
      continue;
    }
    const int status = access_of(features, node, p, &variable, err);
    if (status || !(variable & ACCESS_READ)) {
      *access = ACCESS_NONE;
      return status;
    }
  }
  return PLACIDO_OK;
}

static int converter_access(placido_genicam *features, uint32_t node, unsigned *access,
                            placido_error *err) {
  const int status = knife_access(features, node, access, err);
  return status || !*access ? status : plain_access(features, node, access, err);
}

/* Registers that say nothing can only be read; those of a chunk or an event are not in the camera
 * but in what it sends. */
static int register_access(placido_genicam *features, uint32_t node, unsigned *access,
                           placido_error *err) {
  (void)err;
  const uint32_t port = placido_genicam_first(features, node, TAG_PORT);
  const uint32_t device = features->properties[port].node;
  const bool is_foreign = device != NODE_NONE && device != NODE_MISSING &&
                          placido_genicam_first(features, device, TAG_FOREIGN);
  const bool is_silent = !placido_genicam_first(features, node, TAG_ACCESS);
  *access = is_foreign ? ACCESS_NONE : is_silent ? ACCESS_READ : ACCESS_BOTH;
  return PLACIDO_OK;
}

static int entry_access(placido_genicam *features, uint32_t node, unsigned *access,
                        placido_error *err) {
  (void)features;
  (void)node;
  (void)err;
  *access = ACCESS_BOTH;
  return PLACIDO_OK;
}

/* What a kind allows by itself. NULL: nothing. */
static int (*const table[KIND_COUNT])(placido_genicam *features, uint32_t node, unsigned *access,
                                      placido_error *err) = {
    [KIND_INTEGER] = plain_access,
    [KIND_FLOAT] = plain_access,
    [KIND_BOOLEAN] = plain_access,
    [KIND_COMMAND] = plain_access,
    [KIND_ENUMERATION] = plain_access,
    [KIND_ENUM_ENTRY] = entry_access,
    [KIND_STRING] = plain_access,
    [KIND_KNIFE] = knife_access,
    [KIND_INT_KNIFE] = knife_access,
    [KIND_CONVERTER] = converter_access,
    [KIND_INT_CONVERTER] = converter_access,
    [KIND_INT_REG] = register_access,
    [KIND_MASKED_INT_REG] = register_access,
    [KIND_FLOAT_REG] = register_access,
    [KIND_STRING_REG] = register_access,
    [KIND_REGISTER] = register_access,
    [KIND_STRUCT_ENTRY] = register_access,
};

/* Narrowed by AccessMode and ImposedAccessMode, as far as they stand there. */
static unsigned narrow(const placido_genicam *features, uint32_t node, unsigned access) {
  static const struct {
    const char *mode;
    unsigned access;
  } modes[] = {{"RO", ACCESS_READ},  {"WO", ACCESS_WRITE}, {"RW", ACCESS_BOTH},
               {"NA", ACCESS_NONE}, {"NI", ACCESS_NONE}};
  for (uint32_t p = placido_genicam_first(features, node, TAG_ACCESS); p;
       p = placido_genicam_next(features, p, TAG_ACCESS)) {
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
      if (strcmp(placido_genicam_text(features, p), modes[i].mode) == 0) {
        access &= modes[i].access;
      }
    }
  }
  return access;
}

/* What is left of the access where one of the conditions fails. */
static int restrict_access(placido_genicam *features, uint32_t node, unsigned *access,
                           placido_error *err) {
  static const struct {
    enum tag tag;
    bool wanted;
    unsigned left;
  } conditions[] = {{TAG_IS_IMPLEMENTED, true, ACCESS_NONE},
                    {TAG_IS_AVAILABLE, true, ACCESS_NONE},
                    {TAG_IS_LOCKED, false, ACCESS_READ}};
  for (size_t i = 0; i < sizeof conditions / sizeof *conditions; i++) {
    for (uint32_t p = placido_genicam_first(features, node, conditions[i].tag); p && *access;
         p = placido_genicam_next(features, p, conditions[i].tag)) {
      struct number value;
      const int status = placido_genicam_property_get(features, node, p, &value, err);
      if (status) {
        return status;
      }
      if ((value.real != 0) != conditions[i].wanted) {
        *access &= conditions[i].left;
      }
    }
  }
  return PLACIDO_OK;
}

int placido_genicam_access(placido_genicam *features, uint32_t node, unsigned *access,
                           placido_error *err) {
  *access = ACCESS_NONE;
  int status = placido_genicam_enter(features, node, err);
  if (status) {
    return status;
  }
  /* The conditions first: what is not there must not be asked for more. */
  unsigned allowed = ACCESS_BOTH;
  const enum kind kind = features->nodes[node].kind;
  status = restrict_access(features, node, &allowed, err);
  if (!status && allowed && table[kind]) {
    status = table[kind](features, node, access, err);
    *access = narrow(features, node, *access & allowed);
  }
  placido_genicam_leave(features);
  return status;
}
