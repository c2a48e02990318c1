/* The terminal while something runs that must be ended in order: keys without return, Ctrl-Z. */
#ifndef PLACIDO_CLI_TERMINAL_H
#define PLACIDO_CLI_TERMINAL_H

#include <signal.h>
#include <stdbool.h>
#include <termios.h>

struct terminal {
  bool listens; /* to keys on standard input */
  bool is_terminal, is_raw;
  struct termios before;
  sigset_t mask_before;
  struct sigaction pipe_before;
};

/* What came; bits. */
#define TERMINAL_FIRE 1u /* space or return */
#define TERMINAL_END 2u  /* q, or Ctrl-\ */
#define TERMINAL_PAUSE 4u /* Ctrl-Z */

/* Takes over Ctrl-Z and Ctrl-\, which terminal_take tells of from here on, and keeps a reader that
 * has gone from ending the program. To be called before any library starts a thread of its own, to
 * which these signals would go. Where `keys` are wanted it listens at once. End with
 * terminal_close. */
void terminal_open(struct terminal *terminal, bool keys);

/* Keys come at once and unseen from here on. */
void terminal_listen(struct terminal *terminal);

/* What came since last time; does not wait. */
unsigned terminal_take(struct terminal *terminal);

/* Stops the program as Ctrl-Z does, with the terminal as it was; returns when it goes on. */
void terminal_pause(struct terminal *terminal);

/* Leaves everything as it was. */
void terminal_close(struct terminal *terminal);

#endif
