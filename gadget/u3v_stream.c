/* The stream of the simulated USB3 Vision camera: leader, payload in transfers of the sizes that
 * the host has set, trailer. What the host does not fetch in time is not kept. */
#include "drivers/u3v/wire/bytes.h"
#include "gadget/u3v_camera.h"

#include <string.h>

placido_u3v_picture *placido_u3v_stream_room(placido_u3v_camera *camera) {
  if (camera->picture_count == PLACIDO_U3V_GADGET_PICTURES || !placido_u3v_is_streaming(camera)) {
    return NULL;
  }
  const size_t next = camera->picture_first + camera->picture_count;
  return &camera->pictures[next % PLACIDO_U3V_GADGET_PICTURES];
}

void placido_u3v_stream_push(placido_u3v_camera *camera) {
  camera->picture_count++;
}

static void begin_part(placido_u3v_camera *camera, enum placido_u3v_part part) {
  camera->part = part;
  camera->part_sent = 0;
  camera->transfer_left = 0;
  camera->transfer_number = 0;
}

static void end_picture(placido_u3v_camera *camera) {
  camera->picture_first = (camera->picture_first + 1) % PLACIDO_U3V_GADGET_PICTURES;
  camera->picture_count--;
  begin_part(camera, PLACIDO_U3V_PART_LEADER);
}

void placido_u3v_stream_flush(placido_u3v_camera *camera) {
  camera->statistics.dropped += camera->picture_count;
  camera->picture_count = 0;
  begin_part(camera, PLACIDO_U3V_PART_LEADER);
}

int64_t placido_u3v_stream_due_ns(const placido_u3v_camera *camera) {
  return camera->picture_count > 0 ? camera->pictures[camera->picture_first].ready_ns : INT64_MAX;
}

/* Sends of `part_size` bytes as many as fit; true with the last of them. */
static bool send_some(placido_u3v_camera *camera, const uint8_t *part, size_t part_size,
                      uint8_t *bytes, size_t size, size_t *sent) {
  const size_t left = part_size - camera->part_sent;
  *sent = left < size ? left : size;
  memcpy(bytes, part + camera->part_sent, *sent);
  camera->part_sent += *sent;
  return camera->part_sent == part_size;
}

/* How long the payload's transfer of a number is: `count` equal ones, then two last ones. */
static size_t transfer_bytes(const placido_u3v_camera *camera, size_t number) {
  const size_t count = placido_read_u32(camera->sirm + PLACIDO_SIRM_PAYLOAD_COUNT);
  return placido_read_u32(camera->sirm + (number < count    ? PLACIDO_SIRM_PAYLOAD_SIZE
                                          : number == count ? PLACIDO_SIRM_FINAL1
                                                            : PLACIDO_SIRM_FINAL2));
}

/* The next transfer that carries anything. What was set up carries a whole picture: that was seen
 * to when the stream was switched on. */
static void begin_transfer(placido_u3v_camera *camera, size_t payload_left) {
  const size_t count = placido_read_u32(camera->sirm + PLACIDO_SIRM_PAYLOAD_COUNT);
  size_t bytes = 0;
  while (bytes == 0 && camera->transfer_number <= count + 1) {
    bytes = transfer_bytes(camera, camera->transfer_number);
    camera->transfer_number =
        bytes == 0 && camera->transfer_number < count ? count : camera->transfer_number + 1;
  }
  camera->transfer_left = bytes > 0 && bytes < payload_left ? bytes : payload_left;
}

static enum placido_gadget_answer send_payload(placido_u3v_camera *camera,
                                               const placido_u3v_picture *picture, uint8_t *bytes,
                                               size_t size, size_t *sent) {
  if (camera->transfer_left == 0) {
    begin_transfer(camera, picture->size - camera->part_sent);
  }
  if (picture->stalls && camera->part_sent + camera->transfer_left > picture->size / 2) {
    camera->statistics.dropped++;
    end_picture(camera);
    return PLACIDO_GADGET_STALL;
  }
  const size_t most = camera->transfer_left < size ? camera->transfer_left : size;
  const bool is_last = send_some(camera, picture->samples, picture->size, bytes, most, sent);
  camera->transfer_left -= *sent;
  if (is_last && picture->has_trailer) {
    begin_part(camera, PLACIDO_U3V_PART_TRAILER);
  } else if (is_last) {
    camera->statistics.pictures++;
    end_picture(camera);
  }
  return PLACIDO_GADGET_DONE;
}

enum placido_gadget_answer placido_u3v_stream_send(placido_u3v_camera *camera, uint8_t *bytes,
                                                   size_t size, size_t *sent) {
  uint8_t packet[PLACIDO_U3V_LEADER_BYTES];
  *sent = 0;
  if (!placido_u3v_is_streaming(camera) || camera->now_ns < placido_u3v_stream_due_ns(camera)) {
    return PLACIDO_GADGET_LATER;
  }
  const placido_u3v_picture *picture = &camera->pictures[camera->picture_first];
  if (camera->part == PLACIDO_U3V_PART_LEADER && !picture->has_leader) {
    begin_part(camera, PLACIDO_U3V_PART_PAYLOAD);
  }
  if (camera->part == PLACIDO_U3V_PART_PAYLOAD) {
    return send_payload(camera, picture, bytes, size, sent);
  }
  if (camera->part == PLACIDO_U3V_PART_LEADER) {
    placido_u3v_leader_encode(packet, &picture->leader);
    if (send_some(camera, packet, PLACIDO_U3V_LEADER_BYTES, bytes, size, sent)) {
      begin_part(camera, PLACIDO_U3V_PART_PAYLOAD);
    }
    return PLACIDO_GADGET_DONE;
  }
  placido_u3v_trailer_encode(packet, &picture->trailer);
  if (send_some(camera, packet, PLACIDO_U3V_TRAILER_BYTES, bytes, size, sent)) {
    camera->statistics.pictures++;
    end_picture(camera);
  }
  return PLACIDO_GADGET_DONE;
}
