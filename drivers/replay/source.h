/* A session or an image as a row of frames, once or round after round. */
#ifndef PLACIDO_DRIVERS_REPLAY_SOURCE_H
#define PLACIDO_DRIVERS_REPLAY_SOURCE_H

#include <placido/device.h>
#include <placido/session.h>

/* Zeroed before it is opened. */
typedef struct placido_replay_source {
  char uri[1024];                  /* for messages */
  placido_session_reader *session; /* NULL: one image */
  double rate_hz;                  /* NaN where not known */
  placido_frame frame;             /* the last one taken; of an image: the image */
  int64_t frame_count;             /* taken since the last rewind, decoded or not */
  int64_t damaged_count;           /* of these: not decoded */
  bool is_moved;                   /* not at its first frame any more */
  bool joins;                      /* the next frame is the first of a further round */
  int64_t round_count;             /* decoded since this round's beginning */
  int64_t shift_t_ns, shift_seq;   /* what the rounds before this one add */
  int64_t last_t_ns;               /* of the last one decoded */
  uint64_t last_seq;
} placido_replay_source;

/* Opens the session or image, and tells of it in `info`, whose uri is used in messages. Close in
 * any case. */
int placido_replay_source_open(placido_replay_source *source, placido_device_info *info,
                               const char *path, placido_notes *notes, placido_error *err);
void placido_replay_source_close(placido_replay_source *source);

/* Back to the first frame of the first round. */
int placido_replay_source_rewind(placido_replay_source *source, placido_error *err);

/* The next frame into source->frame. Where it loops, time and counter go on by one frame's step
 * behind the last. PLACIDO_END behind the last one, and where a round had none that can be decoded;
 * PLACIDO_INPUT for one that cannot. */
int placido_replay_source_next(placido_replay_source *source, bool loops, placido_error *err);

#endif
