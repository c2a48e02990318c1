/* FFmpeg's names of what a session stores: pixel formats and codecs. */
#ifndef PLACIDO_BASE_SESSION_PIXELS_H
#define PLACIDO_BASE_SESSION_PIXELS_H

#include <libavcodec/codec_id.h>
#include <libavutil/pixfmt.h>
#include <placido/frame.h>
#include <placido/session.h>

/* A grey pixel format and what it is to us; 10 to 16 bit stand right-aligned in two bytes. */
typedef struct placido_pixels {
  enum AVPixelFormat pixels;
  enum placido_format format;
  int bits;
} placido_pixels;

/* NULL where the format is not grey. */
const placido_pixels *placido_pixels_find(enum AVPixelFormat pixels);
/* NULL where there is none of that depth. */
const placido_pixels *placido_pixels_of_bits(int bits);

enum placido_session_codec placido_codec_of(enum AVCodecID id);
/* AV_CODEC_ID_NONE where sessions are not written in it. */
enum AVCodecID placido_codec_id(enum placido_session_codec codec);

#endif
