/* The address space of the simulated USB3 Vision camera: what lies where, and the registers that
 * every such camera has. */
#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "gadget/u3v_camera.h"

#include <stdio.h>
#include <string.h>

#define GENCP_VERSION 0x00010000u
#define U3V_VERSION 0x00010002u
/* There are: a user-defined name, a timestamp, a family name, the SBRM, the endianness registers,
 * and a count in the answer to a write. */
#define DEVICE_CAPABILITY 0xF09u
#define SI_NOT_ALIGNED 0xA003u
#define SI_INCONSISTENT 0xA004u
#define ALIGNMENT_LOG2 2u
#define RESPONSE_MS 200u
#define SPEED_HIGH 4u /* of the register "current speed" */
#define SPEED_SUPER 8u
#define NAME_BYTES 64

bool placido_u3v_is_streaming(const placido_u3v_camera *camera) {
  return (placido_read_u32(camera->sirm + PLACIDO_SIRM_CONTROL) & PLACIDO_SIRM_CONTROL_ENABLE) != 0;
}

/* Whether the transfers that the host has set up carry a picture. */
static uint16_t check_transfers(const placido_u3v_camera *camera) {
  const uint8_t *sirm = camera->sirm;
  const uint64_t size = placido_read_u32(sirm + PLACIDO_SIRM_PAYLOAD_SIZE);
  const uint64_t count = placido_read_u32(sirm + PLACIDO_SIRM_PAYLOAD_COUNT);
  const uint64_t final1 = placido_read_u32(sirm + PLACIDO_SIRM_FINAL1);
  const uint64_t final2 = placido_read_u32(sirm + PLACIDO_SIRM_FINAL2);
  const uint64_t leader = placido_read_u32(sirm + PLACIDO_SIRM_MAX_LEADER);
  const uint64_t trailer = placido_read_u32(sirm + PLACIDO_SIRM_MAX_TRAILER);
  const uint64_t mask = (1u << ALIGNMENT_LOG2) - 1;
  if (((size | final1 | final2 | leader | trailer) & mask) != 0) {
    return SI_NOT_ALIGNED;
  }
  return size * count + final1 + final2 < placido_u3v_payload_bytes(camera) ||
                 leader < PLACIDO_U3V_LEADER_BYTES || trailer < PLACIDO_U3V_TRAILER_BYTES
             ? SI_INCONSISTENT
             : PLACIDO_GENCP_SUCCESS;
}

static uint16_t write_stream(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                             size_t size) {
  static const uint8_t writable[] = {PLACIDO_SIRM_MAX_LEADER, PLACIDO_SIRM_PAYLOAD_SIZE,
                                     PLACIDO_SIRM_PAYLOAD_COUNT, PLACIDO_SIRM_FINAL1,
                                     PLACIDO_SIRM_FINAL2, PLACIDO_SIRM_MAX_TRAILER};
  if (at == PLACIDO_SIRM_CONTROL && size == 4) {
    const bool is_on = (placido_read_u32(bytes) & PLACIDO_SIRM_CONTROL_ENABLE) != 0;
    const uint16_t status = is_on ? check_transfers(camera) : PLACIDO_GENCP_SUCCESS;
    if (status == PLACIDO_GENCP_SUCCESS) {
      placido_u3v_stream_flush(camera);
      placido_write_u32(camera->sirm + at, is_on);
    }
    return status;
  }
  if (at >= PLACIDO_SIRM_BYTES || !memchr(writable, (int)at, sizeof writable)) {
    return PLACIDO_GENCP_WRITE_PROTECT;
  }
  if (size != 4) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  if (placido_u3v_is_streaming(camera)) {
    return PLACIDO_GENCP_ACCESS_DENIED;
  }
  memcpy(camera->sirm + at, bytes, size);
  return PLACIDO_GENCP_SUCCESS;
}

static uint16_t write_technology(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                                 size_t size) {
  if (at != PLACIDO_SBRM_CONFIGURATION || size != 8) {
    return PLACIDO_GENCP_WRITE_PROTECT;
  }
  memcpy(camera->sbrm + at, bytes, size);
  return PLACIDO_GENCP_SUCCESS;
}

static uint16_t write_bootstrap(placido_u3v_camera *camera, size_t at, const uint8_t *bytes,
                                size_t size) {
  const bool is_name =
      at >= PLACIDO_ABRM_USER_NAME && at + size <= PLACIDO_ABRM_USER_NAME + NAME_BYTES;
  const bool is_configuration = at == PLACIDO_ABRM_CONFIGURATION && size == 8;
  if (at == PLACIDO_ABRM_TIMESTAMP_LATCH && size == 4) {
    placido_write_u64(camera->abrm + PLACIDO_ABRM_TIMESTAMP,
                      (uint64_t)(camera->now_ns - camera->power_up_ns));
    return PLACIDO_GENCP_SUCCESS;
  }
  if (!is_name && !is_configuration) {
    return PLACIDO_GENCP_WRITE_PROTECT;
  }
  memcpy(camera->abrm + at, bytes, size);
  return PLACIDO_GENCP_SUCCESS;
}

/* Where `size` bytes lie within a region; NULL: nowhere. */
static const placido_u3v_region *find_region(const placido_u3v_camera *camera, uint64_t address,
                                             size_t size) {
  for (size_t i = 0; i < PLACIDO_U3V_GADGET_REGIONS; i++) {
    const placido_u3v_region *region = &camera->regions[i];
    if (address >= region->address && address - region->address < region->size &&
        size <= region->size - (address - region->address)) {
      return region;
    }
  }
  return NULL;
}

uint16_t placido_u3v_registers_read(placido_u3v_camera *camera, uint64_t address, uint8_t *bytes,
                                    size_t size) {
  const placido_u3v_region *region = find_region(camera, address, size);
  if (size == 0) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  if (!region) {
    return PLACIDO_GENCP_INVALID_ADDRESS;
  }
  placido_u3v_features_refresh(camera);
  placido_write_u64(camera->sirm + PLACIDO_SIRM_REQUIRED_PAYLOAD,
                    placido_u3v_payload_bytes(camera));
  memcpy(bytes, region->bytes + (address - region->address), size);
  return PLACIDO_GENCP_SUCCESS;
}

uint16_t placido_u3v_registers_write(placido_u3v_camera *camera, uint64_t address,
                                     const uint8_t *bytes, size_t size) {
  static const struct {
    uint64_t address;
    uint16_t (*write)(placido_u3v_camera *camera, size_t at, const uint8_t *bytes, size_t size);
  } writers[] = {{0, write_bootstrap},
                 {PLACIDO_U3V_GADGET_SBRM, write_technology},
                 {PLACIDO_U3V_GADGET_SIRM, write_stream},
                 {PLACIDO_U3V_GADGET_FEATURES, placido_u3v_features_write}};
  const placido_u3v_region *region = find_region(camera, address, size);
  if (size == 0) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  if (!region) {
    return PLACIDO_GENCP_INVALID_ADDRESS;
  }
  for (size_t i = 0; i < sizeof writers / sizeof writers[0]; i++) {
    if (writers[i].address == region->address) {
      return writers[i].write(camera, (size_t)(address - region->address), bytes, size);
    }
  }
  return PLACIDO_GENCP_WRITE_PROTECT;
}

static void put_text(uint8_t *bytes, const char *text) {
  snprintf((char *)bytes, NAME_BYTES, "%s", text);
}

static void set_up_bootstrap(placido_u3v_camera *camera, const char *serial) {
  uint8_t *abrm = camera->abrm;
  placido_write_u32(abrm + PLACIDO_ABRM_GENCP_VERSION, GENCP_VERSION);
  put_text(abrm + PLACIDO_ABRM_MANUFACTURER, "Placido");
  put_text(abrm + PLACIDO_ABRM_MODEL, "Simulated topographer");
  put_text(abrm + PLACIDO_ABRM_FAMILY, "device-sim");
  put_text(abrm + PLACIDO_ABRM_DEVICE_VERSION, PLACIDO_VERSION);
  put_text(abrm + PLACIDO_ABRM_MANUFACTURER_INFO, "not a medical device");
  put_text(abrm + PLACIDO_ABRM_SERIAL, serial);
  placido_write_u64(abrm + PLACIDO_ABRM_CAPABILITY, DEVICE_CAPABILITY);
  placido_write_u32(abrm + PLACIDO_ABRM_MAX_RESPONSE_MS, RESPONSE_MS);
  placido_write_u64(abrm + PLACIDO_ABRM_MANIFEST_ADDRESS, PLACIDO_U3V_GADGET_MANIFEST);
  placido_write_u64(abrm + PLACIDO_ABRM_SBRM_ADDRESS, PLACIDO_U3V_GADGET_SBRM);
  placido_write_u64(abrm + PLACIDO_ABRM_TIMESTAMP_INCREMENT, 1);
  placido_write_u32(abrm + PLACIDO_ABRM_PROTOCOL_ENDIANNESS, 0xFFFFFFFFu); /* little */
  placido_write_u32(abrm + PLACIDO_ABRM_IMPLEMENTATION_ENDIANNESS, 0xFFFFFFFFu);
}

static void set_up_technology(placido_u3v_camera *camera) {
  uint8_t *sbrm = camera->sbrm;
  placido_write_u32(sbrm + PLACIDO_SBRM_U3V_VERSION, U3V_VERSION);
  placido_write_u64(sbrm + PLACIDO_SBRM_CAPABILITY, 1);
  placido_write_u32(sbrm + PLACIDO_SBRM_MAX_COMMAND, PLACIDO_U3V_GADGET_CONTROL_BYTES);
  placido_write_u32(sbrm + PLACIDO_SBRM_MAX_ACK, PLACIDO_U3V_GADGET_CONTROL_BYTES);
  placido_write_u32(sbrm + PLACIDO_SBRM_STREAM_CHANNELS, 1);
  placido_write_u64(sbrm + PLACIDO_SBRM_SIRM_ADDRESS, PLACIDO_U3V_GADGET_SIRM);
  placido_write_u32(sbrm + PLACIDO_SBRM_SIRM_LENGTH, PLACIDO_SIRM_BYTES);
  placido_write_u32(sbrm + PLACIDO_SBRM_CURRENT_SPEED,
                    camera->speed == PLACIDO_GADGET_SUPER ? SPEED_SUPER : SPEED_HIGH);
}

static void set_up_manifest(placido_u3v_camera *camera, bool is_zip) {
  uint8_t *entry = camera->manifest + 8;
  placido_write_u64(camera->manifest, 1);
  placido_write_u32(entry, 0x01000000u); /* version 1.0.0 of the file */
  placido_write_u32(entry + PLACIDO_MANIFEST_SCHEMA,
                    0x01010000u | (is_zip ? 1u << 10 : 0u)); /* GenApi 1.1 */
  placido_write_u64(entry + PLACIDO_MANIFEST_ADDRESS, PLACIDO_U3V_GADGET_DESCRIPTION);
  placido_write_u64(entry + PLACIDO_MANIFEST_SIZE, camera->description_size);
}

void placido_u3v_registers_set_up(placido_u3v_camera *camera, const char *serial, bool is_zip) {
  const placido_u3v_region regions[PLACIDO_U3V_GADGET_REGIONS] = {
      {0, camera->abrm, sizeof camera->abrm},
      {PLACIDO_U3V_GADGET_SBRM, camera->sbrm, sizeof camera->sbrm},
      {PLACIDO_U3V_GADGET_SIRM, camera->sirm, sizeof camera->sirm},
      {PLACIDO_U3V_GADGET_MANIFEST, camera->manifest, sizeof camera->manifest},
      {PLACIDO_U3V_GADGET_FEATURES, camera->features, sizeof camera->features},
      {PLACIDO_U3V_GADGET_DESCRIPTION, camera->description, camera->description_size},
  };
  memcpy(camera->regions, regions, sizeof regions);
  set_up_bootstrap(camera, serial);
  set_up_technology(camera);
  set_up_manifest(camera, is_zip);
  placido_u3v_registers_reset(camera);
}

void placido_u3v_registers_reset(placido_u3v_camera *camera) {
  memset(camera->sirm, 0, sizeof camera->sirm);
  placido_write_u32(camera->sirm + PLACIDO_SIRM_INFO, ALIGNMENT_LOG2 << 24);
  placido_write_u32(camera->sirm + PLACIDO_SIRM_REQUIRED_LEADER, PLACIDO_U3V_LEADER_BYTES);
  placido_write_u32(camera->sirm + PLACIDO_SIRM_REQUIRED_TRAILER, PLACIDO_U3V_TRAILER_BYTES);
  placido_u3v_features_reset(camera);
}
