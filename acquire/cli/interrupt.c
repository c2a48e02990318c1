/* A thread that waits for the signals which every other thread has blocked. In it, unlike in a
 * signal handler, any function may be called, so that a whole directory can be removed. */
#include "acquire/cli/interrupt.h"

#include "base/memory.h"

#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define ATTEMPTS 100
#define PAUSE_NS 10000000L

struct interrupt {
  pthread_t thread;
  pthread_mutex_t lock;
  sigset_t signals, before;
  char command[32];
  placido_directory directory; /* temporary[0] zero: nothing to remove */
  bool defers, is_asked;
};

/* Other threads may be writing still: what they add while this removes is removed again. */
static void remove_directory(const placido_directory *directory) {
  const struct timespec pause = {.tv_nsec = PAUSE_NS};
  for (int i = 0; i < ATTEMPTS && access(directory->temporary, F_OK) == 0; i++) {
    placido_directory doomed = *directory;
    placido_directory_discard(&doomed);
    if (access(directory->temporary, F_OK) == 0) {
      nanosleep(&pause, NULL);
    }
  }
}

/* Ends the program by the signal itself, so that a shell knows why it ended. The lock is kept:
 * whoever waits for it must not go on. */
static void end_by(struct interrupt *interrupt, int number) {
  pthread_mutex_lock(&interrupt->lock);
  const bool unfinished = interrupt->directory.temporary[0] != '\0';
  if (unfinished) {
    remove_directory(&interrupt->directory);
  }
  fprintf(stderr, "%splacido: %s: stopped by a signal (%s)%s\n",
          isatty(STDERR_FILENO) ? "\r\033[K" : "", interrupt->command, strsignal(number),
          unfinished ? ": nothing was written" : "");
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, number);
  signal(number, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &one, NULL);
  raise(number);
}

/* Takes note of a signal where it is not to end the program. */
static bool defer(struct interrupt *interrupt) {
  pthread_mutex_lock(&interrupt->lock);
  const bool deferred = interrupt->defers;
  interrupt->is_asked = deferred;
  pthread_mutex_unlock(&interrupt->lock);
  return deferred;
}

static void *watch(void *user) {
  struct interrupt *interrupt = user;
  int number;
  sigset_t all; /* SIGTSTP is not for this thread where a command handles it */
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, NULL);
  while (sigwait(&interrupt->signals, &number) == 0) {
    pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, NULL);
    if (!defer(interrupt)) {
      end_by(interrupt, number);
    }
    pthread_setcancelstate(PTHREAD_CANCEL_ENABLE, NULL);
  }
  return NULL;
}

/* A signal that was ignored when the program began (nohup, a job in the background) stays so. */
static void choose_signals(sigset_t *signals) {
  static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
  sigemptyset(signals);
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
    struct sigaction action;
    if (sigaction(numbers[i], NULL, &action) == 0 && action.sa_handler != SIG_IGN) {
      sigaddset(signals, numbers[i]);
    }
  }
}

struct interrupt *interrupt_start(const char *command) {
  struct interrupt *interrupt = placido_memory_new(1, sizeof *interrupt, NULL);
  if (!interrupt) {
    return NULL;
  }
  snprintf(interrupt->command, sizeof interrupt->command, "%s", command);
  choose_signals(&interrupt->signals);
  pthread_mutex_init(&interrupt->lock, NULL);
  pthread_sigmask(SIG_BLOCK, &interrupt->signals, &interrupt->before);
  if (pthread_create(&interrupt->thread, NULL, watch, interrupt) != 0) {
    pthread_sigmask(SIG_SETMASK, &interrupt->before, NULL);
    pthread_mutex_destroy(&interrupt->lock);
    placido_memory_free(interrupt);
    return NULL;
  }
  return interrupt;
}

void interrupt_hold(struct interrupt *interrupt) {
  if (interrupt) {
    pthread_mutex_lock(&interrupt->lock);
  }
}

void interrupt_release(struct interrupt *interrupt, const placido_directory *directory) {
  if (interrupt) {
    interrupt->directory = *directory;
    pthread_mutex_unlock(&interrupt->lock);
  }
}

void interrupt_defer(struct interrupt *interrupt) {
  if (interrupt) {
    pthread_mutex_lock(&interrupt->lock);
    interrupt->defers = true;
    pthread_mutex_unlock(&interrupt->lock);
  }
}

bool interrupt_is_asked(struct interrupt *interrupt) {
  if (!interrupt) {
    return false;
  }
  pthread_mutex_lock(&interrupt->lock);
  const bool is_asked = interrupt->is_asked;
  pthread_mutex_unlock(&interrupt->lock);
  return is_asked;
}

void interrupt_stop(struct interrupt *interrupt) {
  if (!interrupt) {
    return;
  }
  pthread_mutex_lock(&interrupt->lock);
  pthread_cancel(interrupt->thread);
  pthread_mutex_unlock(&interrupt->lock);
  pthread_join(interrupt->thread, NULL);
  pthread_sigmask(SIG_SETMASK, &interrupt->before, NULL);
  pthread_mutex_destroy(&interrupt->lock);
  placido_memory_free(interrupt);
}
