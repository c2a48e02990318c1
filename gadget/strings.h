/* String descriptors: text as USB sends it. */
#ifndef PLACIDO_GADGET_STRINGS_H
#define PLACIDO_GADGET_STRINGS_H

#include <stddef.h>
#include <stdint.h>

#define PLACIDO_GADGET_STRING_BYTES_MAX 254 /* 126 characters */

/* A string descriptor of printable ASCII text, UTF-16LE, cut where it is too long; other
 * characters become '?'. Returns its size. */
size_t placido_gadget_string(uint8_t bytes[PLACIDO_GADGET_STRING_BYTES_MAX], const char *text);

/* Descriptor 0: the one language, US English. Returns its size. */
size_t placido_gadget_languages(uint8_t bytes[PLACIDO_GADGET_STRING_BYTES_MAX]);

#endif
