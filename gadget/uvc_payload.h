/* A picture of the simulated UVC camera as the bytes of the stream: payloads, each with a header.
 * Knows nothing of when pictures are taken. */
#ifndef PLACIDO_GADGET_UVC_PAYLOAD_H
#define PLACIDO_GADGET_UVC_PAYLOAD_H

#include "gadget/function.h"
#include "gadget/picture.h"

#include <stdbool.h>

#define PLACIDO_UVC_HEADER_BYTES 12
#define PLACIDO_UVC_NO_FAULT PLACIDO_GADGET_FAULTS

/* Zero but for payload_bytes before the first picture. */
typedef struct placido_uvc_stream {
  size_t payload_bytes; /* the most of one payload, with its header */
  bool has_picture;     /* one is on its way */
  int64_t taken_ns;
  enum placido_gadget_fault fault;
  const uint8_t *image;
  size_t size, taken; /* bytes of the picture, and of them in transfers until now */
  uint8_t id;         /* the bit that tells a picture from the one before */
  bool has_payload;
  uint8_t header[PLACIDO_UVC_HEADER_BYTES];
  size_t header_left, data_left; /* of the payload */
  bool owes_end; /* a short payload ended with a transfer: an empty one must tell so */
} placido_uvc_stream;

/* Begins a picture taken at taken_ns; `image` is borrowed until it is over. */
void placido_uvc_stream_begin(placido_uvc_stream *stream, const uint8_t *image, size_t size,
                              int64_t taken_ns, enum placido_gadget_fault fault);

/* Forgets the picture on its way: the next byte will be the first of a header. */
void placido_uvc_stream_abandon(placido_uvc_stream *stream);

/* The next transfer, as gadget/function.h has `in`. LATER: there is no picture, or no longer. */
enum placido_gadget_answer placido_uvc_stream_take(placido_uvc_stream *stream, int64_t now_ns,
                                                   uint8_t *bytes, size_t size, size_t *sent);

#endif
