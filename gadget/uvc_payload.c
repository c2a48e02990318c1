/* Payloads and their headers: UVC 1.1, section 2.4.3; bulk transfers, section 2.4.3.2.1. */
#include "gadget/uvc_payload.h"

#include "drivers/u3v/wire/bytes.h"
#include "gadget/uvc_descriptors.h"

#include <linux/usb/video.h>
#include <string.h>

static size_t room_of(const placido_uvc_stream *stream) {
  return stream->payload_bytes - PLACIDO_UVC_HEADER_BYTES;
}

void placido_uvc_stream_begin(placido_uvc_stream *stream, const uint8_t *image, size_t size,
                              int64_t taken_ns, enum placido_gadget_fault fault) {
  stream->has_picture = true;
  stream->has_payload = false;
  stream->taken_ns = taken_ns;
  stream->fault = fault;
  stream->image = image;
  stream->size = size;
  stream->taken = 0;
  stream->id ^= UVC_STREAM_FID;
  if (fault == PLACIDO_GADGET_FAULT_DROP) {
    stream->size = 0;
  } else if (fault == PLACIDO_GADGET_FAULT_TRUNCATE) {
    stream->size = size / 2;
  } else if (fault == PLACIDO_GADGET_FAULT_LOST_START) {
    stream->taken = room_of(stream);
  }
}

void placido_uvc_stream_abandon(placido_uvc_stream *stream) {
  stream->has_picture = stream->has_payload = stream->owes_end = false;
}

static uint32_t clock_of(int64_t t_ns) {
  return (uint32_t)(t_ns / (INT64_C(1000000000) / PLACIDO_UVC_CLOCK_HZ));
}

/* The device's clock and its count of the bus's milliseconds are read from one clock, so that the
 * host finds them in step. The bus's own count does not come over USB/IP; the class allows one that
 * runs beside it. */
static void make_header(placido_uvc_stream *stream, int64_t now_ns, bool is_last) {
  unsigned flags = UVC_STREAM_EOH | UVC_STREAM_SCR | UVC_STREAM_PTS | stream->id;
  if (is_last) {
    flags |= UVC_STREAM_EOF;
  }
  if (stream->fault == PLACIDO_GADGET_FAULT_CORRUPT) {
    flags |= UVC_STREAM_ERR;
  }
  stream->header[0] = PLACIDO_UVC_HEADER_BYTES;
  stream->header[1] = (uint8_t)flags;
  placido_write_u32(stream->header + 2, clock_of(stream->taken_ns));
  placido_write_u32(stream->header + 6, clock_of(now_ns));
  placido_write_u16(stream->header + 10, (uint16_t)(now_ns / 1000000 & 0x7ff));
}

/* Begins the picture's next payload; LATER where there is none, and the picture is over. */
static enum placido_gadget_answer begin_payload(placido_uvc_stream *stream, int64_t now_ns) {
  const size_t room = room_of(stream);
  const bool is_late = stream->taken >= stream->size / 2 || stream->size <= room;
  if (is_late && stream->fault == PLACIDO_GADGET_FAULT_STALL) {
    placido_uvc_stream_abandon(stream);
    return PLACIDO_GADGET_STALL;
  }
  if (is_late && stream->fault == PLACIDO_GADGET_FAULT_MISNUMBER) {
    stream->id ^= UVC_STREAM_FID;
    stream->fault = PLACIDO_UVC_NO_FAULT;
  }
  const size_t left = stream->taken < stream->size ? stream->size - stream->taken : 0;
  const bool is_last = left <= room;
  if ((is_last && stream->fault == PLACIDO_GADGET_FAULT_LOST_END) ||
      (left == 0 && stream->fault == PLACIDO_GADGET_FAULT_LOST_START)) {
    stream->has_picture = false;
    return PLACIDO_GADGET_LATER;
  }
  make_header(stream, now_ns, is_last);
  stream->header_left = PLACIDO_UVC_HEADER_BYTES;
  stream->data_left = is_last ? left : room;
  stream->has_payload = true;
  return PLACIDO_GADGET_DONE;
}

/* A payload ends by being as long as it may be, or by a transfer that is not full. */
static void end_payload(placido_uvc_stream *stream, bool is_transfer_full) {
  stream->has_payload = false;
  if (stream->taken >= stream->size) {
    const bool is_short = stream->size == 0 || stream->size % room_of(stream) > 0;
    stream->has_picture = false;
    stream->owes_end = is_short && is_transfer_full;
  }
}

/* As much of the payload as the transfer takes. */
static size_t move(placido_uvc_stream *stream, uint8_t *bytes, size_t size) {
  const size_t head = stream->header_left < size ? stream->header_left : size;
  const size_t data = stream->data_left < size - head ? stream->data_left : size - head;
  memcpy(bytes, stream->header + PLACIDO_UVC_HEADER_BYTES - stream->header_left, head);
  memcpy(bytes + head, stream->image + stream->taken, data);
  stream->header_left -= head;
  stream->data_left -= data;
  stream->taken += data;
  if (stream->header_left + stream->data_left == 0) {
    end_payload(stream, head + data == size);
  }
  return head + data;
}

enum placido_gadget_answer placido_uvc_stream_take(placido_uvc_stream *stream, int64_t now_ns,
                                                   uint8_t *bytes, size_t size, size_t *sent) {
  *sent = 0;
  if (stream->owes_end) {
    stream->owes_end = false;
    return PLACIDO_GADGET_DONE;
  }
  if (!stream->has_picture) {
    return PLACIDO_GADGET_LATER;
  }
  if (!stream->has_payload) {
    const enum placido_gadget_answer answer = begin_payload(stream, now_ns);
    if (answer != PLACIDO_GADGET_DONE) {
      return answer;
    }
  }
  *sent = move(stream, bytes, size);
  return PLACIDO_GADGET_DONE;
}
