/* The encoder of frames.mkv. */
#ifndef PLACIDO_BASE_SESSION_VIDEO_ENCODER_H
#define PLACIDO_BASE_SESSION_VIDEO_ENCODER_H

#include "base/session/video.h"

#include <libavcodec/avcodec.h>

/* Stream times are whole milliseconds: Matroska by libavformat has no finer ones. The exact times
 * are in frames.jsonl. */
#define PLACIDO_VIDEO_TICKS_PER_S 1000

/* Opens an encoder without loss and without a delay, in which every frame is a key frame, so that
 * each can be decoded whatever came before it. Free with avcodec_free_context. `path` is for
 * messages. PLACIDO_UNSUPPORTED (not in this FFmpeg), PLACIDO_INPUT, PLACIDO_MEMORY. */
int placido_video_encoder_open(AVCodecContext **encoder, const placido_video_options *options,
                               const placido_frame *first, const char *path, placido_error *err);

#endif
