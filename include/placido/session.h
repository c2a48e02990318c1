/* A recorded examination on disk: a directory NAME.session with session.json, instrument.json,
 * frames.mkv, frames.jsonl and events.jsonl (docs/formats.md). */
#ifndef PLACIDO_SESSION_H
#define PLACIDO_SESSION_H

#include <placido/frame.h>
#include <placido/notes.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stdint.h>

/* How frames.mkv is coded, always without loss. What is recorded in another codec than FFV1 is made
 * FFV1 afterwards by `placido session pack`. */
enum placido_session_codec {
  PLACIDO_CODEC_FFV1,    /* for keeping: small, version 3 with a checksum a slice */
  PLACIDO_CODEC_FFVHUFF, /* for recording faster than FFV1 can follow */
  PLACIDO_CODEC_RAW,     /* uncompressed: the fastest where the disk is */
  PLACIDO_CODEC_OTHER,   /* read only: another lossless codec of FFmpeg's */
};

/* "ffv1", "ffvhuff", "raw" or "other"; a constant. */
const char *placido_session_codec_name(enum placido_session_codec codec);

/* session.json as an open struct; empty strings and NaN mean "not recorded". */
typedef struct placido_session_info {
  char created[32];  /* ISO 8601, UTC */
  char eye[8];       /* OD or OS */
  char subject[64];  /* an opaque id; never a name or birth date */
  char driver[64], vendor[64], model[64], serial[64], firmware[64];
  enum placido_format format;
  int bits;
  double rate_hz;            /* nominal */
  double axis_z_mm;          /* z of the cornea on the instrument's axis, NaN where not measured */
  double axis_z_sigma_mm;    /* its standard deviation, NaN where not given */
  char software[64];
  enum placido_session_codec codec; /* of frames.mkv, which alone holds it */
} placido_session_info;

/* One line of frames.jsonl; NaN where not recorded. */
typedef struct placido_frame_info {
  int64_t index;
  int64_t t_ns;
  uint64_t seq;
  double exposure_us, gain_db;
  uint32_t flags;
  bool has_crc32;
  uint32_t crc32; /* of the samples: rows without padding, 16-bit samples little-endian */
} placido_frame_info;

typedef struct placido_session_reader placido_session_reader;
typedef struct placido_session_writer placido_session_writer;

/* Opens a session directory for reading, frames in recorded order. A missing frames.jsonl is
 * legal. A torn frames.mkv opens with the frames that are whole. Close with
 * placido_session_reader_close. Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT,
 * PLACIDO_MEMORY, PLACIDO_UNSUPPORTED (codec not in the build). */
int placido_session_reader_open(placido_session_reader **reader, const char *path,
                                placido_notes *notes, placido_error *err);

/* session.json; borrowed until the reader is closed. */
const placido_session_info *placido_session_reader_info(const placido_session_reader *reader);

/* The path of the session's instrument.json; borrowed until the reader is closed. */
const char *placido_session_reader_instrument(const placido_session_reader *reader);

/* Decodes the next frame into `frame`. A frame without a line in frames.jsonl counts its time and
 * sequence on from the last one that has one. Returns PLACIDO_OK, PLACIDO_END after the last one,
 * PLACIDO_INPUT (a frame that cannot be decoded, is missing, or is not the one whose checksum is in
 * frames.jsonl; the next call goes on behind it), PLACIDO_MEMORY. */
int placido_session_reader_next(placido_session_reader *reader, placido_frame *frame,
                                placido_error *err);

/* What is known of the frame that placido_session_reader_next gave or refused last. */
placido_frame_info placido_session_reader_frame_info(const placido_session_reader *reader);

/* Back to the first frame. */
int placido_session_reader_rewind(placido_session_reader *reader, placido_error *err);

void placido_session_reader_close(placido_session_reader *reader);

/* Creates a session directory (which must not exist) and copies the instrument file into it.
 * info->codec says how frames are stored; zero is FFV1. What was appended survives a crash or a
 * power cut but for the last second. Appending writes to the disk twice a second, and waits for it:
 * whoever must not wait appends from a thread of its own. Close with placido_session_writer_close.
 * Returns PLACIDO_OK, PLACIDO_SYSTEM, PLACIDO_INPUT, PLACIDO_MEMORY. */
int placido_session_writer_create(placido_session_writer **writer, const char *path,
                                  const placido_session_info *info, const char *instrument_path,
                                  placido_error *err);

/* Appends a MONO8 or MONO16 frame; all frames of a session have one size and format. `exposure`
 * and gain come from `frame_info` (may be NULL: not recorded). */
int placido_session_writer_append(placido_session_writer *writer, const placido_frame *frame,
                                  const placido_frame_info *frame_info, placido_error *err);

/* Appends a line to events.jsonl: {"t_ns":..., "event": name, "text": ...}. `text` may be NULL. */
int placido_session_writer_event(placido_session_writer *writer, int64_t t_ns, const char *name,
                                 const char *text, placido_error *err);

/* Finishes the files. The writer is gone afterwards whatever the status. */
int placido_session_writer_close(placido_session_writer *writer, placido_error *err);

#endif
