/* What a simulated camera is told to do wrong, and when: orders that stand on the command line or
 * come one a line while it runs. */
#ifndef PLACIDO_CLI_SIM_ORDERS_H
#define PLACIDO_CLI_SIM_ORDERS_H

#include "gadget/picture.h"

#include <placido/status.h>
#include <stddef.h>
#include <stdint.h>

#define SIM_ORDERS_MAX 256

enum sim_verb {
  SIM_FAULT,      /* `number` more of `fault` */
  SIM_DISCONNECT, /* for `number` seconds */
  SIM_SLOW,       /* every answer and picture comes `number` ms later */
  SIM_LIST,       /* what is left */
  SIM_QUIT,
};

struct sim_order {
  enum sim_verb verb;
  enum placido_gadget_fault fault;
  double number;
  int64_t at_ns; /* after the camera was plugged in */
};

struct sim_orders {
  struct sim_order items[SIM_ORDERS_MAX];
  size_t count;
};

/* "stall", "drop 3", "disconnect 2", "slow 20", "faults", "quit". PLACIDO_INPUT: not understood. */
int sim_order_parse(struct sim_order *order, const char *line, placido_error *err);

/* "stall@5s,drop*3@8s,disconnect=2s@20s,slow=50@30s": the same words with a time, separated by
 * commas. STATUS_USAGE: not understood. */
int sim_orders_parse(struct sim_orders *orders, const char *text, placido_error *err);

/* What is understood, as one line. */
const char *sim_orders_words(void);

#endif
