/* Motion-JPEG pictures to luma by libavcodec, which knows the tables that cameras leave out. Y' is
 * taken from the picture as it is: no way over red, green and blue. */
#include "drivers/v4l2/mjpeg.h"

#include "base/memory.h"

#include <libavcodec/avcodec.h>
#include <libavutil/pixdesc.h>
#include <string.h>

/* Added to the level of every message of the decoder, which then is below any that is printed. More
 * than 8 bits would be cut off. */
#define UNHEARD 100

struct placido_v4l2_mjpeg {
  AVCodecContext *context;
  AVPacket *packet;
  AVFrame *picture;
  int width_px, height_px;
};

bool placido_v4l2_is_readable(const placido_v4l2_format *format) {
  return format->unpack != NULL || format->group_px == 0;
}

void placido_v4l2_mjpeg_free(placido_v4l2_mjpeg *decoder) {
  if (!decoder) {
    return;
  }
  avcodec_free_context(&decoder->context);
  av_packet_free(&decoder->packet);
  av_frame_free(&decoder->picture);
  placido_memory_free(decoder);
}

int placido_v4l2_mjpeg_new(placido_v4l2_mjpeg **out, int width_px, int height_px,
                           placido_error *err) {
  *out = NULL;
  const AVCodec *codec = avcodec_find_decoder(AV_CODEC_ID_MJPEG);
  if (!codec) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "this FFmpeg has no Motion-JPEG decoder");
  }
  placido_v4l2_mjpeg *decoder = placido_memory_new(1, sizeof *decoder, err);
  if (!decoder) {
    return PLACIDO_MEMORY;
  }
  decoder->width_px = width_px;
  decoder->height_px = height_px;
  decoder->context = avcodec_alloc_context3(codec);
  decoder->packet = av_packet_alloc();
  decoder->picture = av_frame_alloc();
  if (!decoder->context || !decoder->packet || !decoder->picture) {
    goto fail;
  }
  decoder->context->log_level_offset = UNHEARD;
  decoder->context->thread_count = 1; /* threads by frames would add a delay */
  decoder->context->err_recognition = AV_EF_CAREFUL | AV_EF_EXPLODE;
  /* Blocks of 32 x 16 pixels at most; a picture that claims more is not of this camera. */
  decoder->context->max_pixels = ((int64_t)width_px + 31) * ((int64_t)height_px + 31);
  if (avcodec_open2(decoder->context, codec, NULL) < 0) {
    goto fail;
  }
  *out = decoder;
  return PLACIDO_OK;
fail:
  placido_v4l2_mjpeg_free(decoder);
  return placido_error_set(err, PLACIDO_MEMORY, "no memory for the Motion-JPEG decoder");
}

/* Whether the first plane is luma, a byte for each pixel. */
static bool has_luma(const AVFrame *picture) {
  const AVPixFmtDescriptor *pixels = av_pix_fmt_desc_get(picture->format);
  return pixels && !(pixels->flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) &&
         pixels->comp[0].plane == 0 && pixels->comp[0].depth == 8 && pixels->comp[0].step == 1 &&
         picture->linesize[0] >= picture->width;
}

static int copy_luma(placido_v4l2_mjpeg *decoder, placido_frame *frame, placido_error *err) {
  const AVFrame *picture = decoder->picture;
  if (picture->width != decoder->width_px || picture->height != decoder->height_px ||
      !has_luma(picture)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "the camera's JPEG is not a picture of %d x %d pixels with luma",
                             decoder->width_px, decoder->height_px);
  }
  const int status =
      placido_frame_resize(frame, decoder->width_px, decoder->height_px, PLACIDO_MONO8, err);
  for (int y = 0; !status && y < frame->height_px; y++) {
    memcpy(frame->data + (size_t)y * frame->stride_bytes,
           picture->data[0] + (ptrdiff_t)y * picture->linesize[0], (size_t)frame->width_px);
  }
  frame->flags = picture->decode_error_flags ? PLACIDO_FRAME_CORRUPT : 0;
  return status;
}

int placido_v4l2_mjpeg_decode(placido_v4l2_mjpeg *decoder, placido_frame *frame,
                              const uint8_t *bytes, size_t size, placido_error *err) {
  /* The decoder reads beyond its end, so it gets a padded copy. */
  if (size > INT32_MAX / 2 || av_new_packet(decoder->packet, (int)size) < 0) {
    return placido_error_set(err, PLACIDO_MEMORY, "no memory for a JPEG of %zu bytes", size);
  }
  memcpy(decoder->packet->data, bytes, size);
  int code = avcodec_send_packet(decoder->context, decoder->packet);
  code = code < 0 ? code : avcodec_receive_frame(decoder->context, decoder->picture);
  av_packet_unref(decoder->packet);
  if (code < 0) {
    avcodec_flush_buffers(decoder->context);
    return placido_error_set(err, PLACIDO_INPUT, "a JPEG of the camera (%zu bytes) is damaged",
                             size);
  }
  const int status = copy_luma(decoder, frame, err);
  av_frame_unref(decoder->picture);
  return status;
}
