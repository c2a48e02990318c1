/* `placido bench record`: whether recording keeps up with a camera, and with the program ffmpeg. */
#include "acquire/cli/bench_ffmpeg.h"
#include "acquire/cli/bench_scratch.h"
#include "acquire/cli/bench_sight.h"
#include "acquire/recorder.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define RATE_HZ 60.0
#define SECONDS 10.0
#define QUICK_SECONDS 0.2
#define ROUNDS 2        /* of ours and ffmpeg's in turn, so that both meet the same machine */
#define QUEUE_FRAMES 8  /* where the source waits, a long queue would only be written afterwards */
#define ROOM_MORE 100e6 /* bytes beside the frames */
#define SLICES 16       /* as our own FFV1 of that size has */

/* One recording, or several as one. */
struct pass {
  enum placido_session_codec codec;
  double rate_hz; /* 0: as fast as it goes */
  double seconds;
  int64_t frames;  /* handed over */
  placido_recorder_summary summary;
  double wall_s, processor_s;
};

struct work {
  struct bench_run *bench;
  const struct bench_sight *sight;
  double seconds, frame_bytes;
  placido_directory scratch;
  char instrument_path[PLACIDO_PATH_MAX], session_path[PLACIDO_PATH_MAX];
  char raw_path[PLACIDO_PATH_MAX], other_path[PLACIDO_PATH_MAX];
  struct bench_laps reading;
};

static void sleep_until(double wall_s) {
  const double seconds = floor(wall_s);
  const struct timespec until = {.tv_sec = (time_t)seconds,
                                 .tv_nsec = (long)(1e9 * (wall_s - seconds))};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL) == EINTR) {
  }
}

/* The frame comes as from a driver: its samples are copied into a block that the recorder keeps. */
static int fill(placido_frame *frame, const placido_frame *from, int64_t index,
                placido_error *err) {
  const int status =
      placido_frame_resize(frame, from->width_px, from->height_px, from->format, err);
  if (status == PLACIDO_OK) {
    memcpy(frame->data, from->data, (size_t)from->height_px * from->stride_bytes);
    frame->t_ns = (int64_t)(1e9 * bench_wall_s());
    frame->seq = (uint64_t)index;
    frame->flags = 0;
  }
  return status;
}

/* Hands frames over until the time is up, one a tick or as fast as they are taken. */
static int feed(placido_recorder *recorder, struct pass *pass, const struct work *work,
                placido_error *err) {
  placido_frame frame = {0};
  const double began_s = bench_wall_s();
  const int64_t most = (int64_t)ceil(RATE_HZ * pass->seconds);
  int status = PLACIDO_OK;
  int64_t index = 0;
  while (status == PLACIDO_OK && index < most &&
         (pass->rate_hz > 0.0 || bench_wall_s() - began_s < pass->seconds)) {
    if (pass->rate_hz > 0.0) {
      sleep_until(began_s + (double)index / pass->rate_hz);
    }
    status = fill(&frame, &work->sight->frames[index % work->sight->count], index, err);
    if (status == PLACIDO_OK && !(pass->rate_hz > 0.0)) {
      placido_recorder_wait(recorder, &frame);
    }
    if (status == PLACIDO_OK) {
      status = placido_recorder_put(recorder, &frame, NULL, err);
    }
    index++;
  }
  if (pass->rate_hz > 0.0) { /* the last frame takes its time, too */
    sleep_until(began_s + (double)index / pass->rate_hz);
  }
  pass->frames += index;
  placido_frame_free(&frame);
  return status;
}

static void add(placido_recorder_summary *sum, const placido_recorder_summary *one) {
  sum->written += one->written;
  sum->dropped += one->dropped;
  sum->bytes += one->bytes;
  sum->queue_most = one->queue_most > sum->queue_most ? one->queue_most : sum->queue_most;
}

/* Records once; the time goes on until the last frame is written and the files are closed. */
static int record(struct pass *pass, const struct work *work, placido_error *err) {
  const placido_session_info info = {.format = PLACIDO_MONO8,
                                     .bits = 8,
                                     .rate_hz = RATE_HZ,
                                     .axis_z_mm = NAN,
                                     .axis_z_sigma_mm = NAN,
                                     .codec = pass->codec};
  const size_t queue = pass->rate_hz > 0.0 ? 0 : (size_t)(QUEUE_FRAMES * work->frame_bytes);
  placido_recorder *recorder;
  placido_recorder_summary summary;
  const double wall_s = bench_wall_s(), processor_s = bench_processor_s();
  int status = placido_recorder_open(&recorder, work->session_path, &info, work->instrument_path,
                                     queue, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = feed(recorder, pass, work, err);
  const int closed = placido_recorder_close(recorder, &summary, status == PLACIDO_OK ? err : NULL);
  pass->wall_s += bench_wall_s() - wall_s;
  pass->processor_s += bench_processor_s() - processor_s;
  add(&pass->summary, &summary);
  bench_scratch_remove(work->session_path);
  return status == PLACIDO_OK ? closed : status;
}

/* What a program that encodes took. */
struct cost {
  const char *name;
  double frames, wall_s, processor_s, bytes;
};

/* Rate, processor and size of any of them; `against` is what its rate is held against. */
static int tell_cost(const struct work *work, const struct cost *cost, double reference_hz,
                     const char *against, placido_error *err) {
  struct bench_report *report = &work->bench->report;
  const double reading_s =
      bench_median(work->reading.processor_s, work->reading.count);
  const double rate_hz = cost->frames / cost->wall_s;
  const double each_s = cost->processor_s / cost->frames;
  char what[64];
  snprintf(what, sizeof what, "%s: recorded", cost->name);
  int status = bench_report_number(report, what, rate_hz, "frames/s",
                                   against ? rate_hz / reference_hz : NAN, against, err);
  if (status == PLACIDO_OK) {
    snprintf(what, sizeof what, "%s: share of a core", cost->name);
    status = bench_report_number(report, what, 100.0 * cost->processor_s / cost->wall_s, "%", NAN,
                                 NULL, err);
  }
  if (status == PLACIDO_OK) {
    snprintf(what, sizeof what, "%s: processor time a frame", cost->name);
    status = bench_report_number(report, what, 1e3 * each_s, "ms", each_s / reading_s,
                                 BENCH_READING, err);
  }
  if (status == PLACIDO_OK) {
    snprintf(what, sizeof what, "%s: written", cost->name);
    status = bench_report_number(report, what, 1e-6 * cost->bytes / cost->wall_s, "MB/s",
                                 cost->bytes / (cost->frames * work->frame_bytes),
                                 "the samples' bytes", err);
  }
  return status;
}

static struct cost cost_of(const char *name, const struct pass *pass) {
  return (struct cost){.name = name,
                       .frames = (double)pass->summary.written,
                       .wall_s = pass->wall_s,
                       .processor_s = pass->processor_s,
                       .bytes = (double)pass->summary.bytes};
}

/* At the camera's rate: what counts is that nothing is dropped. */
static int keep_up(struct work *work, enum placido_session_codec codec, placido_error *err) {
  struct pass pass = {.codec = codec, .rate_hz = RATE_HZ, .seconds = work->seconds};
  struct bench_report *report = &work->bench->report;
  const char *name = placido_session_codec_name(codec);
  char what[64];
  stages_next(&work->bench->outcome->stages, "record %s", name);
  int status = record(&pass, work, err);
  if (status == PLACIDO_OK) {
    const struct cost cost = cost_of(name, &pass);
    status = tell_cost(work, &cost, RATE_HZ, "the rate asked for", err);
  }
  if (status == PLACIDO_OK) {
    snprintf(what, sizeof what, "%s: dropped", name);
    status = bench_report_number(report, what, (double)pass.summary.dropped, "frames",
                                 (double)pass.summary.dropped / (double)pass.frames,
                                 "the frames that came", err);
  }
  if (status == PLACIDO_OK) {
    snprintf(what, sizeof what, "%s: waited at most", name);
    status = bench_report_number(report, what, (double)pass.summary.queue_most, "frames", NAN,
                                 NULL, err);
  }
  return status;
}

/* As many frames as ours were, by ffmpeg. */
static int encode_other(struct cost *other, const struct work *work, int64_t frames,
                        placido_error *err) {
  const placido_frame *first = &work->sight->frames[0];
  const struct bench_ffmpeg_job job = {.raw_path = work->raw_path,
                                       .output_path = work->other_path,
                                       .width_px = first->width_px,
                                       .height_px = first->height_px,
                                       .slices = SLICES,
                                       .frames = frames};
  struct bench_ffmpeg_result result;
  const int status = bench_ffmpeg_run(&result, &job, err);
  other->frames += (double)frames;
  other->wall_s += result.wall_s;
  other->processor_s += result.processor_s;
  other->bytes += (double)result.bytes;
  bench_scratch_remove(work->other_path);
  return status;
}

/* Ours and ffmpeg's at full speed. Without ffmpeg there is a note, and nothing to compare with. */
static int race(struct work *work, placido_error *err) {
  struct pass pass = {.codec = PLACIDO_CODEC_FFV1, .seconds = work->seconds / ROUNDS};
  struct cost other = {.name = "ffmpeg ffv1"};
  placido_error why;
  int status = PLACIDO_OK, compared = PLACIDO_OK;
  for (int round = 0; status == PLACIDO_OK && round < ROUNDS; round++) {
    const int64_t before = pass.summary.written;
    stages_next(&work->bench->outcome->stages, "record ffv1");
    status = record(&pass, work, err);
    if (status == PLACIDO_OK && compared == PLACIDO_OK) {
      stages_next(&work->bench->outcome->stages, "ffmpeg ffv1");
      compared = encode_other(&other, work, pass.summary.written - before, &why);
    }
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  const struct cost ours = cost_of("ffv1", &pass);
  if (compared != PLACIDO_OK) {
    placido_notes_add(&work->bench->outcome->notes, "record: %s: FFV1 is compared with nothing",
                      why.text);
    return tell_cost(work, &ours, NAN, NULL, err);
  }
  status = tell_cost(work, &ours, other.frames / other.wall_s, "ffmpeg's rate", err);
  return status == PLACIDO_OK ? tell_cost(work, &other, NAN, NULL, err) : status;
}

static int save_raw(const struct work *work, placido_error *err) {
  placido_file file;
  int status = placido_file_create(&file, work->raw_path, err);
  for (int i = 0; status == PLACIDO_OK && i < work->sight->count; i++) {
    fwrite(work->sight->frames[i].data, (size_t)work->frame_bytes, 1, file.stream);
  }
  return status == PLACIDO_OK ? placido_file_commit(&file, err) : status;
}

static int name_files(struct work *work, placido_error *err) {
  const struct {
    char *path;
    const char *name;
  } files[] = {{work->instrument_path, "instrument.json"},
               {work->session_path, "recorded.session"},
               {work->raw_path, "frames.raw"},
               {work->other_path, "other.mkv"}};
  int status = PLACIDO_OK;
  for (size_t i = 0; status == PLACIDO_OK && i < sizeof files / sizeof files[0]; i++) {
    status = placido_path_join(files[i].path, work->scratch.temporary, files[i].name, err);
  }
  return status;
}

/* Room first: rendering takes seconds. */
static int prepare(struct work *work, placido_error *err) {
  const double most_bytes = RATE_HZ * work->seconds * BENCH_FRAME_BYTES;
  int status = bench_scratch_open(&work->scratch, work->bench, 1.1 * most_bytes + ROOM_MORE, err);
  if (status == PLACIDO_OK) {
    status = name_files(work, err);
  }
  if (status == PLACIDO_OK) {
    status = bench_sight_get(&work->sight, work->bench, err);
  }
  if (status == PLACIDO_OK) {
    const placido_frame *first = &work->sight->frames[0];
    work->frame_bytes = (double)first->height_px * (double)first->stride_bytes;
    status = placido_instrument_save(&work->sight->instrument, work->instrument_path, err);
  }
  return status == PLACIDO_OK ? save_raw(work, err) : status;
}

static int read_all(struct work *work, placido_error *err) {
  unsigned long sum = 0;
  for (int i = 0; i < BENCH_FRAMES; i++) {
    sum += bench_sight_read(&work->reading, &work->sight->frames[i % work->sight->count]);
  }
  return bench_sight_report(work->bench, &work->reading, sum, err);
}

static int run(struct bench_run *bench, placido_error *err) {
  struct work work = {.bench = bench};
  const double usual_s = bench->settings->quick ? QUICK_SECONDS : SECONDS;
  work.seconds = bench->settings->for_s > 0.0 ? bench->settings->for_s : usual_s;
  int status = prepare(&work, err);
  if (status == PLACIDO_OK) {
    status = read_all(&work, err);
  }
  if (status == PLACIDO_OK) {
    status = keep_up(&work, PLACIDO_CODEC_FFVHUFF, err);
  }
  if (status == PLACIDO_OK) {
    status = keep_up(&work, PLACIDO_CODEC_RAW, err);
  }
  if (status == PLACIDO_OK) {
    status = race(&work, err);
  }
  bench_scratch_close(&work.scratch, bench);
  return status;
}

const struct bench bench_record = {
    .name = "record",
    .summary = "recording 1280×1024 at 60 frames/s, and FFV1 at full speed beside ffmpeg's",
    .run = run,
};
