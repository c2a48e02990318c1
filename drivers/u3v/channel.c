/* Commands and their answers: numbered, repeated where none comes, cut into pieces that the
 * camera can take. */
#include "drivers/u3v/channel.h"

#include "base/memory.h"
#include "drivers/u3v/wire/bytes.h"
#include "drivers/u3v/wire/gencp.h"
#include "drivers/u3v/wire/registers.h"

#include <string.h>

#define TRIES 5
#define FIRST_RESPONSE_MS 500 /* until the camera has told its own */
#define RESPONSE_MS_MIN 200
#define RESPONSE_MS_MAX 5000
#define PAUSE_MS 20 /* for a busy camera; and what USB says first of an unplug is not GONE */
#define COMMAND_NS_MAX (30 * INT64_C(1000000000))  /* all tries, and the time a camera asks for */
#define TRANSFER_NS_MAX (60 * INT64_C(1000000000)) /* all pieces */
#define ANSWERS_MAX 1000 /* that come to one try: behind these the camera only babbles */

/* A number of 8 bytes has to go through in one piece; no packet is longer than its length field
 * says. */
#define COMMAND_BYTES_MIN (PLACIDO_GENCP_WRITE_HEADER_BYTES + 8)
#define ACK_BYTES_MIN (PLACIDO_GENCP_HEADER_BYTES + 8)
#define PACKET_BYTES_MAX 65536u

/* What came of one try. */
enum outcome { ANSWERED, SILENT, BROKEN, LEFT };

static int64_t now_ns(const placido_u3v_channel *channel) {
  return channel->calls->clock_ns(channel->calls->context);
}

static int left_ms(const placido_u3v_channel *channel, int64_t until_ns) {
  const int64_t left_ns = until_ns - now_ns(channel);
  return left_ns > 0 ? (int)((left_ns + 999999) / 1000000) : 0;
}

static int64_t sooner(int64_t a_ns, int64_t b_ns) {
  return a_ns < b_ns ? a_ns : b_ns;
}

static uint16_t next_id(placido_u3v_channel *channel) {
  channel->last_id = channel->last_id == UINT16_MAX ? 1 : (uint16_t)(channel->last_id + 1);
  return channel->last_id;
}

/* How a transfer that is not done ends the try. A halted endpoint is set right for the next. */
static enum outcome give_up(placido_u3v_channel *channel, enum placido_u3v_end end) {
  if (end == PLACIDO_U3V_STALLED || end == PLACIDO_U3V_OVERFLOW) {
    end = channel->calls->reset(channel->pipe, 0) == PLACIDO_U3V_GONE ? PLACIDO_U3V_GONE : end;
  }
  return end == PLACIDO_U3V_GONE ? LEFT : end == PLACIDO_U3V_TIMED_OUT ? SILENT : BROKEN;
}

/* Waits for the answer to `command`. What is not it is passed over: noise, or what comes late of an
 * earlier try. */
static enum outcome receive(placido_u3v_channel *channel, const placido_gencp_packet *command,
                            placido_gencp_packet *answer, int64_t limit_ns) {
  const size_t packet = channel->packet_bytes;
  const size_t size = (channel->max_ack_bytes + packet - 1) / packet * packet;
  int64_t until_ns =
      sooner(now_ns(channel) + channel->response_ms * INT64_C(1000000), limit_ns);
  for (int i = 0; i < ANSWERS_MAX && now_ns(channel) < until_ns; i++) {
    size_t received = 0;
    const enum placido_u3v_end end =
        channel->calls->read(channel->pipe, channel->buffer, size, &received,
                             left_ms(channel, until_ns));
    if (end != PLACIDO_U3V_DONE && !(end == PLACIDO_U3V_TIMED_OUT && received > 0)) {
      return give_up(channel, end);
    }
    if (received > size ||
        placido_gencp_decode(answer, channel->buffer, received, NULL) != PLACIDO_OK ||
        answer->request_id != command->request_id) {
      continue;
    }
    if (answer->command == PLACIDO_GENCP_PENDING_ACK) {
      const int asked_ms = answer->count;
      const int wait_ms = asked_ms > channel->response_ms ? asked_ms : channel->response_ms;
      channel->pending_count++;
      until_ns = sooner(now_ns(channel) + wait_ms * INT64_C(1000000), limit_ns);
    } else if (answer->command == command->command + 1) {
      return ANSWERED;
    }
  }
  return SILENT;
}

/* One try: sends the command under a new number and waits for the answer. */
static enum outcome attempt(placido_u3v_channel *channel, placido_gencp_packet *command,
                            placido_gencp_packet *answer, int64_t limit_ns) {
  command->request_id = next_id(channel);
  const size_t size = placido_gencp_encode(channel->buffer, channel->max_command_bytes, command);
  const enum placido_u3v_end end =
      channel->calls->write(channel->pipe, channel->buffer, size, channel->response_ms);
  return end == PLACIDO_U3V_DONE ? receive(channel, command, answer, limit_ns)
                                 : give_up(channel, end);
}

/* Why no try had an answer. */
static int explain(const placido_u3v_channel *channel, enum outcome outcome,
                   const placido_gencp_packet *command, placido_error *err) {
  const unsigned long long address = command->address;
  if (outcome == LEFT) {
    return placido_error_set(err, PLACIDO_GONE, "the camera is gone: unplugged or without power");
  }
  if (outcome == SILENT) {
    return placido_error_set(err, PLACIDO_TIMEOUT,
                             "the camera does not answer (register 0x%llx, up to %d tries of %d "
                             "ms)",
                             address, TRIES, channel->response_ms);
  }
  return placido_error_set(err, PLACIDO_SYSTEM,
                           "USB fails in talking to the camera (register 0x%llx)", address);
}

/* Sends a command until it is answered with success. `answer` points into the channel's buffer. */
static int exchange(placido_u3v_channel *channel, placido_gencp_packet *command,
                    placido_gencp_packet *answer, placido_error *err) {
  const int64_t limit_ns = now_ns(channel) + COMMAND_NS_MAX;
  const bool is_read = command->command == PLACIDO_GENCP_READ;
  enum outcome outcome = SILENT;
  for (int i = 0; i < TRIES && outcome != LEFT && now_ns(channel) < limit_ns; i++) {
    channel->retry_count += i > 0;
    outcome = attempt(channel, command, answer, limit_ns);
    if (outcome == ANSWERED && answer->flags != PLACIDO_GENCP_BUSY) {
      break;
    }
    if (outcome == ANSWERED || outcome == BROKEN) {
      channel->calls->sleep_ms(channel->calls->context, PAUSE_MS);
    }
  }
  if (outcome != ANSWERED) {
    return explain(channel, outcome, command, err);
  }
  if (answer->flags != PLACIDO_GENCP_SUCCESS) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "the camera refuses to %s register 0x%llx: %s (status 0x%04x)",
                             is_read ? "read" : "write", (unsigned long long)command->address,
                             placido_gencp_status_text(answer->flags), (unsigned)answer->flags);
  }
  return PLACIDO_OK;
}

static int read_piece(placido_u3v_channel *channel, uint64_t address, uint8_t *bytes, size_t size,
                      placido_error *err) {
  placido_gencp_packet answer, command = {.flags = PLACIDO_GENCP_WANTS_ACK,
                                          .command = PLACIDO_GENCP_READ,
                                          .address = address,
                                          .count = (uint16_t)size};
  const int status = exchange(channel, &command, &answer, err);
  if (status) {
    return status;
  }
  if (answer.data_size != size) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "the camera gives %zu bytes of register 0x%llx, asked for %zu",
                             answer.data_size, (unsigned long long)address, size);
  }
  memcpy(bytes, answer.data, size);
  return PLACIDO_OK;
}

static int write_piece(placido_u3v_channel *channel, uint64_t address, const uint8_t *bytes,
                       size_t size, placido_error *err) {
  placido_gencp_packet answer, command = {.flags = PLACIDO_GENCP_WANTS_ACK,
                                          .command = PLACIDO_GENCP_WRITE,
                                          .address = address,
                                          .data = bytes,
                                          .data_size = size};
  const int status = exchange(channel, &command, &answer, err);
  if (status) {
    return status;
  }
  if (answer.count != 0 && answer.count != size) { /* 0: the camera does not tell */
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "the camera took %u bytes of %zu for register 0x%llx",
                             (unsigned)answer.count, size, (unsigned long long)address);
  }
  return PLACIDO_OK;
}

/* Bytes of a piece, of at most `most`: a multiple of 8, so that no register is cut. */
static size_t piece_bytes(size_t left, size_t most) {
  return left <= most / 8 * 8 ? left : most / 8 * 8;
}

/* Refuses to begin a further piece of a transfer that takes too long. */
static int check_time(const placido_u3v_channel *channel, uint64_t address, int64_t limit_ns,
                      placido_error *err) {
  return now_ns(channel) < limit_ns
             ? PLACIDO_OK
             : placido_error_set(err, PLACIDO_TIMEOUT,
                                 "the camera takes too long (at register 0x%llx)",
                                 (unsigned long long)address);
}

int placido_u3v_channel_read(placido_u3v_channel *channel, uint64_t address, void *bytes,
                             size_t size, placido_error *err) {
  const int64_t limit_ns = now_ns(channel) + TRANSFER_NS_MAX;
  const size_t most = channel->max_ack_bytes - PLACIDO_GENCP_HEADER_BYTES;
  int status = PLACIDO_OK;
  for (size_t done = 0; !status && done < size;) {
    const size_t piece = piece_bytes(size - done, most);
    status = check_time(channel, address + done, limit_ns, err);
    if (!status) {
      status = read_piece(channel, address + done, (uint8_t *)bytes + done, piece, err);
    }
    done += piece;
  }
  return status;
}

int placido_u3v_channel_write(placido_u3v_channel *channel, uint64_t address, const void *bytes,
                              size_t size, placido_error *err) {
  const int64_t limit_ns = now_ns(channel) + TRANSFER_NS_MAX;
  const size_t most = channel->max_command_bytes - PLACIDO_GENCP_WRITE_HEADER_BYTES;
  int status = PLACIDO_OK;
  for (size_t done = 0; !status && done < size;) {
    const size_t piece = piece_bytes(size - done, most);
    status = check_time(channel, address + done, limit_ns, err);
    if (!status) {
      status = write_piece(channel, address + done, (const uint8_t *)bytes + done, piece, err);
    }
    done += piece;
  }
  return status;
}

int placido_u3v_channel_read_u32(placido_u3v_channel *channel, uint64_t address, uint32_t *value,
                                 placido_error *err) {
  uint8_t bytes[4] = {0};
  const int status = placido_u3v_channel_read(channel, address, bytes, sizeof bytes, err);
  *value = placido_read_u32(bytes);
  return status;
}

int placido_u3v_channel_read_u64(placido_u3v_channel *channel, uint64_t address, uint64_t *value,
                                 placido_error *err) {
  uint8_t bytes[8] = {0};
  const int status = placido_u3v_channel_read(channel, address, bytes, sizeof bytes, err);
  *value = placido_read_u64(bytes);
  return status;
}

int placido_u3v_channel_write_u32(placido_u3v_channel *channel, uint64_t address, uint32_t value,
                                  placido_error *err) {
  uint8_t bytes[4];
  placido_write_u32(bytes, value);
  return placido_u3v_channel_write(channel, address, bytes, sizeof bytes, err);
}

/* Asks the camera how long it takes and how long packets may be. */
static int read_limits(placido_u3v_channel *channel, placido_error *err) {
  uint64_t sbrm = 0;
  uint32_t response_ms = 0, max_command = 0, max_ack = 0;
  int status =
      placido_u3v_channel_read_u32(channel, PLACIDO_ABRM_MAX_RESPONSE_MS, &response_ms, err);
  if (!status) {
    status = placido_u3v_channel_read_u64(channel, PLACIDO_ABRM_SBRM_ADDRESS, &sbrm, err);
  }
  if (!status && (sbrm == 0 || sbrm > UINT64_MAX - PLACIDO_SBRM_BYTES)) {
    status = placido_error_set(err, PLACIDO_INPUT,
                               "the camera's USB3 Vision registers cannot be at 0x%llx",
                               (unsigned long long)sbrm);
  }
  if (!status) {
    status = placido_u3v_channel_read_u32(channel, sbrm + PLACIDO_SBRM_MAX_COMMAND, &max_command,
                                          err);
  }
  if (!status) {
    status = placido_u3v_channel_read_u32(channel, sbrm + PLACIDO_SBRM_MAX_ACK, &max_ack, err);
  }
  if (status) {
    return status;
  }
  if (max_command < COMMAND_BYTES_MIN || max_ack < ACK_BYTES_MIN) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera takes commands of %u bytes and answers with %u; %d and "
                             "%d are the fewest",
                             (unsigned)max_command, (unsigned)max_ack, COMMAND_BYTES_MIN,
                             ACK_BYTES_MIN);
  }
  channel->max_command_bytes = max_command < PACKET_BYTES_MAX ? max_command : PACKET_BYTES_MAX;
  channel->max_ack_bytes = max_ack < PACKET_BYTES_MAX ? max_ack : PACKET_BYTES_MAX;
  channel->response_ms = response_ms < RESPONSE_MS_MIN   ? RESPONSE_MS_MIN
                         : response_ms > RESPONSE_MS_MAX ? RESPONSE_MS_MAX
                                                         : (int)response_ms;
  return PLACIDO_OK;
}

int placido_u3v_channel_open(placido_u3v_channel *channel, const placido_u3v_calls *calls,
                             void *pipe, size_t packet_bytes, placido_error *err) {
  *channel = (placido_u3v_channel){.calls = calls,
                                   .pipe = pipe,
                                   .packet_bytes = packet_bytes > 0 ? packet_bytes : 1,
                                   .max_command_bytes = PLACIDO_GENCP_READ_BYTES,
                                   .max_ack_bytes = 64,
                                   .response_ms = FIRST_RESPONSE_MS};
  /* Answers are read in whole packets, the last of which may begin at the greatest size. */
  channel->buffer = placido_memory_new(PACKET_BYTES_MAX + channel->packet_bytes, 1, err);
  if (!channel->buffer) {
    return PLACIDO_MEMORY;
  }
  int status = read_limits(channel, err);
  if (status == PLACIDO_TIMEOUT || status == PLACIDO_UNSUPPORTED) {
    status = PLACIDO_SYSTEM;
    if (err) {
      err->status = status;
    }
  }
  if (status) {
    placido_u3v_channel_close(channel);
  }
  return status;
}

void placido_u3v_channel_close(placido_u3v_channel *channel) {
  placido_memory_free(channel->buffer);
  channel->buffer = NULL;
}
