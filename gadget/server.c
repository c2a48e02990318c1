/* The loop of a simulated device: a socket, a clock, and whoever gives commands. Without waiting
 * anywhere but in one poll. */
#include "gadget/server.h"

#include "base/clock.h"
#include "base/memory.h"
#include "gadget/introduction.h"
#include "gadget/listen.h"
#include "gadget/transfers.h"
#include "gadget/vhci.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define NS_PER_MS 1000000
#define GREETING_NS 5000000000 /* for a client of TCP to say what it wants */
#define POWER_UP_NS 1000000000 /* that a device which resets itself is away */
#define SEND_BYTES (4 << 20)   /* of the socket: a few transfers, so that the loop seldom waits */

/* What the bytes that come next are. */
enum stage { GREETING, BUS_ID, REQUEST, DATA };

struct placido_gadget_server {
  placido_gadget_server_options options;
  placido_gadget_wire wire;
  placido_gadget_transfers transfers;
  enum stage stage;
  uint8_t header[PLACIDO_USBIP_HEADER_BYTES]; /* of what comes in */
  int listener;                               /* -1: local */
  int vhci_port;
  int64_t back_ns;     /* not plugged in until then */
  int64_t deadline_ns; /* of a greeting */
  bool is_leaving;     /* hangs up as soon as the answer is sent */
  bool is_stopped;
};

static int system_error(const char *what, placido_error *err) {
  return placido_error_set(err, PLACIDO_SYSTEM, "%s: %s", what, strerror(errno));
}

static int plug_into_kernel(void *user, int socket, enum placido_gadget_speed speed,
                            placido_error *err) {
  placido_gadget_server *server = user;
  return placido_vhci_attach(PLACIDO_VHCI_FOLDER, &server->vhci_port, socket, speed, err);
}

/* As after power-up: nothing chosen, nothing halted. */
static void reset_gadget(placido_gadget *gadget) {
  gadget->configuration = 0;
  gadget->halted_in = gadget->halted_out = 0;
  memset(gadget->alternates, 0, sizeof gadget->alternates);
  if (gadget->function->configured) {
    gadget->function->configured(gadget->state, 0xFF, 0);
  }
}

static void take_socket(placido_gadget_server *server, int socket, enum stage stage) {
  const int size = SEND_BYTES;
  /* The first asks for more than the system's limit, which root may; without it is only slower. */
  if (setsockopt(socket, SOL_SOCKET, SO_SNDBUFFORCE, &size, sizeof size) != 0) {
    (void)setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &size, sizeof size);
  }
  placido_gadget_wire_open(&server->wire, socket);
  server->stage = stage;
  server->is_leaving = false;
  placido_gadget_wire_expect(&server->wire, server->header,
                             stage == GREETING ? PLACIDO_USBIP_GREETING_BYTES
                                               : PLACIDO_USBIP_HEADER_BYTES);
}

static void hang_up(placido_gadget_server *server) {
  placido_gadget_wire_hang_up(&server->wire);
  placido_gadget_transfers_clear(&server->transfers);
  reset_gadget(server->options.gadget);
}

static int plug_in(placido_gadget_server *server, placido_error *err) {
  const placido_gadget_server_options *options = &server->options;
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    return system_error("a pair of sockets", err);
  }
  const int status =
      options->plug ? options->plug(options->user, ends[1], options->gadget->speed, err)
                    : plug_into_kernel(server, ends[1], options->gadget->speed, err);
  close(ends[1]);
  if (status != PLACIDO_OK) {
    close(ends[0]);
    return status;
  }
  take_socket(server, ends[0], REQUEST);
  return PLACIDO_OK;
}

int placido_gadget_server_open(placido_gadget_server **out,
                               const placido_gadget_server_options *options, placido_error *err) {
  *out = NULL;
  placido_gadget_server *server = placido_memory_new(1, sizeof *server, err);
  if (!server) {
    return PLACIDO_MEMORY;
  }
  server->options = *options;
  server->listener = server->vhci_port = server->wire.socket = -1;
  const char *address = options->address ? options->address : "127.0.0.1";
  const int status =
      options->is_local
          ? plug_in(server, err)
          : placido_gadget_listen(&server->listener, address, options->tcp_port, err);
  if (status != PLACIDO_OK) {
    placido_gadget_server_close(server);
    return status;
  }
  *out = server;
  return PLACIDO_OK;
}

void placido_gadget_server_close(placido_gadget_server *server) {
  if (!server) {
    return;
  }
  placido_gadget_wire_free(&server->wire);
  placido_gadget_transfers_free(&server->transfers);
  if (server->listener >= 0) {
    close(server->listener);
  }
  placido_memory_free(server);
}

int placido_gadget_server_port(const placido_gadget_server *server) {
  return placido_gadget_listen_port(server->listener);
}

bool placido_gadget_server_is_attached(const placido_gadget_server *server) {
  return server->wire.socket >= 0 && (server->stage == REQUEST || server->stage == DATA);
}

void placido_gadget_server_stop(placido_gadget_server *server) {
  server->is_stopped = true;
}

void placido_gadget_server_unplug(placido_gadget_server *server, int64_t away_ns) {
  hang_up(server);
  server->back_ns = placido_clock_now_ns() + away_ns;
}

/* Every `take_` handles one whole piece of what comes in, and says what is expected next. A status
 * of PLACIDO_INPUT ends the connection. */
static int take_greeting(placido_gadget_server *server, placido_error *err) {
  enum placido_usbip_greeting greeting;
  const int status = placido_usbip_greeting_decode(&greeting, server->header, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (greeting == PLACIDO_USBIP_LIST) {
    server->is_leaving = true;
    return placido_gadget_introduce(&server->wire, server->options.gadget, greeting, err);
  }
  server->stage = BUS_ID;
  placido_gadget_wire_expect(&server->wire, server->header, PLACIDO_USBIP_BUS_ID_BYTES);
  return PLACIDO_OK;
}

static int take_bus_id(placido_gadget_server *server, placido_error *err) {
  if (memcmp(server->header, PLACIDO_GADGET_BUS_ID, sizeof PLACIDO_GADGET_BUS_ID) != 0) {
    server->is_leaving = true;
    return placido_gadget_turn_away(&server->wire, err);
  }
  server->stage = REQUEST;
  placido_gadget_wire_expect(&server->wire, server->header, PLACIDO_USBIP_HEADER_BYTES);
  return placido_gadget_introduce(&server->wire, server->options.gadget, PLACIDO_USBIP_IMPORT,
                                  err);
}

static int take_unlink(placido_gadget_server *server, const placido_usbip_request *request,
                       placido_error *err) {
  const bool was_there = placido_gadget_transfers_unlink(&server->transfers, request->unlinked);
  uint8_t *answer = placido_gadget_wire_room(&server->wire, PLACIDO_USBIP_HEADER_BYTES, err);
  if (!answer) {
    return PLACIDO_MEMORY;
  }
  placido_usbip_unlinked_encode(answer, request->sequence,
                                was_there ? PLACIDO_USBIP_UNLINKED : 0);
  placido_gadget_wire_send(&server->wire, PLACIDO_USBIP_HEADER_BYTES);
  return PLACIDO_OK;
}

static int take_request(placido_gadget_server *server, placido_error *err) {
  placido_usbip_request request;
  int status = placido_usbip_request_decode(&request, server->header, err);
  placido_gadget_wire_expect(&server->wire, server->header, PLACIDO_USBIP_HEADER_BYTES);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (request.command == PLACIDO_USBIP_UNLINK) {
    return take_unlink(server, &request, err);
  }
  uint8_t *bytes;
  status = placido_gadget_transfers_add(&server->transfers, &request, &bytes, err);
  if (status == PLACIDO_OK && bytes) {
    server->stage = DATA;
    placido_gadget_wire_expect(&server->wire, bytes, request.size);
  }
  return status;
}

static int take_data(placido_gadget_server *server, placido_error *err) {
  (void)err;
  server->stage = REQUEST;
  placido_gadget_wire_expect(&server->wire, server->header, PLACIDO_USBIP_HEADER_BYTES);
  return PLACIDO_OK;
}

static int (*const takers[])(placido_gadget_server *server, placido_error *err) = {
    [GREETING] = take_greeting,
    [BUS_ID] = take_bus_id,
    [REQUEST] = take_request,
    [DATA] = take_data,
};

/* Answers what can be answered; not while the bytes of the last transfer are still coming. */
static int answer(placido_gadget_server *server, placido_error *err) {
  placido_gadget *gadget = server->options.gadget;
  if (server->stage != REQUEST || server->wire.socket < 0) {
    return PLACIDO_OK;
  }
  const int status =
      placido_gadget_transfers_answer(&server->transfers, gadget, &server->wire, err);
  if (gadget->function->resets && gadget->function->resets(gadget->state)) {
    placido_gadget_server_unplug(server, POWER_UP_NS);
  }
  return status;
}

/* Handles all that is there, until the wire is busy with an answer: the host is read no further
 * than it reads. */
static int receive(placido_gadget_server *server, placido_error *err) {
  int status = PLACIDO_OK;
  while (status == PLACIDO_OK && server->wire.socket >= 0 && !server->is_leaving &&
         !placido_gadget_wire_is_busy(&server->wire)) {
    status = placido_gadget_wire_receive(&server->wire);
    if (status == PLACIDO_OK) {
      status = takers[server->stage](server, err);
    }
    if (status == PLACIDO_OK) {
      status = answer(server, err);
    }
  }
  return status == PLACIDO_TIMEOUT ? PLACIDO_OK : status;
}

static void accept_client(placido_gadget_server *server, int64_t now_ns) {
  const int client = placido_gadget_listen_accept(server->listener);
  if (client >= 0) {
    take_socket(server, client, GREETING);
    server->deadline_ns = now_ns + GREETING_NS;
  }
}

/* The connection is over. A local kernel that lets go is the end; over TCP the next may come. */
static int end_connection(placido_gadget_server *server, int status, placido_error *err) {
  const bool is_local = server->options.is_local;
  if (status == PLACIDO_MEMORY) {
    return status;
  }
  hang_up(server);
  if (is_local && status == PLACIDO_GONE) {
    return placido_error_set(err, PLACIDO_GONE, "the kernel has unplugged the simulated device");
  }
  return is_local ? status : PLACIDO_OK;
}

static bool is_greeting(const placido_gadget_server *server) {
  return server->wire.socket >= 0 && (server->stage == GREETING || server->stage == BUS_ID);
}

static int serve_wire(placido_gadget_server *server, short events, int64_t now_ns,
                      placido_error *err) {
  int status = PLACIDO_OK;
  if (is_greeting(server) && now_ns >= server->deadline_ns) {
    status = PLACIDO_GONE;
  }
  if (status == PLACIDO_OK && events & POLLOUT) {
    status = placido_gadget_wire_flush(&server->wire);
  }
  if (status == PLACIDO_OK) {
    status = answer(server, err);
  }
  if (status == PLACIDO_OK && events & (POLLIN | POLLHUP | POLLERR)) {
    status = receive(server, err);
  }
  if (status == PLACIDO_OK && server->is_leaving &&
      !placido_gadget_wire_is_busy(&server->wire)) {
    status = PLACIDO_GONE;
  }
  return status == PLACIDO_OK ? PLACIDO_OK : end_connection(server, status, err);
}

/* Milliseconds to wait, so that nothing that is due at `due_ns` comes early. */
static int patience_ms(int64_t now_ns, int64_t due_ns, int timeout_ms) {
  if (due_ns <= now_ns) {
    return 0;
  }
  const int64_t wait_ms = (due_ns - now_ns) / NS_PER_MS + ((due_ns - now_ns) % NS_PER_MS != 0);
  return timeout_ms >= 0 && timeout_ms < wait_ms ? timeout_ms
         : wait_ms < 60000                       ? (int)wait_ms
                                                 : 60000;
}

static int64_t sooner(int64_t a_ns, int64_t b_ns) {
  return a_ns < b_ns ? a_ns : b_ns;
}

/* Lets the gadget and the caller know the time, answers what has become ready, and puts the plug in
 * again; `*due_ns` is when the next of it is to be done. */
static int live(placido_gadget_server *server, int64_t now_ns, int64_t *due_ns,
                placido_error *err) {
  const placido_gadget_server_options *options = &server->options;
  int status = PLACIDO_OK;
  *due_ns = options->turned ? options->turned(options->user, now_ns) : INT64_MAX;
  if (options->is_local && server->wire.socket < 0 && now_ns >= server->back_ns) {
    status = plug_in(server, err);
  }
  *due_ns = sooner(*due_ns, placido_gadget_tick(options->gadget, now_ns));
  if (status == PLACIDO_OK && server->wire.socket >= 0) {
    status = serve_wire(server, 0, now_ns, err);
    /* What was answered may have made the gadget want to be called earlier. */
    *due_ns = sooner(*due_ns, placido_gadget_tick(options->gadget, now_ns));
  }
  if (server->wire.socket < 0 && server->back_ns > now_ns) {
    *due_ns = sooner(*due_ns, server->back_ns);
  }
  if (is_greeting(server)) {
    *due_ns = sooner(*due_ns, server->deadline_ns);
  }
  return status;
}

int placido_gadget_server_turn(placido_gadget_server *server, int timeout_ms,
                               placido_error *err) {
  enum { WIRE, LISTENER, COMMANDS, DESCRIPTORS };
  int64_t now_ns = placido_clock_now_ns(), due_ns;
  int status = live(server, now_ns, &due_ns, err);
  if (status != PLACIDO_OK || server->is_stopped) {
    return status;
  }
  const bool is_free = server->wire.socket < 0 && now_ns >= server->back_ns;
  struct pollfd polled[DESCRIPTORS] = {
      [WIRE] = {.fd = server->wire.socket,
                .events = placido_gadget_wire_is_busy(&server->wire) ? POLLOUT : POLLIN},
      [LISTENER] = {.fd = is_free ? server->listener : -1, .events = POLLIN},
      [COMMANDS] = {.fd = server->options.descriptor, .events = POLLIN},
  };
  if (poll(polled, DESCRIPTORS, patience_ms(now_ns, due_ns, timeout_ms)) < 0) {
    return errno == EINTR ? PLACIDO_OK : system_error("poll", err);
  }
  now_ns = placido_clock_now_ns();
  (void)placido_gadget_tick(server->options.gadget, now_ns); /* commands find the time right */
  if (polled[LISTENER].revents) {
    accept_client(server, now_ns);
  }
  if (polled[WIRE].revents) {
    status = serve_wire(server, polled[WIRE].revents, now_ns, err);
  }
  if (status == PLACIDO_OK && polled[COMMANDS].revents) {
    status = server->options.readable(server->options.user, err);
    if (status == PLACIDO_END) {
      server->options.descriptor = -1;
      status = PLACIDO_OK;
    }
  }
  return status;
}

int placido_gadget_server_run(placido_gadget_server *server, int64_t until_ns,
                              placido_error *err) {
  int status = PLACIDO_OK;
  int64_t now_ns = placido_clock_now_ns();
  while (status == PLACIDO_OK && !server->is_stopped && now_ns < until_ns) {
    status = placido_gadget_server_turn(server, patience_ms(now_ns, until_ns, -1), err);
    now_ns = placido_clock_now_ns();
  }
  return status;
}
