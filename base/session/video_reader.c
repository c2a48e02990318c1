/* Reads frames.mkv: Matroska by libavformat, any lossless grey codec that libavcodec decodes. */
#include "base/session/video.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/session/ffv1.h"
#include "base/session/pixels.h"
#include "base/text.h"

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#define HEAD_BYTES ((size_t)1 << 20)
#define TIME_MAX_NS (INT64_MAX / 16) /* 18 years: a stream that says more says nothing */

struct placido_video_reader {
  AVFormatContext *container;
  AVCodecContext *decoder;
  AVPacket *packet;
  AVFrame *picture;
  int stream;
  int64_t next_index;
  int64_t time; /* of the picture, in the stream's unit */
  /* The first frame is decoded at once: before it, FFV1 does not tell the pixels' format. */
  bool is_first;
  int first_status;
  placido_error first_error;
  bool has_checksums; /* an FFV1 slice of this file had a right one */
  char *path;
};

static int refuse_pixels(const placido_video_reader *video, enum AVPixelFormat pixels,
                         placido_error *err) {
  const char *name = av_get_pix_fmt_name(pixels);
  return placido_error_set(err, PLACIDO_UNSUPPORTED,
                           "%s has %s pixels, gray of 8 to 16 bit is expected",
                           placido_text_tail(video->path), name ? name : "unknown");
}

/* The demuxer calls a head that ends too early an input/output error, and frees what could tell a
 * torn file from a broken disk: the file is read once more to know. */
static int refuse_head(const char *path, placido_error *err) {
  char *bytes;
  size_t size;
  int status = placido_file_read(&bytes, &size, path, HEAD_BYTES, err);
  placido_memory_free(bytes);
  if (status == PLACIDO_OK || status == PLACIDO_INPUT) { /* INPUT: longer than the head */
    status = placido_error_set(err, PLACIDO_INPUT,
                               "%s is torn or damaged in its head: no frame can be read",
                               placido_text_tail(path));
  }
  return status;
}

/* Only the Matroska demuxer: others follow references to further files. */
static int open_container(placido_video_reader *video, placido_error *err) {
  char *url = placido_video_url(video->path, err);
  if (!url) {
    return PLACIDO_MEMORY;
  }
  int code = avformat_open_input(&video->container, url, av_find_input_format("matroska"), NULL);
  placido_memory_free(url);
  if (code == AVERROR(EIO) || code == AVERROR_EOF || code == AVERROR_INVALIDDATA) {
    return refuse_head(video->path, err);
  }
  if (code < 0) {
    return placido_video_refuse(code, "cannot read", video->path, err);
  }
  video->stream =
      av_find_best_stream(video->container, AVMEDIA_TYPE_VIDEO, -1, -1, NULL, 0);
  if (video->stream < 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s has no video in it",
                             placido_text_tail(video->path));
  }
  return PLACIDO_OK;
}

/* A codec with a delay gives frames later than their packets; no lossless still codec has one, and
 * without it a frame's number is its packet's. */
static int check_codec(const placido_video_reader *video, const AVCodec *codec,
                       const AVCodecParameters *parameters, placido_error *err) {
  const AVCodecDescriptor *descriptor = avcodec_descriptor_get(parameters->codec_id);
  const char *name = descriptor ? descriptor->name : "unknown";
  if (!codec) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "%s: no decoder for its codec %s",
                             placido_text_tail(video->path), name);
  }
  if (!descriptor || !(descriptor->props & AV_CODEC_PROP_LOSSLESS) ||
      (codec->capabilities & AV_CODEC_CAP_DELAY)) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "%s: codec %s is not one for lossless frames (FFV1, FFVHUFF or raw is "
                             "expected)",
                             placido_text_tail(video->path), name);
  }
  return PLACIDO_OK;
}

static int open_decoder(placido_video_reader *video, placido_error *err) {
  const AVCodecParameters *parameters = video->container->streams[video->stream]->codecpar;
  const AVCodec *codec = avcodec_find_decoder(parameters->codec_id);
  int status = check_codec(video, codec, parameters, err);
  if (status) {
    return status;
  }
  video->decoder = avcodec_alloc_context3(codec);
  video->packet = av_packet_alloc();
  video->picture = av_frame_alloc();
  int code = AVERROR(ENOMEM);
  if (video->decoder && video->packet && video->picture) {
    code = avcodec_parameters_to_context(video->decoder, parameters);
  }
  if (code >= 0) {
    video->decoder->thread_type = FF_THREAD_SLICE; /* threads by frames would add a delay */
    video->decoder->thread_count = 0;
    video->decoder->err_recognition = AV_EF_CRCCHECK | AV_EF_EXPLODE;
    code = avcodec_open2(video->decoder, codec, NULL);
  }
  return code < 0 ? placido_video_refuse(code, "cannot decode", video->path, err) : PLACIDO_OK;
}

/* The next packet of the stream: PLACIDO_END at the file's end and where the file is torn, which
 * the demuxer reports as one of several errors. */
static int read_packet(placido_video_reader *video, placido_error *err) {
  for (;;) {
    int code = av_read_frame(video->container, video->packet);
    if (code == AVERROR(ENOMEM)) {
      return placido_video_refuse(code, "reading", video->path, err);
    }
    if (code < 0 && video->container->pb->error < 0 && video->container->pb->error != AVERROR_EOF) {
      return placido_video_refuse(video->container->pb->error, "reading", video->path, err);
    }
    if (code < 0) {
      return placido_error_set(err, PLACIDO_END, "%s has no further frame",
                               placido_text_tail(video->path));
    }
    if (video->packet->stream_index == video->stream) {
      return PLACIDO_OK;
    }
    av_packet_unref(video->packet);
  }
}

/* The packet's picture, or FFmpeg's error. The FFV1 decoder covers damaged slices with what it has
 * and says nothing, so their checksums are looked at here. */
static int decode(placido_video_reader *video) {
  const AVPacket *packet = video->packet;
  if (video->decoder->codec_id == AV_CODEC_ID_FFV1 && packet->size > 0 &&
      !placido_ffv1_check(packet->data, (size_t)packet->size, &video->has_checksums)) {
    return AVERROR_INVALIDDATA;
  }
  int code = avcodec_send_packet(video->decoder, packet);
  return code < 0 ? code : avcodec_receive_frame(video->decoder, video->picture);
}

/* Reads and decodes the next frame into `picture`. */
static int advance(placido_video_reader *video, placido_error *err) {
  int status = read_packet(video, err);
  if (status) {
    return status;
  }
  video->time = video->packet->pts;
  int code = decode(video);
  av_packet_unref(video->packet);
  if (code == AVERROR(ENOMEM)) {
    return placido_video_refuse(code, "decoding", video->path, err);
  }
  if (code < 0) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: frame %lld is damaged",
                             placido_text_tail(video->path), (long long)video->next_index);
  }
  return placido_pixels_find(video->picture->format) ? PLACIDO_OK
                                           : refuse_pixels(video, video->picture->format, err);
}

int placido_video_reader_open(placido_video_reader **video, const char *path,
                              placido_error *err) {
  *video = NULL;
  placido_video_silence();
  placido_video_reader *opened = placido_memory_new(1, sizeof *opened, err);
  if (!opened) {
    return PLACIDO_MEMORY;
  }
  opened->path = placido_memory_string(path, err);
  int status = opened->path ? open_container(opened, err) : PLACIDO_MEMORY;
  if (!status) {
    status = open_decoder(opened, err);
  }
  if (!status) {
    opened->is_first = true;
    opened->first_status = advance(opened, &opened->first_error);
    if (opened->first_status && opened->first_status != PLACIDO_END &&
        opened->first_status != PLACIDO_INPUT) {
      status = placido_error_set(err, opened->first_status, "%s", opened->first_error.text);
    }
  }
  if (status) {
    placido_video_reader_close(opened);
    return status;
  }
  *video = opened;
  return PLACIDO_OK;
}

double placido_video_reader_rate_hz(const placido_video_reader *video) {
  AVRational rate = video->container->streams[video->stream]->avg_frame_rate;
  return rate.num > 0 && rate.den > 0 ? av_q2d(rate) : NAN;
}

enum placido_session_codec placido_video_reader_codec(const placido_video_reader *video) {
  return placido_codec_of(video->decoder->codec_id);
}

const char *placido_video_reader_codec_name(const placido_video_reader *video) {
  return avcodec_get_name(video->decoder->codec_id);
}

bool placido_video_reader_has_checksums(const placido_video_reader *video) {
  return video->has_checksums;
}

bool placido_video_reader_format(const placido_video_reader *video, enum placido_format *format,
                                 int *bits) {
  const placido_pixels *grey = video->is_first ? placido_pixels_find(video->picture->format) : NULL;
  if (grey) {
    *format = grey->format;
    *bits = grey->bits;
  }
  return grey != NULL;
}

/* Copies the picture's rows. */
static int take_picture(const placido_video_reader *video, placido_frame *frame,
                        placido_error *err) {
  const AVFrame *picture = video->picture;
  const placido_pixels *grey = placido_pixels_find(picture->format);
  int status = placido_frame_resize(frame, picture->width, picture->height, grey->format, err);
  if (status) {
    return status;
  }
  frame->bits = grey->bits;
  for (int y = 0; y < picture->height; y++) {
    memcpy(frame->data + (size_t)y * frame->stride_bytes,
           picture->data[0] + (ptrdiff_t)y * picture->linesize[0], frame->stride_bytes);
  }
  const AVRational unit = video->container->streams[video->stream]->time_base;
  const int64_t t_ns = av_rescale_q(video->time, unit, (AVRational){1, 1000000000});
  const bool is_known =
      video->time != AV_NOPTS_VALUE && t_ns >= -TIME_MAX_NS && t_ns <= TIME_MAX_NS;
  frame->t_ns = is_known ? t_ns : 0;
  return PLACIDO_OK;
}

int placido_video_reader_next(placido_video_reader *video, placido_frame *frame, int64_t *index,
                              placido_error *err) {
  *index = video->next_index;
  int status;
  if (video->is_first) {
    video->is_first = false;
    status = video->first_status;
    if (status) {
      placido_error_set(err, status, "%s", video->first_error.text);
    }
  } else {
    status = advance(video, err);
  }
  if (status != PLACIDO_END) {
    video->next_index++;
  }
  if (!status) {
    status = take_picture(video, frame, err);
  }
  av_frame_unref(video->picture);
  return status;
}

int placido_video_reader_skip(placido_video_reader *video, placido_error *err) {
  int status = video->is_first && video->first_status == PLACIDO_END ? PLACIDO_END : PLACIDO_OK;
  if (!video->is_first) {
    status = read_packet(video, err);
  }
  video->is_first = false;
  av_packet_unref(video->packet);
  av_frame_unref(video->picture);
  video->next_index += status == PLACIDO_OK;
  return status;
}

void placido_video_reader_close(placido_video_reader *video) {
  if (!video) {
    return;
  }
  av_frame_free(&video->picture);
  av_packet_free(&video->packet);
  avcodec_free_context(&video->decoder);
  avformat_close_input(&video->container);
  placido_memory_free(video->path);
  placido_memory_free(video);
}
