/* String descriptors (USB 2.0, section 9.6.7). */
#include "gadget/strings.h"

#define DESCRIPTOR_STRING 3
#define ENGLISH_US 0x0409

size_t placido_gadget_string(uint8_t bytes[PLACIDO_GADGET_STRING_BYTES_MAX], const char *text) {
  size_t size = 2;
  for (; *text && size + 2 <= PLACIDO_GADGET_STRING_BYTES_MAX; text++, size += 2) {
    bytes[size] = (uint8_t)(*text >= ' ' && *text <= '~' ? *text : '?');
    bytes[size + 1] = 0;
  }
  bytes[0] = (uint8_t)size;
  bytes[1] = DESCRIPTOR_STRING;
  return size;
}

size_t placido_gadget_languages(uint8_t bytes[PLACIDO_GADGET_STRING_BYTES_MAX]) {
  bytes[0] = 4;
  bytes[1] = DESCRIPTOR_STRING;
  bytes[2] = ENGLISH_US & 0xFF;
  bytes[3] = ENGLISH_US >> 8;
  return 4;
}
