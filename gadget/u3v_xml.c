/* The camera's description file, as it is or in a zip that does not compress (PKWARE APPNOTE 6.3,
 * sections 4.3.7, 4.3.12 and 4.3.16). */
#include "gadget/u3v_xml.h"

#include "base/memory.h"
#include "drivers/u3v/wire/bytes.h"
#include "gadget/u3v_camera.h"

#include <string.h>

#define NAME "placido.xml"
#define NAME_BYTES (sizeof NAME - 1)
#define LOCAL_BYTES (30 + NAME_BYTES)
#define CENTRAL_BYTES (46 + NAME_BYTES)
#define END_BYTES 22
#define DOS_DATE 0x5B76u /* 22 November 2025 */
#define VERSION 20u      /* that is needed to read it: 2.0 */

/* CRC-32 of ISO 3309, bit by bit: once, at start-up. */
static uint32_t checksum(const uint8_t *bytes, size_t size) {
  uint32_t crc = 0xFFFFFFFFu;
  for (size_t i = 0; i < size; i++) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; bit++) {
      crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
    }
  }
  return ~crc;
}

/* What both headers of the file have from the field "version needed" on: 26 bytes. */
static void put_common(uint8_t *bytes, uint32_t crc) {
  memset(bytes, 0, 26);
  placido_write_u16(bytes, VERSION);
  placido_write_u16(bytes + 8, DOS_DATE);
  placido_write_u32(bytes + 10, crc);
  placido_write_u32(bytes + 14, (uint32_t)placido_u3v_xml_bytes); /* compressed, and not */
  placido_write_u32(bytes + 18, (uint32_t)placido_u3v_xml_bytes);
  placido_write_u16(bytes + 22, NAME_BYTES);
}

static void put_zip(uint8_t *zip) {
  const uint32_t crc = checksum(placido_u3v_xml, placido_u3v_xml_bytes);
  placido_write_u32(zip, 0x04034B50u);
  put_common(zip + 4, crc);
  memcpy(zip + 30, NAME, NAME_BYTES);
  memcpy(zip + LOCAL_BYTES, placido_u3v_xml, placido_u3v_xml_bytes);

  uint8_t *central = zip + LOCAL_BYTES + placido_u3v_xml_bytes;
  placido_write_u32(central, 0x02014B50u);
  placido_write_u16(central + 4, VERSION);
  put_common(central + 6, crc);
  memset(central + 32, 0, 14); /* no comment, disk 0, no attributes, header at the beginning */
  memcpy(central + 46, NAME, NAME_BYTES);

  uint8_t *end = central + CENTRAL_BYTES;
  memset(end, 0, END_BYTES);
  placido_write_u32(end, 0x06054B50u);
  placido_write_u16(end + 8, 1); /* files on this disk, and in all */
  placido_write_u16(end + 10, 1);
  placido_write_u32(end + 12, CENTRAL_BYTES);
  placido_write_u32(end + 16, (uint32_t)(LOCAL_BYTES + placido_u3v_xml_bytes));
}

int placido_u3v_description_new(uint8_t **bytes, size_t *size, bool is_zip, placido_error *err) {
  *size = placido_u3v_xml_bytes + (is_zip ? LOCAL_BYTES + CENTRAL_BYTES + END_BYTES : 0);
  *bytes = placido_memory_new(*size, 1, err);
  if (!*bytes) {
    return PLACIDO_MEMORY;
  }
  if (is_zip) {
    put_zip(*bytes);
  } else {
    memcpy(*bytes, placido_u3v_xml, placido_u3v_xml_bytes);
  }
  return PLACIDO_OK;
}
