/* A thread that looks at the clock: libraries compute without calling back, so somebody else has to
 * notice that it takes long. It writes one line to standard error and keeps rewriting it. */
#include "acquire/cli/progress.h"

#include "base/memory.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PATIENCE_NS 1000000000L
#define PERIOD_NS 200000000L

struct progress {
  pthread_t thread;
  pthread_mutex_t lock;
  pthread_cond_t wake;
  char command[32], text[64];
  time_t started;
  bool stopping, shown;
};

/* Waits for `ns` or until the end; true at the end. The lock is held. */
static bool wait_for(struct progress *progress, long ns) {
  struct timespec until;
  clock_gettime(CLOCK_REALTIME, &until);
  until.tv_nsec += ns;
  until.tv_sec += until.tv_nsec / 1000000000L;
  until.tv_nsec %= 1000000000L;
  int late = 0;
  while (!progress->stopping && !late) {
    late = pthread_cond_timedwait(&progress->wake, &progress->lock, &until);
  }
  return progress->stopping;
}

static void *watch(void *user) {
  struct progress *progress = user;
  pthread_mutex_lock(&progress->lock);
  bool done = wait_for(progress, PATIENCE_NS);
  while (!done) {
    fprintf(stderr, "\r\033[Kplacido: %s: %s (%ld s)", progress->command, progress->text,
            (long)(time(NULL) - progress->started));
    fflush(stderr);
    progress->shown = true;
    done = wait_for(progress, PERIOD_NS);
  }
  pthread_mutex_unlock(&progress->lock);
  return NULL;
}

struct progress *progress_start(const char *command, bool wanted) {
  if (!wanted || !isatty(STDERR_FILENO)) {
    return NULL;
  }
  struct progress *progress = placido_memory_new(1, sizeof *progress, NULL);
  if (!progress) {
    return NULL;
  }
  snprintf(progress->command, sizeof progress->command, "%s", command);
  snprintf(progress->text, sizeof progress->text, "starting");
  progress->started = time(NULL);
  pthread_mutex_init(&progress->lock, NULL);
  pthread_cond_init(&progress->wake, NULL);
  if (pthread_create(&progress->thread, NULL, watch, progress) != 0) {
    pthread_cond_destroy(&progress->wake);
    pthread_mutex_destroy(&progress->lock);
    placido_memory_free(progress);
    return NULL;
  }
  return progress;
}

void progress_say(struct progress *progress, const char *text) {
  if (!progress) {
    return;
  }
  pthread_mutex_lock(&progress->lock);
  snprintf(progress->text, sizeof progress->text, "%s", text);
  pthread_mutex_unlock(&progress->lock);
}

void progress_stop(struct progress *progress) {
  if (!progress) {
    return;
  }
  pthread_mutex_lock(&progress->lock);
  progress->stopping = true;
  pthread_cond_signal(&progress->wake);
  pthread_mutex_unlock(&progress->lock);
  pthread_join(progress->thread, NULL);
  if (progress->shown) {
    fputs("\r\033[K", stderr);
  }
  pthread_cond_destroy(&progress->wake);
  pthread_mutex_destroy(&progress->lock);
  placido_memory_free(progress);
}
