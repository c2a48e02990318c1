/* Writes frames.mkv: encoded frames in Matroska (RFC 9559), in clusters short enough that a crash
 * costs at most the last second. */
#include "base/session/video.h"

#include "base/memory.h"
#include "base/session/video_encoder.h"

#include <errno.h>
#include <fcntl.h>
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <math.h>
#include <stdbool.h>
#include <unistd.h>

/* A cluster reaches the file when it ends, which is after this time at the latest. */
#define CLUSTER_MS 500
#define SIDE_MIN_PX 4
#define TICKS_PER_S PLACIDO_VIDEO_TICKS_PER_S
#define NS_PER_TICK (1000000000LL / TICKS_PER_S)

struct placido_video_writer {
  AVFormatContext *container;
  AVCodecContext *encoder;
  AVPacket *packet;
  AVFrame *picture;
  char *path;
  int descriptor; /* of the same file, for fdatasync; -1 where there is none */
  int64_t origin_ns, last_tick, frame_ticks;
  bool header_written;
};

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
    /* Matroska stores raw samples of any FourCC; libavformat calls those of 16 bit unofficial. */
    container->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
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
                              const placido_video_options *options, const placido_frame *first,
                              placido_error *err) {
  *video = NULL;
  const double rate_hz = options->rate_hz;
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
  opened->origin_ns = options->origin_ns;
  opened->last_tick = -1;
  opened->frame_ticks = rate_hz > 0 && rate_hz < TICKS_PER_S ? lround(TICKS_PER_S / rate_hz) : 1;
  opened->path = placido_memory_string(path, err);
  int status = opened->path ? placido_video_encoder_open(&opened->encoder, options, first,
                                                         opened->path, err)
                            : PLACIDO_MEMORY;
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
  int64_t tick = (t_ns - video->origin_ns) / NS_PER_TICK;
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
  const int code = av_write_frame(video->container, NULL); /* ends the cluster that has begun */
  if (code < 0) {
    return placido_video_refuse(code, "writing", video->path, err);
  }
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
