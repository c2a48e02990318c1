/* The terminal while something runs that must be ended in order. The signals are blocked and asked
 * for, so that no handler has to know what is going on. */
#include "acquire/cli/terminal.h"

#include <errno.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

static void fill_signals(sigset_t *signals) {
  sigemptyset(signals);
  sigaddset(signals, SIGTSTP);
  sigaddset(signals, SIGQUIT);
}

/* In the background the terminal is somebody else's. */
static bool is_foreground(void) {
  return tcgetpgrp(STDIN_FILENO) == getpgrp();
}

/* Keys at once and unseen; signals stay. */
static void make_raw(struct terminal *terminal) {
  if (!terminal->is_terminal || terminal->is_raw || !is_foreground() ||
      tcgetattr(STDIN_FILENO, &terminal->before) != 0) {
    return;
  }
  struct termios raw = terminal->before;
  raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
  raw.c_cc[VMIN] = 1;
  raw.c_cc[VTIME] = 0;
  terminal->is_raw = tcsetattr(STDIN_FILENO, TCSADRAIN, &raw) == 0;
}

static void restore(struct terminal *terminal) {
  if (terminal->is_raw && is_foreground()) {
    tcsetattr(STDIN_FILENO, TCSADRAIN, &terminal->before);
  }
  terminal->is_raw = false;
}

void terminal_listen(struct terminal *terminal) {
  terminal->listens = true;
  make_raw(terminal);
}

void terminal_open(struct terminal *terminal, bool keys) {
  *terminal = (struct terminal){.is_terminal = isatty(STDIN_FILENO)};
  sigset_t signals;
  fill_signals(&signals);
  pthread_sigmask(SIG_BLOCK, &signals, &terminal->mask_before);
  const struct sigaction ignore = {.sa_handler = SIG_IGN};
  sigaction(SIGPIPE, &ignore, &terminal->pipe_before);
  if (keys) {
    terminal_listen(terminal);
  }
}

static unsigned take_signals(void) {
  const struct timespec at_once = {0};
  sigset_t signals;
  unsigned came = 0;
  int number;
  fill_signals(&signals);
  while ((number = sigtimedwait(&signals, NULL, &at_once)) > 0) {
    came |= number == SIGTSTP ? TERMINAL_PAUSE : TERMINAL_END;
  }
  return came;
}

static unsigned meaning(char key) {
  return key == ' ' || key == '\n' || key == '\r' ? TERMINAL_FIRE
         : key == 'q' || key == 'Q'               ? TERMINAL_END
                                                  : 0u;
}

/* One key at a time, so that two bursts may be asked for one after the other. */
static unsigned take_key(struct terminal *terminal) {
  struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
  char key;
  make_raw(terminal); /* after a pause, and after having been in the background */
  if ((terminal->is_terminal && !terminal->is_raw) || poll(&input, 1, 0) <= 0) {
    return 0;
  }
  const ssize_t got = read(STDIN_FILENO, &key, 1);
  if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN)) {
    terminal->listens = false; /* there will be no further key */
  }
  return got == 1 ? meaning(key) : 0u;
}

unsigned terminal_take(struct terminal *terminal) {
  const unsigned came = take_signals();
  return terminal->listens ? came | take_key(terminal) : came;
}

void terminal_pause(struct terminal *terminal) {
  sigset_t stop, before;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTSTP);
  restore(terminal);
  raise(SIGTSTP);
  pthread_sigmask(SIG_UNBLOCK, &stop, &before); /* stops here */
  pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void terminal_close(struct terminal *terminal) {
  restore(terminal);
  sigaction(SIGPIPE, &terminal->pipe_before, NULL);
  pthread_sigmask(SIG_SETMASK, &terminal->mask_before, NULL);
}
