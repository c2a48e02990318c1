/* Frames from a session's reader, with time and counter carried on from round to round. */
#include "drivers/replay/source.h"

#include "base/text.h"

#include <placido/image.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

static int describe_session(const placido_replay_source *source, placido_device_info *info,
                            placido_error *err) {
  const placido_session_info *session = placido_session_reader_info(source->session);
  const char *instrument = placido_session_reader_instrument(source->session);
  memcpy(info->vendor, session->vendor, sizeof info->vendor);
  memcpy(info->model, session->model, sizeof info->model);
  memcpy(info->serial, session->serial, sizeof info->serial);
  memcpy(info->firmware, session->firmware, sizeof info->firmware);
  memcpy(info->eye, session->eye, sizeof info->eye);
  info->axis_z_mm = session->axis_z_mm;
  info->axis_z_sigma_mm = session->axis_z_sigma_mm;
  const int length =
      snprintf(info->instrument_path, sizeof info->instrument_path, "%s", instrument);
  if (length < 0 || (size_t)length >= sizeof info->instrument_path) {
    return placido_error_set(err, PLACIDO_INPUT, "the path ...%s is too long",
                             placido_text_tail(instrument));
  }
  return PLACIDO_OK;
}

int placido_replay_source_open(placido_replay_source *source, placido_device_info *info,
                               const char *path, placido_notes *notes, placido_error *err) {
  struct stat found;
  memcpy(source->uri, info->uri, sizeof source->uri);
  source->rate_hz = info->axis_z_mm = info->axis_z_sigma_mm = NAN;
  if (stat(path, &found) != 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot open %s: %s", placido_text_tail(path),
                             strerror(errno));
  }
  if (!S_ISDIR(found.st_mode)) {
    return placido_frame_load(&source->frame, path, err);
  }
  const int status = placido_session_reader_open(&source->session, path, notes, err);
  if (status) {
    return status;
  }
  source->rate_hz = placido_session_reader_info(source->session)->rate_hz;
  return describe_session(source, info, err);
}

void placido_replay_source_close(placido_replay_source *source) {
  placido_session_reader_close(source->session);
  placido_frame_free(&source->frame);
}

static int begin_round(placido_replay_source *source, placido_error *err) {
  int status = PLACIDO_OK;
  if (source->session && source->is_moved) {
    status = placido_session_reader_rewind(source->session, err);
  }
  source->is_moved = false;
  source->round_count = 0;
  return status;
}

int placido_replay_source_rewind(placido_replay_source *source, placido_error *err) {
  source->frame_count = source->damaged_count = source->shift_t_ns = source->shift_seq = 0;
  source->joins = false;
  return begin_round(source, err);
}

/* The next frame of this round, as it was recorded. */
static int read_frame(placido_replay_source *source, placido_error *err) {
  if (!source->session) {
    const bool first = !source->is_moved;
    source->is_moved = true;
    return first ? PLACIDO_OK
                 : placido_error_set(err, PLACIDO_END, "%s is a single image", source->uri);
  }
  source->is_moved = true;
  const int status = placido_session_reader_next(source->session, &source->frame, err);
  source->damaged_count += status == PLACIDO_INPUT;
  if (status == PLACIDO_END && source->damaged_count > 0) {
    placido_error_set(err, PLACIDO_END, "%s has no further frame (%lld were damaged)",
                      placido_text_tail(source->uri), (long long)source->damaged_count);
  }
  return status;
}

/* Time and counter of the frame just read go on from the last one, into a further round too. */
static void carry_on(placido_replay_source *source) {
  placido_frame *frame = &source->frame;
  if (source->joins) {
    const int64_t step_ns = source->rate_hz > 0 ? llround(1e9 / source->rate_hz) : 1;
    source->joins = false;
    source->shift_t_ns = source->last_t_ns + step_ns - frame->t_ns;
    source->shift_seq = (int64_t)(source->last_seq + 1 - frame->seq);
  }
  frame->t_ns += source->shift_t_ns;
  frame->seq += (uint64_t)source->shift_seq;
  source->last_t_ns = frame->t_ns;
  source->last_seq = frame->seq;
}

int placido_replay_source_next(placido_replay_source *source, bool loops, placido_error *err) {
  int status = read_frame(source, err);
  if (status == PLACIDO_END && loops && source->round_count > 0) {
    source->joins = true;
    status = begin_round(source, err);
    status = status ? status : read_frame(source, err);
  }
  source->frame_count += status == PLACIDO_OK || status == PLACIDO_INPUT;
  if (status) {
    return status;
  }
  source->round_count++;
  if (source->session) {
    carry_on(source);
  }
  return PLACIDO_OK;
}
