/* `placido device-sim`: a camera that exists only as a program, for a kernel that cannot tell. */
#include "acquire/cli/command.h"
#include "acquire/cli/record.h"
#include "acquire/cli/sim_orders.h"
#include "acquire/cli/sim_view.h"
#include "base/clock.h"
#include "base/memory.h"
#include "gadget/face.h"
#include "gadget/server.h"
#include "gadget/vhci.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEFAULT_FACE "u3v"
#define DEFAULT_SERIAL "SIM0001"
#define LINE_BYTES 256
#define ANSWER_BYTES 600 /* more than an error has */

/* A running simulation. */
struct simulation {
  const struct settings *settings;
  const placido_gadget_face *face;
  struct sim_view view;
  struct sim_orders orders; /* those that are still to come */
  placido_gadget_faults faults;
  placido_gadget gadget;
  placido_gadget_server *server;
  placido_gadget_server_options options;
  char address[64]; /* to listen on */
  int64_t started_ns;
  char line[LINE_BYTES]; /* of a command, until it is whole */
  size_t line_length;
};

/* One answer on standard output, which a script waits for. */
static int tell(const struct simulation *simulation, const char *text, placido_error *err) {
  say(simulation->settings, "%s", text);
  return fflush(stdout) == 0 ? PLACIDO_OK
                             : placido_error_set(err, PLACIDO_SYSTEM,
                                                 "standard output cannot be written");
}

/* "OK", and what is left of the faults. */
static void describe_faults(const struct simulation *simulation, char *text, size_t size) {
  size_t used = (size_t)snprintf(text, size, "OK");
  for (int i = 0; i < PLACIDO_GADGET_FAULTS && used < size; i++) {
    if (simulation->faults.left[i] > 0) {
      used += (size_t)snprintf(text + used, size - used, " %s %u",
                               placido_gadget_fault_name((enum placido_gadget_fault)i),
                               (unsigned)simulation->faults.left[i]);
    }
  }
  if (simulation->faults.slow_ms > 0 && used < size) {
    snprintf(text + used, size - used, " slow %d", simulation->faults.slow_ms);
  }
}

/* Does it, and says in `answer` what it did. */
static void obey(struct simulation *simulation, const struct sim_order *order, char *answer,
                 size_t size) {
  uint32_t *left = &simulation->faults.left[order->fault];
  snprintf(answer, size, "OK");
  switch (order->verb) {
  case SIM_FAULT:
    *left = order->number == 0 ? 0 : *left + (uint32_t)order->number;
    break;
  case SIM_DISCONNECT:
    placido_gadget_server_unplug(simulation->server, llround(order->number * 1e9));
    break;
  case SIM_SLOW:
    simulation->faults.slow_ms = (int)order->number;
    break;
  case SIM_LIST:
    describe_faults(simulation, answer, size);
    break;
  case SIM_QUIT:
    placido_gadget_server_stop(simulation->server);
    break;
  }
}

static int take_line(struct simulation *simulation, const char *line, placido_error *err) {
  char answer[ANSWER_BYTES];
  struct sim_order order;
  placido_error misread = {0};
  if (line[strspn(line, " \t\r")] == '\0') {
    return PLACIDO_OK;
  }
  if (sim_order_parse(&order, line, &misread) == PLACIDO_OK) {
    obey(simulation, &order, answer, sizeof answer);
  } else {
    snprintf(answer, sizeof answer, "ERROR %s", misread.text);
  }
  return tell(simulation, answer, err);
}

/* Standard input has something: as many lines as are whole. */
static int take_input(void *user, placido_error *err) {
  struct simulation *simulation = user;
  char *line = simulation->line;
  const ssize_t got = read(STDIN_FILENO, line + simulation->line_length,
                           LINE_BYTES - simulation->line_length);
  if (got <= 0) {
    return got < 0 && errno == EINTR ? PLACIDO_OK : PLACIDO_END;
  }
  simulation->line_length += (size_t)got;
  int status = PLACIDO_OK;
  char *end;
  while (status == PLACIDO_OK && (end = memchr(line, '\n', simulation->line_length))) {
    *end = '\0';
    status = take_line(simulation, line, err);
    simulation->line_length -= (size_t)(end + 1 - line);
    memmove(line, end + 1, simulation->line_length);
  }
  if (simulation->line_length == LINE_BYTES) {
    simulation->line_length = 0; /* no order is as long as that */
  }
  return status;
}

/* Gives the orders whose time has come; returns when the next is due. */
static int64_t take_time(void *user, int64_t now_ns) {
  struct simulation *simulation = user;
  struct sim_orders *orders = &simulation->orders;
  int64_t due_ns = INT64_MAX;
  char answer[ANSWER_BYTES];
  size_t kept = 0;
  for (size_t i = 0; i < orders->count; i++) {
    const struct sim_order order = orders->items[i];
    const int64_t at_ns = simulation->started_ns + order.at_ns;
    if (at_ns <= now_ns) {
      obey(simulation, &order, answer, sizeof answer);
    } else {
      due_ns = at_ns < due_ns ? at_ns : due_ns;
      orders->items[kept++] = order;
    }
  }
  orders->count = kept;
  return due_ns;
}

/* "PORT" or "ADDRESS:PORT". */
static int parse_listen(placido_gadget_server_options *options, char address[64],
                        const char *text, placido_error *err) {
  const char *colon = strrchr(text, ':');
  const char *port = colon ? colon + 1 : text;
  char *end;
  const long number = strtol(port, &end, 10);
  if (end == port || *end || number < 0 || number > 65535 || (colon && colon - text > 63)) {
    return placido_error_set(err, STATUS_USAGE,
                             "--listen %s: a TCP port or ADDRESS:PORT was expected", text);
  }
  options->tcp_port = (int)number;
  options->is_local = false;
  if (colon) {
    memcpy(address, text, (size_t)(colon - text));
    address[colon - text] = '\0';
    options->address = address;
  }
  return PLACIDO_OK;
}

/* Standard input, but -1 for a job in the background: to read its terminal would stop it. */
static int orders_descriptor(void) {
  const bool is_background = isatty(STDIN_FILENO) && tcgetpgrp(STDIN_FILENO) != getpgrp();
  return is_background ? -1 : STDIN_FILENO;
}

/* How the camera is to be plugged in; refuses what cannot be before anything is rendered. */
static int plan_plug(struct simulation *simulation, placido_error *err) {
  const struct settings *settings = simulation->settings;
  simulation->options = (placido_gadget_server_options){.gadget = &simulation->gadget,
                                                        .is_local = !settings->listen,
                                                        .descriptor = orders_descriptor(),
                                                        .readable = take_input,
                                                        .turned = take_time,
                                                        .user = simulation};
  simulation->gadget.speed = settings->high_speed ? PLACIDO_GADGET_HIGH : PLACIDO_GADGET_SUPER;
  return settings->listen
             ? parse_listen(&simulation->options, simulation->address, settings->listen, err)
             : placido_vhci_check(PLACIDO_VHCI_FOLDER, simulation->gadget.speed, err);
}

static int tell_ready(const struct simulation *simulation, placido_error *err) {
  char text[160];
  const int port = placido_gadget_server_port(simulation->server);
  if (simulation->options.is_local) {
    snprintf(text, sizeof text, "READY %s plugged in", simulation->face->name);
  } else {
    snprintf(text, sizeof text,
             "READY %s on TCP port %d: usbip --tcp-port %d attach -r THIS-MACHINE -b "
             PLACIDO_GADGET_BUS_ID, simulation->face->name, port, port);
  }
  return tell(simulation, text, err);
}

static int serve(struct simulation *simulation, placido_error *err) {
  const double for_s = simulation->settings->for_s;
  simulation->started_ns = placido_clock_now_ns();
  int status = placido_gadget_server_open(&simulation->server, &simulation->options, err);
  if (status == PLACIDO_OK) {
    status = tell_ready(simulation, err);
  }
  const int64_t until_ns = for_s > 0 ? simulation->started_ns + llround(for_s * 1e9) : INT64_MAX;
  return status == PLACIDO_OK ? placido_gadget_server_run(simulation->server, until_ns, err)
                              : status;
}

static void sum_up(const struct simulation *simulation, struct outcome *outcome) {
  placido_gadget_statistics statistics;
  simulation->face->statistics(simulation->gadget.state, &statistics);
  say(simulation->settings, "%llu pictures sent, %llu dropped",
      (unsigned long long)statistics.pictures, (unsigned long long)statistics.dropped);
  outcome->result = json_object();
  json_object_set_new(outcome->result, "pictures", json_integer((json_int_t)statistics.pictures));
  json_object_set_new(outcome->result, "dropped", json_integer((json_int_t)statistics.dropped));
  json_object_set_new(outcome->result, "commands", json_integer((json_int_t)statistics.commands));
}

static int run_camera(struct simulation *simulation, struct outcome *outcome,
                      placido_error *err) {
  const struct settings *settings = simulation->settings;
  int status = sim_view_open(&simulation->view, settings, outcome, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const placido_gadget_options options = {
      .view = simulation->view.view,
      .faults = &simulation->faults,
      .speed = simulation->gadget.speed,
      .serial = settings->serial ? settings->serial : DEFAULT_SERIAL,
      .zip = settings->zip};
  status = simulation->face->open(&simulation->gadget.state, &options, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  simulation->gadget.function = simulation->face->function;
  stages_end(&outcome->stages); /* what comes now is not waited for */
  status = serve(simulation, err);
  if (status == PLACIDO_OK) {
    sum_up(simulation, outcome);
  }
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct simulation *simulation = placido_memory_new(1, sizeof *simulation, err);
  if (!simulation) {
    return PLACIDO_MEMORY;
  }
  simulation->settings = settings;
  simulation->face = placido_gadget_face_by_name(settings->face ? settings->face : DEFAULT_FACE);
  int status = PLACIDO_OK;
  if (!simulation->face) {
    status = placido_error_set(err, STATUS_USAGE,
                               "--face %s: there is none of that name (placido help device-sim)",
                               settings->face);
  }
  if (status == PLACIDO_OK && settings->faults) {
    status = sim_orders_parse(&simulation->orders, settings->faults, err);
  }
  if (status == PLACIDO_OK) {
    status = plan_plug(simulation, err);
  }
  if (status == PLACIDO_OK) {
    status = run_camera(simulation, outcome, err);
  }
  placido_gadget_server_close(simulation->server);
  if (simulation->face) {
    simulation->face->close(simulation->gadget.state);
  }
  sim_view_close(&simulation->view);
  placido_memory_free(simulation);
  return status;
}

static void list_built_in(void) {
  size_t count;
  const placido_gadget_face *const *faces = placido_gadget_face_table(&count);
  puts("\nFaces");
  for (size_t i = 0; i < count; i++) {
    printf("  %-6s %s\n", faces[i]->name, faces[i]->summary);
  }
  printf("\nOrders, one a line of standard input\n  %s\n", sim_orders_words());
}

static const struct option_group *const groups[] = {&options_simulated, &options_general, NULL};

const struct command command_device_sim = {
    .name = "device-sim",
    .summary = "Be a camera that the kernel takes for a real one, showing an eye or a session.",
    .usage = "[SESSION] [OPTION...]",
    .examples =
        "  placido device-sim --eye keratoconus\n"
        "      as root, with the module vhci_hcd: the camera is plugged into this machine\n"
        "  placido device-sim eye.session --listen 3240 --faults \"stall@5s,drop*3@8s\"\n"
        "      another machine takes it with: usbip attach -r HOST -b 1-1\n",
    .groups = groups,
    .list = list_built_in,
    .may_have_word = true,
    .run = run,
};
