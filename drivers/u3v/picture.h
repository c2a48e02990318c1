/* One picture out of its transfers: whether it is whole, what was said of it, and a frame of it. */
#ifndef PLACIDO_DRIVERS_U3V_PICTURE_H
#define PLACIDO_DRIVERS_U3V_PICTURE_H

#include "drivers/u3v/mode.h"
#include "drivers/u3v/ring.h"
#include "drivers/u3v/wire/packet.h"

#include <placido/frame.h>

enum placido_u3v_verdict {
  PLACIDO_U3V_PENDING,
  PLACIDO_U3V_WHOLE, /* with its end in its place; samples may be missing all the same */
  PLACIDO_U3V_EARLY, /* its end came before its place: a picture, and the next is out of step */
  PLACIDO_U3V_LOST,  /* no picture: out of step, or a transfer failed */
};

typedef struct placido_u3v_picture {
  placido_u3v_leader leader;
  placido_u3v_trailer trailer;
  size_t bytes;        /* of samples, from the first on without a hole */
  const char *trouble; /* of a picture that is LOST or EARLY: what to tell a person */
  bool is_gone;        /* LOST because the camera was unplugged */
} placido_u3v_picture;

/* Looks at the ring's head. What a transfer is tells its place, never its bytes: samples may look
 * like a leader. Only behind a short transfer a trailer is looked for that names this picture and
 * its bytes. */
enum placido_u3v_verdict placido_u3v_picture_look(placido_u3v_picture *picture,
                                                  const placido_u3v_ring *ring);

/* How many pictures are lost with the ring: one where anything has come, and more where a leader of
 * a later number than `last_id` has, in whatever place. */
uint64_t placido_u3v_picture_lost(const placido_u3v_ring *ring, uint64_t last_id);

/* A sentence for how a transfer ended. */
const char *placido_u3v_trouble(enum placido_u3v_end end);

/* Makes a frame of the head of the ring: sizes, samples, flags. Returns PLACIDO_OK, PLACIDO_INPUT
 * (not a picture as agreed), PLACIDO_MEMORY (nothing has changed). */
int placido_u3v_picture_to_frame(placido_frame *frame, const placido_u3v_picture *picture,
                                 placido_u3v_ring *ring, const placido_u3v_mode *mode,
                                 placido_error *err);

#endif
