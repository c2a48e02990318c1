/* Takes pictures from a device and tells what came: frames, losses, time, memory, open files.
 *
 *   stream URI [--frames N] [--seconds S] [--settle S] [--sums]
 *
 * --settle: memory and files are looked at so many seconds after the first frame (1), and at the
 * end; --sums: a line for every frame, its number, flags and the sum of its samples, and one for
 * every change of what is counted. Ends with 0 where the frames (30) or the seconds were had, 1
 * where the device failed or fell silent. */
#include <placido/device.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

/* Longer silence is a failure: emulation is slow, but not that slow. */
#define SILENCE_MAX_S 30

struct wish {
  const char *uri;
  uint64_t frames; /* 0: until the time is over */
  double seconds;  /* 0: until the frames are there */
  double settle_s;
  bool wants_sums;
};

/* What the process holds at a moment. */
struct holding {
  long rss_kb;
  int files;
};

struct run {
  struct wish wish;
  placido_device *device;
  placido_frame frame;
  double begin_s, last_s; /* of the first and the latest frame */
  uint64_t frames, gaps, flagged, last_seq;
  placido_device_statistics told; /* but for its frames */
  struct holding settled;
  bool is_settled;
};

static double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static double cpu_s(void) {
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static struct holding look_at_self(void) {
  struct holding holding = {0, -3}; /* ".", ".." and the directory itself */
  long size, resident;
  FILE *file = fopen("/proc/self/statm", "r");
  if (file) {
    if (fscanf(file, "%ld %ld", &size, &resident) == 2) {
      holding.rss_kb = resident * (sysconf(_SC_PAGESIZE) / 1024);
    }
    fclose(file);
  }
  DIR *directory = opendir("/proc/self/fd");
  while (directory && readdir(directory)) {
    holding.files++;
  }
  if (directory) {
    closedir(directory);
  }
  return holding;
}

/* FNV-1a over the samples, without what stands behind the rows. */
static uint64_t sum_of(const placido_frame *frame) {
  const size_t row_bytes = (size_t)frame->width_px * placido_format_bytes(frame->format);
  uint64_t sum = 0xcbf29ce484222325u;
  for (int y = 0; y < frame->height_px; y++) {
    const uint8_t *row = frame->data + (size_t)y * frame->stride_bytes;
    for (size_t i = 0; i < row_bytes; i++) {
      sum = (sum ^ row[i]) * 0x100000001b3u;
    }
  }
  return sum;
}

static int read_wish(struct wish *wish, int count, char **words) {
  *wish = (struct wish){.settle_s = 1};
  for (int i = 1; i < count; i++) {
    const char *word = words[i];
    const char *value = i + 1 < count ? words[i + 1] : "";
    if (strcmp(word, "--sums") == 0) {
      wish->wants_sums = true;
    } else if (strcmp(word, "--frames") == 0) {
      wish->frames = strtoull(value, NULL, 10);
      i++;
    } else if (strcmp(word, "--seconds") == 0) {
      wish->seconds = strtod(value, NULL);
      i++;
    } else if (strcmp(word, "--settle") == 0) {
      wish->settle_s = strtod(value, NULL);
      i++;
    } else {
      wish->uri = word;
    }
  }
  if (wish->frames == 0 && !(wish->seconds > 0)) {
    wish->frames = 30;
  }
  return wish->uri ? 0 : -1;
}

static bool is_done(const struct run *run) {
  const struct wish *wish = &run->wish;
  return (wish->frames > 0 && run->frames >= wish->frames) ||
         (wish->seconds > 0 && run->frames > 0 && now_s() - run->begin_s >= wish->seconds);
}

/* Tells what is counted where it is not what it was. */
static void tell_counts(struct run *run) {
  placido_device_statistics said;
  placido_device_statistics_get(run->device, &said);
  said.frames = run->told.frames;
  if (run->frames == 1 || memcmp(&said, &run->told, sizeof said) != 0) {
    printf("counts gaps %llu flagged %llu dropped %llu corrupt %llu truncated %llu restarts %llu "
           "replugs %llu\n",
           (unsigned long long)run->gaps, (unsigned long long)run->flagged,
           (unsigned long long)said.dropped, (unsigned long long)said.corrupt,
           (unsigned long long)said.truncated, (unsigned long long)said.restarts,
           (unsigned long long)said.replugs);
  }
  run->told = said;
}

static void count_frame(struct run *run) {
  const placido_frame *frame = &run->frame;
  run->last_s = now_s();
  if (run->frames == 0) {
    run->begin_s = run->last_s;
  } else {
    run->gaps += frame->seq - run->last_seq - 1;
  }
  run->frames++;
  run->last_seq = frame->seq;
  run->flagged += frame->flags != 0;
  if (run->wish.wants_sums) {
    printf("frame %llu %u %016llx\n", (unsigned long long)frame->seq, frame->flags,
           (unsigned long long)sum_of(frame));
    tell_counts(run);
  }
  if (!run->is_settled && run->last_s - run->begin_s >= run->wish.settle_s) {
    run->settled = look_at_self();
    run->is_settled = true;
  }
}

static int take_frames(struct run *run, placido_error *err) {
  double heard_s = now_s();
  while (!is_done(run)) {
    const int status = placido_device_next(run->device, &run->frame, 1000, err);
    if (status == PLACIDO_OK) {
      count_frame(run);
      heard_s = run->last_s;
    } else if (status == PLACIDO_END) {
      return run->wish.frames ? PLACIDO_END : PLACIDO_OK;
    } else if (status != PLACIDO_TIMEOUT && status != PLACIDO_INPUT) {
      return status;
    } else if (now_s() - heard_s > SILENCE_MAX_S) {
      return placido_error_set(err, PLACIDO_TIMEOUT, "silent for %d s", SILENCE_MAX_S);
    }
  }
  return PLACIDO_OK;
}

static void report(const struct run *run, double cpu) {
  placido_device_statistics said;
  placido_device_statistics_get(run->device, &said);
  const double seconds = run->last_s - run->begin_s;
  const struct holding end = look_at_self();
  const struct holding begin = run->is_settled ? run->settled : end;
  printf("frames %llu\ngaps %llu\nflagged %llu\n", (unsigned long long)run->frames,
         (unsigned long long)run->gaps, (unsigned long long)run->flagged);
  printf("dropped %llu\ncorrupt %llu\ntruncated %llu\nrestarts %llu\nreplugs %llu\n",
         (unsigned long long)said.dropped, (unsigned long long)said.corrupt,
         (unsigned long long)said.truncated, (unsigned long long)said.restarts,
         (unsigned long long)said.replugs);
  printf("seconds %.1f\nfps %.1f\ncpu_percent %.1f\n", seconds,
         seconds > 0 ? (double)(run->frames - 1) / seconds : 0.0,
         seconds > 0 ? 100 * cpu / seconds : 0.0);
  printf("rss_kb %ld\nrss_growth_kb %ld\nfiles %d\nfiles_growth %d\n", end.rss_kb,
         end.rss_kb - begin.rss_kb, end.files, end.files - begin.files);
}

int main(int count, char **words) {
  struct run run = {.frames = 0};
  placido_error err = {0};
  placido_notes notes = {0};
  setvbuf(stdout, NULL, _IOLBF, 0);
  if (read_wish(&run.wish, count, words)) {
    fprintf(stderr, "stream: which device?\n");
    return 2;
  }
  int status = placido_device_open(&run.device, run.wish.uri, &notes, &err);
  for (size_t i = 0; i < notes.count; i++) {
    printf("note %s\n", notes.lines[i]);
  }
  placido_notes_clear(&notes);
  if (!status) {
    status = placido_device_start(run.device, &err);
  }
  if (!status) {
    const double cpu_before_s = cpu_s();
    status = take_frames(&run, &err);
    report(&run, cpu_s() - cpu_before_s);
  }
  if (status) {
    printf("status %d\nerror %s\n", status, err.text);
  }
  placido_device_close(run.device);
  placido_frame_free(&run.frame);
  return status ? 1 : 0;
}
