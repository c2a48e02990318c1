/* The encoder of frames.mkv: FFV1 version 3 with slice checksums (RFC 9043), FFVHUFF, or none. */
#include "base/session/video_encoder.h"

#include "base/session/pixels.h"

#include <libavutil/opt.h>
#include <stdbool.h>

#define RATE_DENOMINATOR_MAX 1000000

/* How many slices, which is how many threads, a frame is cut into: by its size, not by the machine,
 * so that files are the same everywhere. */
static int slices_of(const placido_frame *frame) {
  bool wide = frame->width_px > frame->height_px;
  int short_px = wide ? frame->height_px : frame->width_px;
  int long_px = wide ? frame->width_px : frame->height_px;
  if (short_px < 16 && long_px <= 256) {
    return 1; /* libavcodec wants four where a side is over 288 */
  }
  return short_px >= 256 ? 16 : 4;
}

static int set_ffv1(AVCodecContext *encoder, const placido_frame *first) {
  encoder->level = 3;
  encoder->slices = slices_of(first);
  encoder->thread_type = FF_THREAD_SLICE;
  encoder->thread_count = 0;
  return av_opt_set_int(encoder->priv_data, "slicecrc", 1, 0);
}

/* Huffman tables of each frame's own make noisy pictures of 8 bit a seventh smaller than fixed ones,
 * in the same time. The tables of 16 bit are so large that it takes twice as long. */
static int set_ffvhuff(AVCodecContext *encoder, const placido_frame *first) {
  return av_opt_set_int(encoder->priv_data, "context", first->format == PLACIDO_MONO8, 0);
}

static int set_nothing(AVCodecContext *encoder, const placido_frame *first) {
  (void)encoder;
  (void)first;
  return 0;
}

static int (*const setters[])(AVCodecContext *, const placido_frame *) = {
    [PLACIDO_CODEC_FFV1] = set_ffv1,
    [PLACIDO_CODEC_FFVHUFF] = set_ffvhuff,
    [PLACIDO_CODEC_RAW] = set_nothing,
};

static bool takes(const AVCodec *codec, enum AVPixelFormat pixels) {
  const enum AVPixelFormat *one = codec->pix_fmts;
  while (one && *one != AV_PIX_FMT_NONE && *one != pixels) {
    one++;
  }
  return !one || *one == pixels;
}

static enum AVPixelFormat choose_pixels(const AVCodec *codec, int bits,
                                        const placido_frame *first) {
  const placido_pixels *exact = placido_pixels_of_bits(bits);
  if (exact && exact->format == first->format && takes(codec, exact->pixels)) {
    return exact->pixels;
  }
  return first->format == PLACIDO_MONO16 ? AV_PIX_FMT_GRAY16 : AV_PIX_FMT_GRAY8;
}

int placido_video_encoder_open(AVCodecContext **encoder, const placido_video_options *options,
                               const placido_frame *first, const char *path, placido_error *err) {
  *encoder = NULL;
  const AVCodec *codec = avcodec_find_encoder(placido_codec_id(options->codec));
  if (!codec) {
    return placido_video_refuse(AVERROR_ENCODER_NOT_FOUND, "cannot encode", path, err);
  }
  AVCodecContext *opened = avcodec_alloc_context3(codec);
  if (!opened) {
    return placido_video_refuse(AVERROR(ENOMEM), "encoding", path, err);
  }
  opened->width = first->width_px;
  opened->height = first->height_px;
  opened->pix_fmt = choose_pixels(codec, options->bits, first);
  opened->time_base = (AVRational){1, PLACIDO_VIDEO_TICKS_PER_S};
  if (options->rate_hz > 0) {
    opened->framerate = av_d2q(options->rate_hz, RATE_DENOMINATOR_MAX);
  }
  opened->gop_size = 1;
  opened->thread_count = 1; /* threads by frames would add a delay */
  opened->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  int code = setters[options->codec](opened, first);
  if (code >= 0) {
    code = avcodec_open2(opened, codec, NULL);
  }
  if (code < 0) {
    avcodec_free_context(&opened);
    return placido_video_refuse(code, "cannot encode", path, err);
  }
  *encoder = opened;
  return PLACIDO_OK;
}
