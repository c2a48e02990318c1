/* The elements of a description that are understood; all others are passed over. */
#ifndef PLACIDO_DRIVERS_GENICAM_ELEMENTS_H
#define PLACIDO_DRIVERS_GENICAM_ELEMENTS_H

#include "drivers/genicam/nodes.h"

struct element {
  const char *name; /* without the prefix of a namespace */
  enum { ELEMENT_CONTAINER, ELEMENT_NODE, ELEMENT_PROPERTY } role;
  enum kind kind;  /* of a node */
  enum tag tag;    /* of a property */
  bool names_node; /* its text is the name of a node */
};

/* NULL: not known. */
const struct element *placido_genicam_element(const char *name);

/* Whether a node may stand within another (KIND_NONE: within none). `*tag` is what it is to that
 * one; TAG_NONE: nothing. */
bool placido_genicam_may_stand(enum kind kind, enum kind within, enum tag *tag);

#endif
