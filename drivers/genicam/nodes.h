/* The nodes of a description: a flat table, each with the list of what its elements say. */
#ifndef PLACIDO_DRIVERS_GENICAM_NODES_H
#define PLACIDO_DRIVERS_GENICAM_NODES_H

#include "drivers/genicam/genicam.h"
#include "drivers/genicam/number.h"

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What a hostile description cannot make us exceed. Real ones have 20,000 nodes at most, some
 * 20 levels deep, and formulas of 128 nested conditions. */
#define PLACIDO_GENICAM_XML_MAX_BYTES ((size_t)64 << 20)
#define PLACIDO_GENICAM_TEXTS_MAX_BYTES ((size_t)32 << 20) /* of all that is kept */
#define PLACIDO_GENICAM_TEXT_MAX_BYTES ((size_t)64 << 10)  /* of one element */
#define PLACIDO_GENICAM_NODES_MAX 250000u
#define PLACIDO_GENICAM_PROPERTIES_MAX 1000000u
#define PLACIDO_GENICAM_CHILDREN_MAX 65536u /* of one node */
#define PLACIDO_GENICAM_DEPTH_MAX 64        /* of nodes that refer to nodes */
#define PLACIDO_GENICAM_NESTING_MAX 1024    /* of brackets, in all formulas under way */
#define PLACIDO_GENICAM_STEPS_MAX 1000000   /* of work for one call from outside */
#define PLACIDO_GENICAM_STRING_MAX_BYTES ((size_t)64 << 10) /* of a string register */

enum kind {
  KIND_NONE,
  KIND_CATEGORY,
  KIND_INTEGER,
  KIND_FLOAT,
  KIND_BOOLEAN,
  KIND_COMMAND,
  KIND_ENUMERATION,
  KIND_ENUM_ENTRY,
  KIND_STRING,
  KIND_KNIFE,
  KIND_INT_KNIFE,
  KIND_CONVERTER,
  KIND_INT_CONVERTER,
  KIND_INT_REG,
  KIND_MASKED_INT_REG,
  KIND_FLOAT_REG,
  KIND_STRING_REG,
  KIND_REGISTER,
  KIND_STRUCT_REG,
  KIND_STRUCT_ENTRY,
  KIND_PORT,
  KIND_COUNT,
};

/* What an element of a node says. One tag stands for both ways of saying it: <Min> and <pMin>. */
enum tag {
  TAG_NONE,
  TAG_VALUE,
  TAG_VALUE_COPY,
  TAG_INDEX, /* label: how many bytes an index counts, in a register */
  TAG_VALUE_INDEXED, /* label: the index */
  TAG_VALUE_DEFAULT,
  TAG_MIN,
  TAG_MAX,
  TAG_STEP,
  TAG_UNIT,
  TAG_IS_IMPLEMENTED,
  TAG_IS_AVAILABLE,
  TAG_IS_LOCKED,
  TAG_ACCESS,
  TAG_ADDRESS,
  TAG_LENGTH,
  TAG_PORT,
  TAG_CACHABLE,
  TAG_POLLING_TIME,
  TAG_SIGN,
  TAG_ENDIANNESS,
  TAG_LSB,
  TAG_MSB,
  TAG_BIT,
  TAG_VARIABLE, /* label: its name, as of the next two */
  TAG_CONSTANT,
  TAG_EXPRESSION,
  TAG_FORMULA,
  TAG_FORMULA_TO,
  TAG_FORMULA_FROM,
  TAG_SLOPE,
  TAG_ON,
  TAG_OFF,
  TAG_COMMAND,
  TAG_ENTRY,
  TAG_FEATURE,
  TAG_FOREIGN, /* of a port: of a chunk or an event, whose registers are not in the camera */
};

/* Instead of a node: none is named; or one that the description does not have. Node 0 and
 * property 0 stand for none. */
#define NODE_NONE 0u
#define NODE_MISSING UINT32_MAX

struct property {
  enum tag tag;
  uint32_t next;       /* property of the same node */
  uint32_t text;       /* offset into the texts */
  uint32_t label;      /* the same, of its attribute */
  uint32_t node;       /* that the text names, or that stands within it */
  uint32_t label_node; /* that the attribute names */
  bool has_number;
  struct number number; /* of its text; changes where it is the value of a node */
};

/* What was last read of a register. */
struct cached {
  uint64_t generation; /* counts only while it is the table's */
  uint64_t address;
  size_t size;
  uint8_t bytes[8];
};

struct node {
  enum kind kind;
  uint32_t name;        /* offset into the texts */
  uint32_t parent;      /* that it stands within */
  uint32_t first, last; /* its properties */
  uint32_t property_count;
  struct cached cached;
};

struct named {
  const char *name;
  uint32_t node;
};

struct placido_genicam {
  placido_genicam_port port;
  char *texts;
  struct property *properties;
  struct node *nodes;
  struct named *names; /* sorted; of one name, the first of the description first */
  size_t text_size, text_room;
  size_t property_count, property_room;
  size_t node_count, node_room;
  size_t name_count;
  uint64_t generation; /* grows with everything that is written */
  unsigned depth, nesting, steps; /* of the call under way */
};

/* Building. Each returns PLACIDO_OK, PLACIDO_MEMORY or PLACIDO_INPUT (too many, too long). */
int placido_genicam_text_add(placido_genicam *features, uint32_t *offset, const char *text,
                             size_t size, placido_error *err);
int placido_genicam_node_add(placido_genicam *features, enum kind kind, const char *name,
                             uint32_t parent, uint32_t *node, placido_error *err);
int placido_genicam_property_add(placido_genicam *features, uint32_t node,
                                 const struct property *property, placido_error *err);
/* Sorts the names. After it, no text may be added. */
int placido_genicam_names_sort(placido_genicam *features, placido_error *err);

/* The node of a name; NODE_MISSING where there is none. */
uint32_t placido_genicam_find(const placido_genicam *features, const char *name);
/* The first property with that tag, of the node or of the StructReg that it stands within; the
 * next of the same node; 0 where there is none. */
uint32_t placido_genicam_first(const placido_genicam *features, uint32_t node, enum tag tag);
uint32_t placido_genicam_next(const placido_genicam *features, uint32_t property, enum tag tag);

/* The node's name, or of the one around it where it has none. */
const char *placido_genicam_name(const placido_genicam *features, uint32_t node);
/* What the property says; "" of property 0. */
const char *placido_genicam_text(const placido_genicam *features, uint32_t property);
const char *placido_genicam_label(const placido_genicam *features, uint32_t property);

/* Work is counted, so that a description whose nodes ask each other for ever ends in PLACIDO_INPUT.
 * enter also counts the depth; leave follows each enter that returned PLACIDO_OK. */
int placido_genicam_charge(placido_genicam *features, uint32_t node, size_t steps,
                           placido_error *err);
int placido_genicam_enter(placido_genicam *features, uint32_t node, placido_error *err);
void placido_genicam_leave(placido_genicam *features);

#endif
