/* Runs the program `ffmpeg` and takes its time. */
#include "acquire/cli/bench_ffmpeg.h"

#include "acquire/cli/bench_time.h"
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define EXIT_NO_PROGRAM 127
#define FILE_MAX (PLACIDO_PATH_MAX + 8)

/* In the child: says nothing, hears signals again, and ends with its parent, which a signal may end
 * without a chance to tell it. */
static void become(char *const *arguments, pid_t parent) {
  const int nothing = open("/dev/null", O_RDWR);
  sigset_t none;
  sigemptyset(&none);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(nothing, STDOUT_FILENO) < 0 ||
      dup2(nothing, STDERR_FILENO) < 0 || prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 ||
      getppid() != parent) {
    _exit(1);
  }
  sigprocmask(SIG_SETMASK, &none, NULL);
  execvp(arguments[0], arguments);
  _exit(EXIT_NO_PROGRAM);
}

static double seconds_of(const struct timeval *time) {
  return (double)time->tv_sec + 1e-6 * (double)time->tv_usec;
}

static int judge(int ended, placido_error *err) {
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == 0) {
    return PLACIDO_OK;
  }
  if (WIFEXITED(ended) && WEXITSTATUS(ended) == EXIT_NO_PROGRAM) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "ffmpeg is not installed");
  }
  return placido_error_set(err, PLACIDO_UNSUPPORTED, "ffmpeg failed (%s %d)",
                           WIFEXITED(ended) ? "exit status" : "signal",
                           WIFEXITED(ended) ? WEXITSTATUS(ended) : WTERMSIG(ended));
}

/* Starts the program, waits for its end, and takes the processor time of all its threads. */
static int run_child(struct bench_ffmpeg_result *result, char *const *arguments,
                     placido_error *err) {
  const pid_t parent = getpid();
  const double began_s = bench_wall_s();
  const pid_t child = fork();
  if (child == 0) {
    become(arguments, parent);
  }
  int ended = 0;
  struct rusage usage = {0};
  pid_t waited = child;
  while (child > 0 && (waited = wait4(child, &ended, 0, &usage)) < 0 && errno == EINTR) {
  }
  if (waited < 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot run ffmpeg: %s", strerror(errno));
  }
  result->wall_s = bench_wall_s() - began_s;
  result->processor_s = seconds_of(&usage.ru_utime) + seconds_of(&usage.ru_stime);
  return judge(ended, err);
}

/* Without it what stands before a colon would be taken for a protocol. */
static void name_file(char name[FILE_MAX], const char *path) {
  snprintf(name, FILE_MAX, "file:%s", path);
}

int bench_ffmpeg_run(struct bench_ffmpeg_result *result, const struct bench_ffmpeg_job *job,
                     placido_error *err) {
  char input[FILE_MAX], output[FILE_MAX], size[32], slices[16], frames[32];
  struct stat written;
  *result = (struct bench_ffmpeg_result){0};
  name_file(input, job->raw_path);
  name_file(output, job->output_path);
  snprintf(size, sizeof size, "%dx%d", job->width_px, job->height_px);
  snprintf(slices, sizeof slices, "%d", job->slices);
  snprintf(frames, sizeof frames, "%lld", (long long)job->frames);
  const char *const arguments[] = {
      "ffmpeg",     "-nostdin", "-v",       "error", "-stream_loop", "-1",
      "-f",         "rawvideo", "-pix_fmt", "gray",  "-video_size",  size,
      "-framerate", "60",       "-i",       input,   "-frames:v",    frames,
      "-c:v",       "ffv1",     "-level",   "3",     "-slicecrc",    "1",
      "-slices",    slices,     "-g",       "1",     "-f",           "matroska",
      output,       NULL};
  /* execvp does not write to what it is given; only its type is older than const. */
  const int status = run_child(result, (char *const *)(uintptr_t)arguments, err);
  if (status == PLACIDO_OK && stat(job->output_path, &written) == 0) {
    result->bytes = (int64_t)written.st_size;
  }
  return status;
}
