/* The control channel of the simulated USB3 Vision camera: a command comes, an answer is
 * fetched. */
#include "drivers/u3v/wire/gencp.h"
#include "gadget/u3v_camera.h"

#include <string.h>

#define PENDING_TIMEOUT_MS 400 /* that the camera asks for */
#define PENDING_NS 150000000   /* and really takes */
#define ACK_BIT 1u             /* in the code of a command */

/* Room for one more answer, the oldest lost where nobody fetches any. */
static placido_u3v_answer *make_room(placido_u3v_camera *camera) {
  if (camera->answer_count == PLACIDO_U3V_GADGET_ANSWERS) {
    const placido_u3v_answer oldest = camera->answers[0];
    camera->answer_count--;
    memmove(camera->answers, camera->answers + 1,
            camera->answer_count * sizeof camera->answers[0]);
    camera->answers[camera->answer_count] = oldest;
  }
  return &camera->answers[camera->answer_count];
}

static void answer(placido_u3v_camera *camera, const placido_gencp_packet *packet,
                   int64_t delay_ns) {
  placido_u3v_answer *room = make_room(camera);
  room->size = placido_gencp_encode(room->bytes, PLACIDO_U3V_GADGET_CONTROL_BYTES, packet);
  room->sent = 0;
  room->ready_ns = camera->now_ns + delay_ns + camera->faults->slow_ms * INT64_C(1000000);
  if (room->size > 0) {
    camera->answer_count++;
  }
}

static uint16_t read_memory(placido_u3v_camera *camera, const placido_gencp_packet *command,
                            placido_gencp_packet *ack) {
  if (command->count > PLACIDO_U3V_GADGET_CONTROL_BYTES - PLACIDO_GENCP_HEADER_BYTES) {
    return PLACIDO_GENCP_INVALID_PARAMETER;
  }
  ack->data = camera->data;
  ack->data_size = command->count;
  return placido_u3v_registers_read(camera, command->address, camera->data, command->count);
}

static uint16_t write_memory(placido_u3v_camera *camera, const placido_gencp_packet *command,
                             placido_gencp_packet *ack) {
  ack->count = (uint16_t)command->data_size;
  return placido_u3v_registers_write(camera, command->address, command->data,
                                     command->data_size);
}

/* A fault of the channel may come between. */
static void reply(placido_u3v_camera *camera, placido_gencp_packet *ack) {
  int64_t delay_ns = 0;
  if (ack->command == PLACIDO_GENCP_READ_ACK &&
      placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_PENDING)) {
    const placido_gencp_packet pending = {.command = PLACIDO_GENCP_PENDING_ACK,
                                          .request_id = ack->request_id,
                                          .count = PENDING_TIMEOUT_MS};
    answer(camera, &pending, 0);
    delay_ns = PENDING_NS;
  }
  answer(camera, ack, delay_ns);
  if (camera->answer_count > 0 && placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_GARBLE)) {
    placido_u3v_answer *last = &camera->answers[camera->answer_count - 1];
    for (size_t i = 0; i < last->size; i++) {
      last->bytes[i] = (uint8_t)(i * 151 + 77);
    }
  }
}

void placido_u3v_control_take(placido_u3v_camera *camera, const uint8_t *bytes, size_t size) {
  placido_gencp_packet command;
  if (size > PLACIDO_U3V_GADGET_CONTROL_BYTES ||
      placido_gencp_decode(&command, bytes, size, NULL) != PLACIDO_OK ||
      placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_SILENT)) {
    return; /* what has no sense has no sender either who waits for an answer */
  }
  placido_gencp_packet ack = {.command = (uint16_t)(command.command | ACK_BIT),
                              .request_id = command.request_id};
  if (placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_REFUSE)) {
    ack.flags = PLACIDO_GENCP_GENERIC_ERROR;
  } else if (command.command == PLACIDO_GENCP_READ) {
    ack.flags = read_memory(camera, &command, &ack);
  } else if (command.command == PLACIDO_GENCP_WRITE) {
    ack.flags = write_memory(camera, &command, &ack);
  } else {
    ack.flags = PLACIDO_GENCP_NOT_IMPLEMENTED;
  }
  camera->statistics.commands++;
  if (command.flags & PLACIDO_GENCP_WANTS_ACK) {
    reply(camera, &ack);
  }
}

int64_t placido_u3v_control_due_ns(const placido_u3v_camera *camera) {
  return camera->answer_count > 0 ? camera->answers[0].ready_ns : INT64_MAX;
}

enum placido_gadget_answer placido_u3v_control_send(placido_u3v_camera *camera, uint8_t *bytes,
                                                    size_t size, size_t *sent) {
  *sent = 0;
  if (camera->now_ns < placido_u3v_control_due_ns(camera)) {
    return PLACIDO_GADGET_LATER;
  }
  placido_u3v_answer first = camera->answers[0];
  *sent = first.size - first.sent < size ? first.size - first.sent : size;
  memcpy(bytes, first.bytes + first.sent, *sent);
  camera->answers[0].sent += *sent;
  if (camera->answers[0].sent == first.size) {
    camera->answer_count--;
    memmove(camera->answers, camera->answers + 1,
            camera->answer_count * sizeof camera->answers[0]);
    camera->answers[camera->answer_count] = first; /* its bytes are kept for a later one */
  }
  return PLACIDO_GADGET_DONE;
}
