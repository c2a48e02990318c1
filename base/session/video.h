/* frames.mkv: grey frames, losslessly, in Matroska. What is known of FFmpeg ends behind this
 * header. */
#ifndef PLACIDO_BASE_SESSION_VIDEO_H
#define PLACIDO_BASE_SESSION_VIDEO_H

#include <placido/frame.h>
#include <placido/session.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct placido_video_reader placido_video_reader;
typedef struct placido_video_writer placido_video_writer;

/* Opens a file of grey frames in a codec without loss. PLACIDO_SYSTEM, PLACIDO_INPUT (no video, or
 * another one), PLACIDO_UNSUPPORTED (no decoder), PLACIDO_MEMORY. */
int placido_video_reader_open(placido_video_reader **video, const char *path, placido_error *err);
/* Nominal frame rate, NaN where the file does not tell. */
double placido_video_reader_rate_hz(const placido_video_reader *video);
enum placido_session_codec placido_video_reader_codec(const placido_video_reader *video);
/* FFmpeg's name of the codec; a constant. */
const char *placido_video_reader_codec_name(const placido_video_reader *video);
/* Whether the frames carry checksums of their own; to be asked after the first of them. */
bool placido_video_reader_has_checksums(const placido_video_reader *video);
/* Format and significant bits of the samples, to be asked before the first frame is taken; false
 * where that frame is missing or damaged. */
bool placido_video_reader_format(const placido_video_reader *video, enum placido_format *format,
                                 int *bits);
/* Decodes the next frame; sets `*index` (counted from 0, frames that cannot be decoded included)
 * and frame->t_ns (from the stream, to a millisecond). Bits are those of the file's samples.
 * PLACIDO_END, PLACIDO_INPUT (this frame cannot be decoded; the next call goes on behind it). */
int placido_video_reader_next(placido_video_reader *video, placido_frame *frame, int64_t *index,
                              placido_error *err);
/* Passes over the next frame without decoding it. PLACIDO_END behind the last. */
int placido_video_reader_skip(placido_video_reader *video, placido_error *err);
void placido_video_reader_close(placido_video_reader *video);

typedef struct placido_video_options {
  enum placido_session_codec codec;
  int bits;          /* 10 and 12: sample formats of that depth where the codec has them; 0: gray8
                        or gray16le, which is what a session holds */
  double rate_hz;    /* nominal; NaN: not known */
  int64_t origin_ns; /* the time that is the stream's zero */
} placido_video_options;

/* Starts a file for frames of the first one's size and format. */
int placido_video_writer_open(placido_video_writer **video, const char *path,
                              const placido_video_options *options, const placido_frame *first,
                              placido_error *err);
/* Appends a frame of the first one's size and format. */
int placido_video_writer_append(placido_video_writer *video, const placido_frame *frame,
                                placido_error *err);
/* Puts what was appended on the disk. */
int placido_video_writer_sync(placido_video_writer *video, placido_error *err);
/* Ends the file; the writer is gone whatever the status. Legal on NULL. */
int placido_video_writer_close(placido_video_writer *video, placido_error *err);

/* The status for an FFmpeg error code, with the text "WHAT PATH: FFmpeg's reason". */
int placido_video_refuse(int code, const char *what, const char *path, placido_error *err);

/* FFmpeg's logging is process-wide, and prints to stderr; a library of ours never prints. */
void placido_video_silence(void);

/* "file:PATH" in new memory: FFmpeg would take what stands before a colon for a protocol. */
char *placido_video_url(const char *path, placido_error *err);

#endif
