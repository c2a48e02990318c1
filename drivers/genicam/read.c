/* From the text of a description to the table of its nodes. */
#include "drivers/genicam/elements.h"

#include "base/memory.h"

#include <ctype.h>
#include <expat.h>
#include <string.h>

#define ELEMENTS_DEEP_MAX 64

/* What is open while expat goes through the text. */
struct reader {
  placido_genicam *features;
  XML_Parser parser;
  const struct element *open[ELEMENTS_DEEP_MAX];
  unsigned depth;   /* of `open` */
  unsigned ignored; /* how many elements are open within one that is passed over */
  uint32_t node;    /* the innermost that is open */
  struct property property; /* that is open; else its tag is TAG_NONE */
  char *text;               /* of it, so far */
  size_t text_size;
  bool is_complete;
  int status;
  placido_error *err;
};

static void stop(struct reader *reader, int status) {
  reader->status = status;
  XML_StopParser(reader->parser, XML_FALSE);
}

static void refuse(struct reader *reader, const char *why) {
  stop(reader, placido_error_set(reader->err, PLACIDO_INPUT,
                                 "the camera's description, line %lu: %s",
                                 (unsigned long)XML_GetCurrentLineNumber(reader->parser), why));
}

static const char *attribute(const char *const *attributes, const char *name) {
  for (; *attributes; attributes += 2) {
    if (strcmp(attributes[0], name) == 0) {
      return attributes[1];
    }
  }
  return NULL;
}

static bool open_node(struct reader *reader, const struct element *element,
                      const char *const *attributes) {
  placido_genicam *features = reader->features;
  enum tag tag;
  if (!placido_genicam_may_stand(element->kind, features->nodes[reader->node].kind, &tag)) {
    return false;
  }
  const char *name = attribute(attributes, "Name");
  uint32_t node;
  int status = placido_genicam_node_add(features, element->kind, name ? name : "", reader->node,
                                        &node, reader->err);
  if (!status && tag) {
    const struct property property = {.tag = tag, .node = node};
    status = placido_genicam_property_add(features, reader->node, &property, reader->err);
  }
  reader->node = node;
  if (status) {
    stop(reader, status);
  }
  return true;
}

static bool open_property(struct reader *reader, const struct element *element,
                          const char *const *attributes) {
  static const char *const labels[] = {"Name", "Index", "Offset", "pOffset"};
  if (reader->node == NODE_NONE || reader->property.tag != TAG_NONE) {
    return false;
  }
  reader->property = (struct property){
      .tag = element->tag, .node = element->names_node ? NODE_MISSING : NODE_NONE};
  reader->text_size = 0;
  for (size_t i = 0; i < sizeof labels / sizeof *labels; i++) {
    const char *label = attribute(attributes, labels[i]);
    if (!label) {
      continue;
    }
    const int status = placido_genicam_text_add(reader->features, &reader->property.label, label,
                                                strlen(label), reader->err);
    if (status) {
      stop(reader, status);
    }
    reader->property.label_node = labels[i][0] == 'p' ? NODE_MISSING : NODE_NONE;
    break;
  }
  return true;
}

static bool open_container(const struct reader *reader) {
  return reader->node == NODE_NONE && reader->property.tag == TAG_NONE;
}

static void on_start(void *user, const char *name, const char **attributes) {
  struct reader *reader = user;
  const char *const *list = (const char *const *)attributes;
  if (reader->status) {
    return;
  }
  const struct element *element = placido_genicam_element(name);
  if (reader->depth == 0 && (!element || strcmp(element->name, "RegisterDescription") != 0)) {
    refuse(reader, "it begins with another element than <RegisterDescription>");
    return;
  }
  if (reader->depth + reader->ignored >= ELEMENTS_DEEP_MAX) {
    refuse(reader, "its elements lie too deep");
    return;
  }
  if (reader->ignored || !element || reader->property.tag != TAG_NONE) {
    reader->ignored++;
    return;
  }
  const bool is_open = element->role == ELEMENT_NODE       ? open_node(reader, element, list)
                       : element->role == ELEMENT_PROPERTY ? open_property(reader, element, list)
                                                           : open_container(reader);
  if (is_open) {
    reader->open[reader->depth++] = element;
  } else {
    reader->ignored++;
  }
}

static void on_text(void *user, const char *text, int length) {
  struct reader *reader = user;
  if (reader->status || reader->ignored || reader->property.tag == TAG_NONE) {
    return;
  }
  if ((size_t)length >= PLACIDO_GENICAM_TEXT_MAX_BYTES - reader->text_size) {
    refuse(reader, "the text of an element is too long");
    return;
  }
  memcpy(reader->text + reader->text_size, text, (size_t)length);
  reader->text_size += (size_t)length;
}

/* Keeps the property that ends, its text without the white space around it. */
static int close_property(struct reader *reader) {
  struct property *property = &reader->property;
  const char *text = reader->text;
  size_t size = reader->text_size;
  while (size > 0 && isspace((unsigned char)text[size - 1])) {
    size--;
  }
  while (size > 0 && isspace((unsigned char)*text)) {
    text++;
    size--;
  }
  int status =
      placido_genicam_text_add(reader->features, &property->text, text, size, reader->err);
  if (!status) {
    property->has_number =
        property->node == NODE_NONE &&
        placido_genicam_number_read(&property->number, reader->features->texts + property->text);
    status = placido_genicam_property_add(reader->features, reader->node, property, reader->err);
  }
  property->tag = TAG_NONE;
  return status;
}

static void on_end(void *user, const char *name) {
  (void)name;
  struct reader *reader = user;
  if (reader->status) {
    return;
  }
  if (reader->ignored) {
    reader->ignored--;
    return;
  }
  const struct element *element = reader->open[--reader->depth];
  if (element->role == ELEMENT_PROPERTY) {
    const int status = close_property(reader);
    if (status) {
      stop(reader, status);
    }
  } else if (element->role == ELEMENT_NODE) {
    reader->node = reader->features->nodes[reader->node].parent;
  }
  if (reader->depth == 0) {
    /* Cameras pad their files with zeros, which would not be XML: nobody looks behind the end. */
    reader->is_complete = true;
    XML_StopParser(reader->parser, XML_FALSE);
  }
}

/* A description needs no document type; bombs and foreign files are made with one. */
static void on_doctype(void *user, const char *name, const char *system_id, const char *public_id,
                       int has_internal_subset) {
  (void)name;
  (void)system_id;
  (void)public_id;
  if (has_internal_subset) {
    refuse(user, "it declares entities or a document type of its own, which is refused");
  }
}

static void *allocate(size_t size) {
  return placido_memory_grow(NULL, size, 1, NULL);
}

static void *reallocate(void *block, size_t size) {
  return placido_memory_grow(block, size, 1, NULL);
}

/* What expat says, where nothing of ours stopped it. */
static int parse(struct reader *reader, const char *xml, size_t size) {
  const enum XML_Status parsed = XML_Parse(reader->parser, xml, (int)size, 1);
  if (reader->status || reader->is_complete) {
    return reader->status;
  }
  const enum XML_Error code = XML_GetErrorCode(reader->parser);
  if (code == XML_ERROR_NO_MEMORY) {
    return placido_error_set(reader->err, PLACIDO_MEMORY,
                             "out of memory for the camera's description");
  }
  return placido_error_set(
      reader->err, PLACIDO_INPUT, "the camera's description, line %lu: it is no XML: %s",
      (unsigned long)XML_GetCurrentLineNumber(reader->parser),
      parsed == XML_STATUS_OK ? "it does not end" : XML_ErrorString(code));
}

static int read_nodes(placido_genicam *features, const char *xml, size_t size,
                      placido_error *err) {
  static const XML_Memory_Handling_Suite memory = {allocate, reallocate, placido_memory_free};
  struct reader reader = {.features = features, .err = err};
  int status = PLACIDO_MEMORY;
  reader.text = placido_memory_new(PLACIDO_GENICAM_TEXT_MAX_BYTES, 1, err);
  if (!reader.text) {
    return status;
  }
  reader.parser = XML_ParserCreate_MM(NULL, &memory, NULL);
  if (!reader.parser) {
    placido_error_set(err, status, "out of memory for the camera's description");
    goto fail;
  }
  XML_SetUserData(reader.parser, &reader);
  XML_SetElementHandler(reader.parser, on_start, on_end);
  XML_SetCharacterDataHandler(reader.parser, on_text);
  XML_SetStartDoctypeDeclHandler(reader.parser, on_doctype);
  status = parse(&reader, xml, size);
  XML_ParserFree(reader.parser);
fail:
  placido_memory_free(reader.text);
  return status;
}

/* Node 0, property 0 and the text at 0 stand for none. */
static int add_none(placido_genicam *features, placido_error *err) {
  uint32_t none;
  int status = placido_genicam_text_add(features, &none, "", 0, err);
  if (!status) {
    status = placido_genicam_node_add(features, KIND_NONE, "", NODE_NONE, &none, err);
  }
  if (!status) {
    const struct property property = {.tag = TAG_NONE};
    status = placido_genicam_property_add(features, none, &property, err);
  }
  return status;
}

/* Finds the nodes that properties name. */
static void resolve(placido_genicam *features) {
  for (uint32_t i = 0; i < features->property_count; i++) {
    struct property *property = &features->properties[i];
    if (property->node == NODE_MISSING) {
      property->node = placido_genicam_find(features, placido_genicam_text(features, i));
    }
    if (property->label_node == NODE_MISSING) {
      property->label_node = placido_genicam_find(features, placido_genicam_label(features, i));
    }
  }
}

int placido_genicam_read(placido_genicam **features, const char *xml, size_t size,
                         const placido_genicam_port *port, placido_error *err) {
  *features = NULL;
  if (size > PLACIDO_GENICAM_XML_MAX_BYTES) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's description has %zu bytes; at most %zu were expected",
                             size, PLACIDO_GENICAM_XML_MAX_BYTES);
  }
  placido_genicam *read = placido_memory_new(1, sizeof *read, err);
  if (!read) {
    return PLACIDO_MEMORY;
  }
  read->port = *port;
  read->generation = 1;
  int status = add_none(read, err);
  if (!status) {
    status = read_nodes(read, xml, size, err);
  }
  if (!status) {
    status = placido_genicam_names_sort(read, err);
  }
  if (status) {
    placido_genicam_free(read);
    return status;
  }
  resolve(read);
  *features = read;
  return PLACIDO_OK;
}
