/* Bytes behind the port: where a register lies, what was read of it, and its bits as numbers. */
#include "drivers/genicam/registers.h"

#include "base/memory.h"
#include "base/text.h"
#include "drivers/genicam/value.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define PORT_STEPS 100 /* of work, which an access to the camera counts as */

struct place {
  uint64_t address;
  size_t size;
};

/* The bits of an integer in its register, the lowest as bit 0. */
struct field {
  struct place place;
  unsigned low, width;
  bool is_signed, is_big_endian;
};

/* What an index adds to an address: times so many bytes, or times the register's length. */
static int index_offset(placido_genicam *features, uint32_t node, uint32_t property, size_t size,
                        int64_t *offset, placido_error *err) {
  const struct property *index = &features->properties[property];
  const char *label = placido_genicam_label(features, property);
  struct number at, bytes = placido_genicam_whole((int64_t)size);
  int64_t count = 0, each = 0;
  *offset = 0;
  int status = placido_genicam_property_get(features, node, property, &at, err);
  if (!status && index->label_node == NODE_MISSING) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s of the camera's description names %s, which is not there",
                             placido_genicam_name(features, node), label);
  }
  if (!status && index->label_node) {
    status = placido_genicam_node_get(features, index->label_node, &bytes, err);
  } else if (!status && *label && !placido_genicam_number_read(&bytes, label)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s of the camera's description has the offset %s, no number",
                             placido_genicam_name(features, node), label);
  }
  if (status) {
    return status;
  }
  if (!placido_genicam_round(&at, &count) || !placido_genicam_round(&bytes, &each)) {
    return placido_error_set(err, PLACIDO_INPUT, "the index of %s is beyond 64 bits",
                             placido_genicam_name(features, node));
  }
  *offset = (int64_t)((uint64_t)count * (uint64_t)each);
  return PLACIDO_OK;
}

static int locate(placido_genicam *features, uint32_t node, size_t size_max, struct place *place,
                  placido_error *err) {
  int64_t size;
  int status = placido_genicam_setting(features, node, TAG_LENGTH, 4, &size, err);
  if (status) {
    return status;
  }
  if (size < 1 || (uint64_t)size > size_max) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the register %s has %lld bytes; 1 to %zu were expected",
                             placido_genicam_name(features, node), (long long)size, size_max);
  }
  *place = (struct place){.size = (size_t)size};
  uint32_t property = placido_genicam_first(features, node, TAG_ADDRESS);
  const uint32_t index = placido_genicam_first(features, node, TAG_INDEX);
  if (!property && !index) {
    return placido_error_set(err, PLACIDO_INPUT, "the register %s has no address",
                             placido_genicam_name(features, node));
  }
  for (; property; property = placido_genicam_next(features, property, TAG_ADDRESS)) {
    struct number address;
    int64_t part;
    status = placido_genicam_property_get(features, node, property, &address, err);
    if (status) {
      return status;
    }
    if (!placido_genicam_round(&address, &part)) {
      return placido_error_set(err, PLACIDO_INPUT, "the address of %s is beyond 64 bits",
                               placido_genicam_name(features, node));
    }
    place->address += (uint64_t)part;
  }
  for (property = index; property;
       property = placido_genicam_next(features, property, TAG_INDEX)) {
    int64_t offset;
    status = index_offset(features, node, property, place->size, &offset, err);
    if (status) {
      return status;
    }
    place->address += (uint64_t)offset;
  }
  return PLACIDO_OK;
}

/* What changes by itself, or must be asked for anew, is not kept. */
static bool is_kept(const placido_genicam *features, uint32_t node, size_t size) {
  const uint32_t how = placido_genicam_first(features, node, TAG_CACHABLE);
  return size <= sizeof features->nodes[node].cached.bytes &&
         strcmp(placido_genicam_text(features, how), "NoCache") != 0 &&
         !placido_genicam_first(features, node, TAG_POLLING_TIME);
}

static int read_bytes(placido_genicam *features, uint32_t node, const struct place *place,
                      uint8_t *bytes, placido_error *err) {
  struct cached *cached = &features->nodes[node].cached;
  if (cached->generation == features->generation && cached->address == place->address &&
      cached->size == place->size) {
    memcpy(bytes, cached->bytes, place->size);
    return PLACIDO_OK;
  }
  int status = placido_genicam_charge(features, node, PORT_STEPS, err);
  if (status) {
    return status;
  }
  status = features->port.read(features->port.user, place->address, bytes, place->size, err);
  if (!status && is_kept(features, node, place->size)) {
    *cached = (struct cached){.generation = features->generation,
                              .address = place->address,
                              .size = place->size};
    memcpy(cached->bytes, bytes, place->size);
  }
  return status;
}

/* Whatever is written may change any other register: cameras' lists of what depends on what
 * (pInvalidator) are not complete, and reading again takes less than a millisecond. */
static int write_bytes(placido_genicam *features, uint32_t node, const struct place *place,
                       const uint8_t *bytes, placido_error *err) {
  const int status = placido_genicam_charge(features, node, PORT_STEPS, err);
  if (status) {
    return status;
  }
  placido_genicam_forget(features);
  return features->port.write(features->port.user, place->address, bytes, place->size, err);
}

static bool says(const placido_genicam *features, uint32_t node, enum tag tag,
                 const char *word) {
  const uint32_t property = placido_genicam_first(features, node, tag);
  return strcmp(placido_genicam_text(features, property), word) == 0;
}

/* LSB and MSB, or Bit. GenApi counts the bits of a big-endian register from the highest. */
static int locate_field(placido_genicam *features, uint32_t node, struct field *field,
                        placido_error *err) {
  *field = (struct field){.is_signed = says(features, node, TAG_SIGN, "Signed"),
                          .is_big_endian = says(features, node, TAG_ENDIANNESS, "BigEndian")};
  int status = locate(features, node, sizeof(uint64_t), &field->place, err);
  if (status) {
    return status;
  }
  const int64_t bits = 8 * (int64_t)field->place.size;
  field->width = (unsigned)bits;
  if (features->nodes[node].kind == KIND_INT_REG) {
    return PLACIDO_OK;
  }
  int64_t first, last;
  status = placido_genicam_setting(features, node, TAG_BIT, -1, &first, err);
  last = first;
  if (!status && first < 0) {
    status = placido_genicam_setting(features, node, TAG_LSB, 0, &first, err);
    if (!status) {
      status = placido_genicam_setting(features, node, TAG_MSB, bits - 1, &last, err);
    }
  }
  if (status) {
    return status;
  }
  if (first < 0 || last < 0 || first >= bits || last >= bits) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the bits %lld to %lld of %s do not lie in its %lld bits",
                             (long long)first, (long long)last,
                             placido_genicam_name(features, node), (long long)bits);
  }
  const int64_t low = first < last ? first : last, high = first < last ? last : first;
  field->low = (unsigned)(field->is_big_endian ? bits - 1 - high : low);
  field->width = (unsigned)(high - low + 1);
  return PLACIDO_OK;
}

static uint64_t join(const uint8_t *bytes, size_t size, bool is_big_endian) {
  uint64_t value = 0;
  for (size_t i = 0; i < size; i++) {
    value = value << 8 | bytes[is_big_endian ? i : size - 1 - i];
  }
  return value;
}

static void split(uint8_t *bytes, size_t size, bool is_big_endian, uint64_t value) {
  for (size_t i = 0; i < size; i++) {
    bytes[is_big_endian ? size - 1 - i : i] = (uint8_t)(value >> 8 * i);
  }
}

static uint64_t ones(unsigned width) {
  return width >= 64 ? UINT64_MAX : ((uint64_t)1 << width) - 1;
}

int placido_genicam_integer_get(placido_genicam *features, uint32_t node, struct number *value,
                                placido_error *err) {
  struct field field;
  uint8_t bytes[sizeof(uint64_t)];
  int status = locate_field(features, node, &field, err);
  if (!status) {
    status = read_bytes(features, node, &field.place, bytes, err);
  }
  if (status) {
    return status;
  }
  const uint64_t all = join(bytes, field.place.size, field.is_big_endian);
  uint64_t bits = all >> field.low & ones(field.width);
  if (field.is_signed && bits >> (field.width - 1)) {
    bits |= ~ones(field.width);
  }
  *value = placido_genicam_whole((int64_t)bits);
  return PLACIDO_OK;
}

static void range(const struct field *field, int64_t *min, int64_t *max) {
  const unsigned width = field->is_signed || field->width == 64 ? field->width - 1 : field->width;
  *max = (int64_t)ones(width);
  *min = field->is_signed ? -*max - 1 : 0;
}

int placido_genicam_integer_range(placido_genicam *features, uint32_t node, int64_t *min,
                                  int64_t *max, placido_error *err) {
  struct field field;
  const int status = locate_field(features, node, &field, err);
  if (!status) {
    range(&field, min, max);
  }
  return status;
}

int placido_genicam_integer_set(placido_genicam *features, uint32_t node,
                                const struct number *value, placido_error *err) {
  struct field field;
  int status = locate_field(features, node, &field, err);
  if (status) {
    return status;
  }
  int64_t whole, min, max;
  range(&field, &min, &max);
  /* A full 64 bits without sign take any pattern, as their values wrap around when read. */
  const bool is_any = field.width == 64;
  if (!placido_genicam_round(value, &whole) || (!is_any && (whole < min || whole > max))) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %.15g is not from %lld to %lld",
                             placido_genicam_name(features, node), value->real, (long long)min,
                             (long long)max);
  }
  uint8_t bytes[sizeof(uint64_t)];
  uint64_t all = 0;
  if (field.width < 8 * field.place.size) {
    status = read_bytes(features, node, &field.place, bytes, err);
    if (status) {
      return status;
    }
    all = join(bytes, field.place.size, field.is_big_endian);
  }
  const uint64_t mask = ones(field.width) << field.low;
  all = (all & ~mask) | ((uint64_t)whole << field.low & mask);
  split(bytes, field.place.size, field.is_big_endian, all);
  return write_bytes(features, node, &field.place, bytes, err);
}

static int locate_float(placido_genicam *features, uint32_t node, struct place *place,
                        placido_error *err) {
  const int status = locate(features, node, sizeof(double), place, err);
  if (!status && place->size != sizeof(float) && place->size != sizeof(double)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the register %s has %zu bytes; a float has 4 or 8",
                             placido_genicam_name(features, node), place->size);
  }
  return status;
}

int placido_genicam_float_get(placido_genicam *features, uint32_t node, struct number *value,
                              placido_error *err) {
  struct place place;
  uint8_t bytes[sizeof(double)];
  int status = locate_float(features, node, &place, err);
  if (!status) {
    status = read_bytes(features, node, &place, bytes, err);
  }
  if (status) {
    return status;
  }
  const uint64_t bits =
      join(bytes, place.size, says(features, node, TAG_ENDIANNESS, "BigEndian"));
  const uint32_t few_bits = (uint32_t)bits;
  double wide;
  float narrow;
  memcpy(&wide, &bits, sizeof wide);
  memcpy(&narrow, &few_bits, sizeof narrow);
  *value = placido_genicam_real(place.size == sizeof narrow ? (double)narrow : wide);
  return PLACIDO_OK;
}

int placido_genicam_float_set(placido_genicam *features, uint32_t node,
                              const struct number *value, placido_error *err) {
  struct place place;
  const int status = locate_float(features, node, &place, err);
  if (status) {
    return status;
  }
  const bool is_narrow = place.size == sizeof(float);
  if (!isfinite(value->real) || (is_narrow && fabs(value->real) > FLT_MAX)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: %g does not fit into its register",
                             placido_genicam_name(features, node), value->real);
  }
  uint64_t bits;
  uint32_t few_bits;
  const float narrow = is_narrow ? (float)value->real : 0;
  memcpy(&bits, &value->real, sizeof bits);
  memcpy(&few_bits, &narrow, sizeof few_bits);
  uint8_t bytes[sizeof(double)];
  split(bytes, place.size, says(features, node, TAG_ENDIANNESS, "BigEndian"),
        is_narrow ? few_bits : bits);
  return write_bytes(features, node, &place, bytes, err);
}

int placido_genicam_string_get(placido_genicam *features, uint32_t node, char *text, size_t size,
                               placido_error *err) {
  struct place place;
  int status = locate(features, node, PLACIDO_GENICAM_STRING_MAX_BYTES, &place, err);
  if (status) {
    return status;
  }
  uint8_t *bytes = placido_memory_new(place.size + 1, 1, err);
  if (!bytes) {
    return PLACIDO_MEMORY;
  }
  status = read_bytes(features, node, &place, bytes, err);
  if (!status) {
    snprintf(text, size, "%s", (const char *)bytes);
    placido_text_line(text);
  }
  placido_memory_free(bytes);
  return status;
}

int placido_genicam_string_set(placido_genicam *features, uint32_t node, const char *text,
                               placido_error *err) {
  struct place place;
  int status = locate(features, node, PLACIDO_GENICAM_STRING_MAX_BYTES, &place, err);
  if (status) {
    return status;
  }
  const size_t length = strlen(text);
  if (length > place.size) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: a text of %zu bytes; at most %zu fit",
                             placido_genicam_name(features, node), length, place.size);
  }
  uint8_t *bytes = placido_memory_new(place.size, 1, err);
  if (!bytes) {
    return PLACIDO_MEMORY;
  }
  memcpy(bytes, text, length);
  status = write_bytes(features, node, &place, bytes, err);
  placido_memory_free(bytes);
  return status;
}
