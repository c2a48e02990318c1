/* The program `ffmpeg`, as what a recording is held against. */
#ifndef PLACIDO_CLI_BENCH_FFMPEG_H
#define PLACIDO_CLI_BENCH_FFMPEG_H

#include <placido/frame.h>
#include <placido/status.h>
#include <stdint.h>

/* Frames in a file without any header, read again from the start as often as needed. */
struct bench_ffmpeg_job {
  const char *raw_path, *output_path; /* the output must not exist */
  int width_px, height_px;
  int slices; /* of FFV1 */
  int64_t frames;
};

struct bench_ffmpeg_result {
  double wall_s, processor_s;
  int64_t bytes;
};

/* Encodes them as FFV1 version 3 with slice checksums, every frame on its own. The child dies with
 * this process. Returns PLACIDO_OK, PLACIDO_UNSUPPORTED (ffmpeg is not installed, or failed),
 * PLACIDO_SYSTEM (no process). */
int bench_ffmpeg_run(struct bench_ffmpeg_result *result, const struct bench_ffmpeg_job *job,
                     placido_error *err);

#endif
