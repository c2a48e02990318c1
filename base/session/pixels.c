/* FFmpeg's names of what a session stores. */
#include "base/session/pixels.h"

#include <stddef.h>

static const placido_pixels greys[] = {
    {AV_PIX_FMT_GRAY8, PLACIDO_MONO8, 8},    {AV_PIX_FMT_GRAY10, PLACIDO_MONO16, 10},
    {AV_PIX_FMT_GRAY12, PLACIDO_MONO16, 12}, {AV_PIX_FMT_GRAY14, PLACIDO_MONO16, 14},
    {AV_PIX_FMT_GRAY16, PLACIDO_MONO16, 16},
};
static const size_t grey_count = sizeof greys / sizeof *greys;

static const struct {
  enum placido_session_codec codec;
  enum AVCodecID id;
} codecs[] = {
    {PLACIDO_CODEC_FFV1, AV_CODEC_ID_FFV1},
    {PLACIDO_CODEC_FFVHUFF, AV_CODEC_ID_FFVHUFF},
    {PLACIDO_CODEC_RAW, AV_CODEC_ID_RAWVIDEO},
};
static const size_t codec_count = sizeof codecs / sizeof *codecs;

const placido_pixels *placido_pixels_find(enum AVPixelFormat pixels) {
  for (size_t i = 0; i < grey_count; i++) {
    if (greys[i].pixels == pixels) {
      return &greys[i];
    }
  }
  return NULL;
}

const placido_pixels *placido_pixels_of_bits(int bits) {
  for (size_t i = 0; i < grey_count; i++) {
    if (greys[i].bits == bits) {
      return &greys[i];
    }
  }
  return NULL;
}

enum placido_session_codec placido_codec_of(enum AVCodecID id) {
  for (size_t i = 0; i < codec_count; i++) {
    if (codecs[i].id == id) {
      return codecs[i].codec;
    }
  }
  return PLACIDO_CODEC_OTHER;
}

enum AVCodecID placido_codec_id(enum placido_session_codec codec) {
  for (size_t i = 0; i < codec_count; i++) {
    if (codecs[i].codec == codec) {
      return codecs[i].id;
    }
  }
  return AV_CODEC_ID_NONE;
}
