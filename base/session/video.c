/* What reading and writing of frames.mkv have in common: FFmpeg's errors, messages and names. */
#include "base/session/video.h"

#include "base/memory.h"
#include "base/text.h"

#include <libavutil/error.h>
#include <libavutil/log.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

/* FFmpeg's own codes are four letters each and lie far below the negated numbers of errno, which
 * the kernel keeps under this one. EINVAL alone says that the file makes no sense. */
#define ERRNO_END 4096

int placido_video_refuse(int code, const char *what, const char *path, placido_error *err) {
  char reason[AV_ERROR_MAX_STRING_SIZE] = "";
  av_strerror(code, reason, sizeof reason);
  int status = PLACIDO_INPUT;
  if (code == AVERROR(ENOMEM)) {
    status = PLACIDO_MEMORY;
  } else if (code == AVERROR_DECODER_NOT_FOUND || code == AVERROR_ENCODER_NOT_FOUND ||
             code == AVERROR_MUXER_NOT_FOUND || code == AVERROR_DEMUXER_NOT_FOUND) {
    status = PLACIDO_UNSUPPORTED;
  } else if (code > -ERRNO_END && code != AVERROR(EINVAL)) {
    status = PLACIDO_SYSTEM;
  }
  return placido_error_set(err, status, "%s %s: %s", what, placido_text_tail(path), reason);
}

void placido_video_silence(void) {
  av_log_set_level(AV_LOG_QUIET);
}

char *placido_video_url(const char *path, placido_error *err) {
  static const char protocol[] = "file:";
  size_t size = sizeof protocol + strlen(path);
  char *url = placido_memory_new(size, 1, err);
  if (url) {
    snprintf(url, size, "%s%s", protocol, path);
  }
  return url;
}
