/* Writes frames.mkv: FFV1 version 3 with slice checksums (RFC 9043) in Matroska (RFC 9559), in
 * clusters short enough that a crash costs at most the last second. */
#include "base/session/video.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <math.h>
#include <stdbool.h>
#include <unistd.h>

/* A cluster reaches the file when it ends; the session's writer puts it on the disk twice a
 * second. */
#define CLUSTER_MS 500
#define SIDE_MIN_PX 4
/* Matroska by libavformat counts in milliseconds; the exact times are in frames.jsonl. */
#define TICKS_PER_S 1000
#define NS_PER_TICK (1000000000LL / TICKS_PER_S)

struct placido_video_writer {
  AVFormatContext *container;
  AVCodecContext *encoder;
  AVPacket *packet;
  AVFrame *picture;
  char *path;
  int descriptor; /* of the same file, for fdatasync; -1 where there is none */
  int64_t first_t_ns, last_tick, frame_ticks;
  bool header_written;
};

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

/* All frames are key frames, so that each can be decoded whatever came before it. */
static int open_encoder(placido_video_writer *video, const placido_frame *first, double rate_hz,
                        placido_error *err) {
  const AVCodec *codec = avcodec_find_encoder(AV_CODEC_ID_FFV1);
  if (!codec) {
    return placido_video_refuse(AVERROR_ENCODER_NOT_FOUND, "FFV1 for", video->path, err);
  }
  AVCodecContext *encoder = video->encoder = avcodec_alloc_context3(codec);
  if (!encoder) {
    return placido_video_refuse(AVERROR(ENOMEM), "encoding", video->path, err);
  }
  encoder->width = first->width_px;
  encoder->height = first->height_px;
  encoder->pix_fmt = first->format == PLACIDO_MONO16 ? AV_PIX_FMT_GRAY16 : AV_PIX_FMT_GRAY8;
  encoder->time_base = (AVRational){1, TICKS_PER_S};
  if (rate_hz > 0) {
    encoder->framerate = av_d2q(rate_hz, 1000000);
  }
  encoder->level = 3;
  encoder->gop_size = 1;
  encoder->slices = slices_of(first);
  encoder->thread_type = FF_THREAD_SLICE;
  encoder->thread_count = 0;
  encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  int code = av_opt_set_int(encoder->priv_data, "slicecrc", 1, 0);
  if (code >= 0) {
    code = avcodec_open2(encoder, codec, NULL);
  }
  return code < 0 ? placido_video_refuse(code, "cannot encode", video->path, err) : PLACIDO_OK;
}

static int start_file(placido_video_writer *video, const char *url, double rate_hz) {
  AVFormatContext *container = video->container;
  AVStream *stream = avformat_new_stream(container, NULL);
  if (!stream) {
    return AVERROR(ENOMEM);
  }
  stream->time_base = video->encoder->time_base;
  if (rate_hz > 0) {
    stream->avg_frame_rate = video->encoder->framerate;
  }
  int code = avcodec_parameters_from_context(stream->codecpar, video->encoder);
  if (code >= 0) {
    code = avio_open(&container->pb, url, AVIO_FLAG_WRITE);
  }
  if (code >= 0) {
    container->flags |= AVFMT_FLAG_FLUSH_PACKETS;
    container->flush_packets = 1;
    av_opt_set_int(container->priv_data, "cluster_time_limit", CLUSTER_MS, 0);
    code = avformat_write_header(container, NULL);
  }
  video->header_written = code >= 0;
  return code;
}

static int open_container(placido_video_writer *video, double rate_hz, placido_error *err) {
  char *url = placido_video_url(video->path, err);
  if (!url) {
    return PLACIDO_MEMORY;
  }
  int code = avformat_alloc_output_context2(&video->container, NULL, "matroska", url);
  if (code >= 0) {
    code = start_file(video, url, rate_hz);
  }
  placido_memory_free(url);
  if (code < 0) {
    return placido_video_refuse(code, "cannot write", video->path, err);
  }
  video->descriptor = open(video->path, O_RDONLY | O_CLOEXEC);
  if (video->descriptor < 0) {
    return placido_video_refuse(AVERROR(errno), "cannot write", video->path, err);
  }
  return PLACIDO_OK;
}

int placido_video_writer_open(placido_video_writer **video, const char *path,
                              const placido_frame *first, double rate_hz, placido_error *err) {
  *video = NULL;
  placido_video_silence();
  /* libavcodec cuts slices of a single column, and then loses samples. */
  if (first->width_px < SIDE_MIN_PX || first->height_px < SIDE_MIN_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a frame of %d x %d pixels cannot be recorded (at least %d a side)",
                             first->width_px, first->height_px, SIDE_MIN_PX);
  }
  placido_video_writer *opened = placido_memory_new(1, sizeof *opened, err);
  if (!opened) {
    return PLACIDO_MEMORY;
  }
  opened->descriptor = -1;
  opened->first_t_ns = first->t_ns;
  opened->last_tick = -1;
  opened->frame_ticks = rate_hz > 0 && rate_hz < TICKS_PER_S ? lround(TICKS_PER_S / rate_hz) : 1;
  opened->path = placido_memory_string(path, err);
  int status = opened->path ? open_encoder(opened, first, rate_hz, err) : PLACIDO_MEMORY;
  if (!status) {
    status = open_container(opened, rate_hz, err);
  }
  if (!status) {
    opened->packet = av_packet_alloc();
    opened->picture = av_frame_alloc();
    if (!opened->packet || !opened->picture) {
      status = placido_video_refuse(AVERROR(ENOMEM), "encoding", path, err);
    }
  }
  if (status) {
    placido_video_writer_close(opened, NULL);
    return status;
  }
  *video = opened;
  return PLACIDO_OK;
}

/* Times must grow: where the camera's do not, the nominal rate stands in. */
static int64_t next_tick(placido_video_writer *video, int64_t t_ns) {
  int64_t tick = (t_ns - video->first_t_ns) / NS_PER_TICK;
  if (video->last_tick >= 0 && tick <= video->last_tick) {
    tick = video->last_tick + (t_ns == 0 ? video->frame_ticks : 1);
  }
  video->last_tick = tick > 0 ? tick : 0;
  return video->last_tick;
}

/* Sends a picture (NULL: no more) to the encoder and what comes out to the file. */
static int encode(placido_video_writer *video, const AVFrame *picture) {
  int code = avcodec_send_frame(video->encoder, picture);
  while (code >= 0) {
    code = avcodec_receive_packet(video->encoder, video->packet);
    if (code < 0) {
      break;
    }
    AVStream *stream = video->container->streams[0];
    av_packet_rescale_ts(video->packet, video->encoder->time_base, stream->time_base);
    code = av_interleaved_write_frame(video->container, video->packet);
  }
  return code == AVERROR(EAGAIN) || code == AVERROR_EOF ? 0 : code;
}

int placido_video_writer_append(placido_video_writer *video, const placido_frame *frame,
                                placido_error *err) {
  AVFrame *picture = video->picture;
  picture->width = frame->width_px;
  picture->height = frame->height_px;
  picture->format = video->encoder->pix_fmt;
  picture->data[0] = frame->data; /* borrowed: without a buffer the encoder copies it */
  picture->linesize[0] = (int)frame->stride_bytes;
  picture->pts = next_tick(video, frame->t_ns);
  int code = encode(video, picture);
  picture->data[0] = NULL;
  return code < 0 ? placido_video_refuse(code, "writing", video->path, err) : PLACIDO_OK;
}

int placido_video_writer_sync(placido_video_writer *video, placido_error *err) {
  if (fdatasync(video->descriptor) != 0) {
    return placido_video_refuse(AVERROR(errno), "writing", video->path, err);
  }
  return PLACIDO_OK;
}

int placido_video_writer_close(placido_video_writer *video, placido_error *err) {
  if (!video) {
    return PLACIDO_OK;
  }
  int code = 0;
  if (video->header_written) {
    code = video->packet ? encode(video, NULL) : 0;
    int trailer = av_write_trailer(video->container);
    code = code < 0 ? code : trailer;
  }
  if (video->container && video->container->pb) {
    int closed = avio_closep(&video->container->pb);
    code = code < 0 ? code : closed;
  }
  int status = code < 0 ? placido_video_refuse(code, "writing", video->path, err) : PLACIDO_OK;
  if (video->descriptor >= 0) {
    close(video->descriptor);
  }
  av_frame_free(&video->picture);
  av_packet_free(&video->packet);
  avcodec_free_context(&video->encoder);
  avformat_free_context(video->container);
  placido_memory_free(video->path);
  placido_memory_free(video);
  return status;
}
