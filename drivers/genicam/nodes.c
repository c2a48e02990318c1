/* The table of a description's nodes: adding, finding, and counting the work that is done on it. */
#include "drivers/genicam/nodes.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* A block with room for `count` more elements of `size` bytes; NULL with the error set. */
static void *with_room(void *block, size_t *room, size_t used, size_t count, size_t size,
                       placido_error *err) {
  if (block && count <= *room - used) {
    return block;
  }
  const size_t wanted = 2 * (used + count) + 64;
  void *grown = placido_memory_grow(block, wanted, size, err);
  if (grown) {
    *room = wanted;
  }
  return grown;
}

int placido_genicam_text_add(placido_genicam *features, uint32_t *offset, const char *text,
                             size_t size, placido_error *err) {
  *offset = 0;
  if (size >= PLACIDO_GENICAM_TEXTS_MAX_BYTES - features->text_size) {
    return placido_error_set(err, PLACIDO_INPUT, "the camera's description is too long: %zu bytes",
                             features->text_size + size);
  }
  char *texts =
      with_room(features->texts, &features->text_room, features->text_size, size + 1, 1, err);
  if (!texts) {
    return PLACIDO_MEMORY;
  }
  features->texts = texts;
  *offset = (uint32_t)features->text_size;
  memcpy(texts + *offset, text, size);
  texts[*offset + size] = '\0';
  features->text_size += size + 1;
  return PLACIDO_OK;
}

int placido_genicam_node_add(placido_genicam *features, enum kind kind, const char *name,
                             uint32_t parent, uint32_t *node, placido_error *err) {
  *node = NODE_NONE;
  if (features->node_count >= PLACIDO_GENICAM_NODES_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "the camera's description has over %u nodes",
                             PLACIDO_GENICAM_NODES_MAX);
  }
  struct node *nodes = with_room(features->nodes, &features->node_room, features->node_count, 1,
                                 sizeof *nodes, err);
  if (!nodes) {
    return PLACIDO_MEMORY;
  }
  features->nodes = nodes;
  uint32_t offset;
  const int status = placido_genicam_text_add(features, &offset, name, strlen(name), err);
  if (status) {
    return status;
  }
  *node = (uint32_t)features->node_count++;
  nodes[*node] = (struct node){.kind = kind, .name = offset, .parent = parent};
  return PLACIDO_OK;
}

int placido_genicam_property_add(placido_genicam *features, uint32_t node,
                                 const struct property *property, placido_error *err) {
  struct node *holder = &features->nodes[node];
  if (features->property_count >= PLACIDO_GENICAM_PROPERTIES_MAX ||
      holder->property_count >= PLACIDO_GENICAM_CHILDREN_MAX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s of the camera's description says too much: over %u elements in "
                             "one node, or %u in all",
                             placido_genicam_name(features, node), PLACIDO_GENICAM_CHILDREN_MAX,
                             PLACIDO_GENICAM_PROPERTIES_MAX);
  }
  struct property *properties = with_room(features->properties, &features->property_room,
                                          features->property_count, 1, sizeof *properties, err);
  if (!properties) {
    return PLACIDO_MEMORY;
  }
  features->properties = properties;
  const uint32_t index = (uint32_t)features->property_count++;
  properties[index] = *property;
  properties[index].next = 0;
  if (holder->last) {
    properties[holder->last].next = index;
  } else {
    holder->first = index;
  }
  holder->last = index;
  holder->property_count++;
  return PLACIDO_OK;
}

static int compare_names(const void *a, const void *b) {
  const struct named *left = a, *right = b;
  const int order = strcmp(left->name, right->name);
  return order ? order : (left->node > right->node) - (left->node < right->node);
}

int placido_genicam_names_sort(placido_genicam *features, placido_error *err) {
  features->names = placido_memory_new(features->node_count, sizeof *features->names, err);
  if (!features->names) {
    return PLACIDO_MEMORY;
  }
  for (uint32_t i = 1; i < features->node_count; i++) {
    const char *name = features->texts + features->nodes[i].name;
    /* Entries of different enumerations share their names: they are found by their enumeration. */
    if (*name && features->nodes[i].kind != KIND_ENUM_ENTRY) {
      features->names[features->name_count++] = (struct named){.name = name, .node = i};
    }
  }
  qsort(features->names, features->name_count, sizeof *features->names, compare_names);
  return PLACIDO_OK;
}

uint32_t placido_genicam_find(const placido_genicam *features, const char *name) {
  size_t low = 0, high = features->name_count; /* the first that is not less lies between */
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (strcmp(features->names[middle].name, name) < 0) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  const bool is_found =
      low < features->name_count && strcmp(features->names[low].name, name) == 0;
  return is_found ? features->names[low].node : NODE_MISSING;
}

static uint32_t with_tag(const placido_genicam *features, uint32_t property, enum tag tag) {
  while (property && features->properties[property].tag != tag) {
    property = features->properties[property].next;
  }
  return property;
}

uint32_t placido_genicam_first(const placido_genicam *features, uint32_t node, enum tag tag) {
  const struct node *at = &features->nodes[node];
  const uint32_t own = with_tag(features, at->first, tag);
  if (own || at->kind != KIND_STRUCT_ENTRY) {
    return own;
  }
  return with_tag(features, features->nodes[at->parent].first, tag);
}

uint32_t placido_genicam_next(const placido_genicam *features, uint32_t property, enum tag tag) {
  return with_tag(features, features->properties[property].next, tag);
}

const char *placido_genicam_name(const placido_genicam *features, uint32_t node) {
  const char *name = features->texts + features->nodes[node].name;
  return *name ? name : features->texts + features->nodes[features->nodes[node].parent].name;
}

const char *placido_genicam_text(const placido_genicam *features, uint32_t property) {
  return features->texts + features->properties[property].text;
}

const char *placido_genicam_label(const placido_genicam *features, uint32_t property) {
  return features->texts + features->properties[property].label;
}

int placido_genicam_charge(placido_genicam *features, uint32_t node, size_t steps,
                           placido_error *err) {
  if (steps > features->steps) {
    features->steps = 0;
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's description asks for endless work at %s",
                             placido_genicam_name(features, node));
  }
  features->steps -= (unsigned)steps;
  return PLACIDO_OK;
}

int placido_genicam_enter(placido_genicam *features, uint32_t node, placido_error *err) {
  const struct node *at = &features->nodes[node];
  /* A step is a look at some 32 properties, as most nodes have at most. */
  const size_t steps =
      1 + (at->property_count + features->nodes[at->parent].property_count) / 32;
  const int status = placido_genicam_charge(features, node, steps, err);
  if (status) {
    return status;
  }
  if (features->depth >= PLACIDO_GENICAM_DEPTH_MAX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's description goes round in a circle at %s, or lies "
                             "deeper than %d nodes",
                             placido_genicam_name(features, node), PLACIDO_GENICAM_DEPTH_MAX);
  }
  features->depth++;
  return PLACIDO_OK;
}

void placido_genicam_leave(placido_genicam *features) {
  features->depth--;
}

void placido_genicam_forget(placido_genicam *features) {
  features->generation++;
}

void placido_genicam_free(placido_genicam *features) {
  if (!features) {
    return;
  }
  placido_memory_free(features->texts);
  placido_memory_free(features->properties);
  placido_memory_free(features->nodes);
  placido_memory_free(features->names);
  placido_memory_free(features);
}
