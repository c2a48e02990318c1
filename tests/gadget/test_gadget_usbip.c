/* The wire of a simulated device: packets as the kernel writes and reads them, and a server that
 * survives whatever comes. */
#include "base/clock.h"
#include "gadget/server.h"
#include "gadget/usbip.h"
#include "gadget/vhci.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#define TURNS_MAX 2000 /* of the loop, until something must have happened */

static const uint8_t device[18] = {18, 1, 0, 3, 0xEF, 2, 1, 9, 9, 0x12, 1, 0, 7, 1, 1, 2, 3, 1};
static const uint8_t configuration[] = {9, 2, 27, 0, 2, 1, 0, 0x80, 50, 9, 4, 0, 0, 0, 0xEF, 5, 0,
                                        0, 9, 4, 1, 0, 0, 0xEF, 5, 2, 0};

/* A device that gives back on endpoint 1 what it got, one packet at a time; endpoint 2 stalls. */
static struct {
  uint8_t bytes[1 << 17];
  size_t size;
  bool has_some, resets;
  int power_ups;
} echo;

static const uint8_t *give_descriptor(void *state, uint8_t type, uint8_t index, size_t *size) {
  (void)state;
  *size = type == 1 ? sizeof device : sizeof configuration;
  return index > 0 || type > 2 ? NULL : type == 1 ? device : configuration;
}

static enum placido_gadget_answer out(void *state, uint8_t endpoint, const uint8_t *bytes,
                                      size_t size) {
  (void)state;
  if (endpoint != 1 || size > sizeof echo.bytes) {
    return PLACIDO_GADGET_STALL;
  }
  if (echo.has_some) {
    return PLACIDO_GADGET_LATER;
  }
  if (size > 0) {
    memcpy(echo.bytes, bytes, size);
  }
  echo.size = size;
  echo.has_some = true;
  return PLACIDO_GADGET_DONE;
}

static enum placido_gadget_answer in(void *state, uint8_t endpoint, uint8_t *bytes, size_t size,
                                     size_t *sent) {
  (void)state;
  if (endpoint != 0x81) {
    return PLACIDO_GADGET_STALL;
  }
  if (!echo.has_some) {
    return PLACIDO_GADGET_LATER;
  }
  *sent = echo.size < size ? echo.size : size;
  memcpy(bytes, echo.bytes, *sent);
  echo.has_some = false;
  return PLACIDO_GADGET_DONE;
}

static void configured(void *state, uint8_t interface, uint8_t alternate) {
  (void)state;
  echo.power_ups += interface == 0xFF && alternate == 0;
}

static int resets(void *state) {
  (void)state;
  const bool does = echo.resets;
  echo.resets = false;
  return does;
}

static const placido_gadget_function function = {.name = "echo",
                                                 .descriptor = give_descriptor,
                                                 .out = out,
                                                 .in = in,
                                                 .configured = configured,
                                                 .resets = resets};

/* The kernel's end of the wire. */
static placido_gadget gadget;
static placido_gadget_server *server;
static int kernel;
static int plugs; /* how often the device was plugged in */
static int plug_status;

static int plug(void *user, int socket, enum placido_gadget_speed speed, placido_error *err) {
  (void)user;
  if (plug_status != PLACIDO_OK) {
    return placido_error_set(err, plug_status, "no port");
  }
  assert_int_equal(speed, PLACIDO_GADGET_SUPER);
  kernel = dup(socket);
  assert_true(kernel >= 0);
  plugs++;
  return PLACIDO_OK;
}

static void reset_state(void) {
  memset(&echo, 0, sizeof echo);
  gadget = (placido_gadget){.function = &function, .speed = PLACIDO_GADGET_SUPER};
  server = NULL;
  kernel = -1;
  plugs = 0;
  plug_status = PLACIDO_OK;
}

static int set_up(void **state) {
  (void)state;
  reset_state();
  const placido_gadget_server_options options = {
      .gadget = &gadget, .is_local = true, .plug = plug, .descriptor = -1};
  return placido_gadget_server_open(&server, &options, NULL);
}

static int set_up_tcp(void **state) {
  (void)state;
  reset_state();
  const placido_gadget_server_options options = {.gadget = &gadget, .descriptor = -1};
  return placido_gadget_server_open(&server, &options, NULL);
}

static int tear_down(void **state) {
  (void)state;
  placido_gadget_server_close(server);
  if (kernel >= 0) {
    close(kernel);
  }
  return 0;
}

static void put_u32(uint8_t *bytes, uint32_t value) {
  for (int i = 0; i < 4; i++) {
    bytes[i] = (uint8_t)(value >> 8 * (3 - i));
  }
}

static uint32_t get_u32(const uint8_t *bytes) {
  return (uint32_t)bytes[0] << 24 | (uint32_t)bytes[1] << 16 | (uint32_t)bytes[2] << 8 | bytes[3];
}

/* USBIP_CMD_SUBMIT as vhci_tx.c packs it. */
static void make_submit(uint8_t bytes[48], uint32_t sequence, bool is_in, uint32_t endpoint,
                        uint32_t size) {
  memset(bytes, 0, 48);
  put_u32(bytes, 1);
  put_u32(bytes + 4, sequence);
  put_u32(bytes + 8, 0x10002);
  put_u32(bytes + 12, is_in);
  put_u32(bytes + 16, endpoint);
  put_u32(bytes + 24, size);
}

static void write_all(const void *bytes, size_t size) {
  assert_int_equal(send(kernel, bytes, size, MSG_NOSIGNAL), (ssize_t)size);
}

static void submit(uint32_t sequence, bool is_in, uint32_t endpoint, const void *bytes,
                   uint32_t size) {
  uint8_t header[48];
  make_submit(header, sequence, is_in, endpoint, size);
  write_all(header, sizeof header);
  if (!is_in && size > 0) {
    write_all(bytes, size);
  }
}

static int turn(void) {
  return placido_gadget_server_turn(server, 2, NULL);
}

/* Reads `size` bytes, the server turning meanwhile; false where nothing comes. */
static bool read_all(uint8_t *bytes, size_t size) {
  for (int i = 0; i < TURNS_MAX && size > 0; i++) {
    assert_int_equal(turn(), PLACIDO_OK);
    const ssize_t got = recv(kernel, bytes, size, MSG_DONTWAIT);
    if (got > 0) {
      bytes += got;
      size -= (size_t)got;
    } else if (got == 0) {
      return false;
    } else {
      i += 10; /* nothing there: some more turns will do */
    }
  }
  return size == 0;
}

/* The next answer; checks its kind and number, returns its status. */
static int read_answer(uint32_t command, uint32_t sequence, uint8_t *bytes, size_t size) {
  uint8_t header[48];
  assert_true(read_all(header, sizeof header));
  assert_int_equal(get_u32(header), command);
  assert_int_equal(get_u32(header + 4), sequence);
  if (command == 3) {
    assert_int_equal(get_u32(header + 24), size);
  }
  assert_true(!bytes || read_all(bytes, size));
  return (int)get_u32(header + 20);
}

static void packets_have_the_kernels_layout(void **state) {
  (void)state;
  /* From Documentation/usb/usbip_protocol.rst: its example of a control transfer. */
  static const uint8_t documented[48] = {
      0, 0, 0, 1, 0, 0, 0x0D, 5, 0, 1, 0, 0x0F, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 2, 0,
      0, 0, 0, 0x40, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0, 0, 0, 0, 0, 0x80, 6, 0, 1, 0, 0, 0x40, 0};
  placido_usbip_request request;
  assert_int_equal(placido_usbip_request_decode(&request, documented, NULL), PLACIDO_OK);
  assert_int_equal(request.command, PLACIDO_USBIP_SUBMIT);
  assert_int_equal(request.sequence, 0x0D05);
  assert_int_equal(request.endpoint, 0);
  assert_true(request.is_in);
  assert_int_equal(request.size, 64);
  assert_int_equal(request.setup.request_type, 0x80);
  assert_int_equal(request.setup.request, 6);
  assert_int_equal(request.setup.value, 0x0100);
  assert_int_equal(request.setup.length, 64);
  uint8_t answer[48];
  placido_usbip_submitted_encode(answer, 0x0D05, PLACIDO_USBIP_STALLED, 18);
  assert_int_equal(get_u32(answer), 3);
  assert_int_equal(get_u32(answer + 4), 0x0D05);
  assert_int_equal((int)get_u32(answer + 20), -32);
  assert_int_equal(get_u32(answer + 24), 18);
}

static void claims_that_no_kernel_makes_are_refused(void **state) {
  (void)state;
  static const struct {
    int at;
    uint32_t value;
  } changes[] = {{0, 0},     {0, 3},           {12, 2},                {16, 16},
                 {16, 0x81}, {24, 0xFFFFFFFF}, {24, (16u << 20) + 1}, {32, 1}};
  uint8_t bytes[48];
  placido_usbip_request request;
  placido_error err;
  for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
    make_submit(bytes, 1, true, 1, 64);
    put_u32(bytes + changes[i].at, changes[i].value);
    err = (placido_error){0};
    assert_int_equal(placido_usbip_request_decode(&request, bytes, &err), PLACIDO_INPUT);
    assert_non_null(strstr(err.text, "USB/IP"));
  }
  make_submit(bytes, 1, true, 0, 64); /* data in, and a setup packet that says out */
  assert_int_equal(placido_usbip_request_decode(&request, bytes, NULL), PLACIDO_INPUT);
}

static void a_control_transfer_without_data_is_answered(void **state) {
  (void)state;
  uint8_t header[48];
  make_submit(header, 1, false, 0, 0);
  memcpy(header + 40, "\x80\x06\x00\x01\x00\x00\x12\x00", 8);
  write_all(header, sizeof header);
  assert_int_equal(read_answer(3, 1, NULL, 0), 0);
}

static void bulk_transfers_pass_through(void **state) {
  (void)state;
  uint8_t got[16];
  submit(1, true, 1, NULL, 16); /* waits, as there is nothing yet */
  submit(2, false, 1, "mires", 5);
  assert_int_equal(read_answer(3, 2, NULL, 5), 0);
  assert_int_equal(read_answer(3, 1, got, 5), 0);
  assert_memory_equal(got, "mires", 5);
}

static void transfers_of_an_endpoint_keep_their_order(void **state) {
  (void)state;
  uint8_t got[4];
  submit(1, false, 1, "one", 3);
  submit(2, false, 1, "two", 3);
  submit(3, true, 1, NULL, 4);
  submit(4, true, 1, NULL, 4);
  assert_int_equal(read_answer(3, 1, NULL, 3), 0);
  assert_int_equal(read_answer(3, 3, got, 3), 0);
  assert_memory_equal(got, "one", 3);
  assert_int_equal(read_answer(3, 2, NULL, 3), 0);
  assert_int_equal(read_answer(3, 4, got, 3), 0);
  assert_memory_equal(got, "two", 3);
}

static void control_transfers_carry_descriptors(void **state) {
  (void)state;
  uint8_t header[48], got[18];
  make_submit(header, 9, true, 0, 18);
  memcpy(header + 40, "\x80\x06\x00\x01\x00\x00\x12\x00", 8);
  write_all(header, sizeof header);
  assert_int_equal(read_answer(3, 9, got, 18), 0);
  assert_memory_equal(got, device, 18);
}

static void a_stall_is_a_broken_pipe(void **state) {
  (void)state;
  submit(1, true, 2, NULL, 512);
  assert_int_equal(read_answer(3, 1, NULL, 0), -32);
}

static void a_transfer_is_taken_back_or_answered_but_not_both(void **state) {
  (void)state;
  uint8_t unlink[48] = {0}, got[4];
  submit(1, true, 1, NULL, 4);
  put_u32(unlink, 2);
  put_u32(unlink + 4, 2);
  put_u32(unlink + 20, 1);
  write_all(unlink, sizeof unlink);
  assert_int_equal(read_answer(4, 2, NULL, 0), -104);
  submit(3, false, 1, "x", 1);
  assert_int_equal(read_answer(3, 3, NULL, 1), 0);
  submit(4, true, 1, NULL, 4); /* the byte is there still: nobody took it */
  assert_int_equal(read_answer(3, 4, got, 1), 0);
  put_u32(unlink + 4, 5);
  put_u32(unlink + 20, 4);
  write_all(unlink, sizeof unlink);
  assert_int_equal(read_answer(4, 5, NULL, 0), 0); /* answered before */
}

/* The answer is larger than a socket holds, and the host reads slowly. */
static void a_slow_host_gets_all_of_it(void **state) {
  (void)state;
  static uint8_t sent[1 << 17], got[1 << 17];
  for (size_t i = 0; i < sizeof sent; i++) {
    sent[i] = (uint8_t)(i * 7 + (i >> 8));
  }
  for (uint32_t round = 0; round < 20; round++) {
    uint8_t header[48];
    make_submit(header, 2 * round + 1, false, 1, sizeof sent);
    write_all(header, sizeof header);
    for (size_t at = 0; at < sizeof sent; at += 4096) {
      write_all(sent + at, 4096);
      assert_int_equal(turn(), PLACIDO_OK);
    }
    assert_int_equal(read_answer(3, 2 * round + 1, NULL, sizeof sent), 0);
    submit(2 * round + 2, true, 1, NULL, sizeof got);
    assert_int_equal(read_answer(3, 2 * round + 2, got, sizeof got), 0);
    assert_memory_equal(got, sent, sizeof got);
  }
}

static void unplugged_it_comes_back_as_after_power_up(void **state) {
  (void)state;
  uint8_t byte;
  submit(1, true, 1, NULL, 4);
  assert_int_equal(turn(), PLACIDO_OK);
  gadget.configuration = 1;
  placido_gadget_server_unplug(server, 20000000);
  assert_false(placido_gadget_server_is_attached(server));
  assert_int_equal(recv(kernel, &byte, 1, 0), 0);
  close(kernel);
  kernel = -1;
  assert_int_equal(gadget.configuration, 0);
  assert_int_equal(echo.power_ups, 1);
  const int64_t start_ns = placido_clock_now_ns();
  assert_int_equal(placido_gadget_server_run(server, start_ns + 5000000, NULL), PLACIDO_OK);
  assert_int_equal(plugs, 1);
  while (plugs == 1 && placido_clock_now_ns() < start_ns + 5000000000) {
    assert_int_equal(placido_gadget_server_turn(server, 100, NULL), PLACIDO_OK);
  }
  assert_int_equal(plugs, 2);
  bulk_transfers_pass_through(NULL); /* the old transfer is forgotten */
}

static void a_device_may_unplug_itself(void **state) {
  (void)state;
  submit(1, false, 1, "x", 1);
  assert_int_equal(read_answer(3, 1, NULL, 1), 0);
  echo.resets = true;
  submit(2, true, 1, NULL, 1);
  for (int i = 0; i < 10; i++) {
    assert_int_equal(turn(), PLACIDO_OK);
  }
  assert_false(placido_gadget_server_is_attached(server));
}

static void a_kernel_that_lets_go_ends_it(void **state) {
  (void)state;
  placido_error err = {0};
  close(kernel);
  kernel = -1;
  assert_int_equal(placido_gadget_server_run(server, INT64_MAX, &err), PLACIDO_GONE);
  assert_non_null(strstr(err.text, "unplugged"));
}

static void nonsense_from_the_kernel_ends_it(void **state) {
  (void)state;
  uint8_t header[48] = {0xFF};
  placido_error err = {0};
  write_all(header, sizeof header);
  assert_int_equal(placido_gadget_server_turn(server, 100, &err), PLACIDO_INPUT);
  assert_false(placido_gadget_server_is_attached(server));
}

/* The device is bounded in what it keeps for a host. */
static void transfers_without_number_are_refused(void **state) {
  (void)state;
  int status = PLACIDO_OK;
  uint8_t header[48];
  for (uint32_t i = 0; i < 3000 && status == PLACIDO_OK; i++) {
    make_submit(header, i, true, 1, 16u << 20);
    if (send(kernel, header, sizeof header, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) {
      assert_true(errno == EAGAIN);
    }
    status = turn();
  }
  assert_int_equal(status, PLACIDO_INPUT);
}

static void no_port_is_told(void **state) {
  (void)state;
  placido_gadget_server *none;
  placido_error err = {0};
  reset_state();
  plug_status = PLACIDO_SYSTEM;
  const placido_gadget_server_options options = {
      .gadget = &gadget, .is_local = true, .plug = plug, .descriptor = -1};
  assert_int_equal(placido_gadget_server_open(&none, &options, &err), PLACIDO_SYSTEM);
  assert_null(none);
  assert_string_equal(err.text, "no port");
}

static void call_up(void) {
  const struct sockaddr_in name = {.sin_family = AF_INET,
                                   .sin_port = htons((uint16_t)placido_gadget_server_port(server)),
                                   .sin_addr = {htonl(INADDR_LOOPBACK)}};
  if (kernel >= 0) {
    close(kernel);
  }
  kernel = socket(AF_INET, SOCK_STREAM, 0);
  assert_true(kernel >= 0);
  assert_int_equal(connect(kernel, (const struct sockaddr *)&name, sizeof name), 0);
  const int yes = 1; /* as the kernel's end */
  assert_int_equal(setsockopt(kernel, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes), 0);
}

static void the_list_tells_of_one_device(void **state) {
  (void)state;
  uint8_t head[12], described[312], interfaces[8], byte;
  call_up();
  write_all("\x01\x11\x80\x05\0\0\0\0", 8);
  assert_true(read_all(head, sizeof head));
  assert_memory_equal(head, "\x01\x11\0\x05\0\0\0\0\0\0\0\x01", 12);
  assert_true(read_all(described, sizeof described));
  assert_string_equal((char *)described + 256, PLACIDO_GADGET_BUS_ID);
  assert_int_equal(get_u32(described + 296), 5); /* super speed */
  /* vendor, product and version big-endian; class; configuration 1 of 1, two interfaces */
  assert_memory_equal(described + 300, "\x12\x09\0\x01\x01\x07\xEF\x02\x01\x01\x01\x02", 12);
  assert_true(read_all(interfaces, sizeof interfaces));
  assert_memory_equal(interfaces, "\xEF\x05\0\0\xEF\x05\x02\0", 8);
  assert_false(read_all(&byte, 1)); /* it hangs up */
}

static void import(const char *bus_id, uint32_t status) {
  uint8_t reply[8];
  char name[32] = {0};
  snprintf(name, sizeof name, "%s", bus_id);
  call_up();
  write_all("\x01\x11\x80\x03\0\0\0\0", 8);
  write_all(name, sizeof name);
  assert_true(read_all(reply, sizeof reply));
  assert_memory_equal(reply, "\x01\x11\0\x03", 4);
  assert_int_equal(get_u32(reply + 4), status);
}

static void imported_over_tcp_it_works_like_plugged_in(void **state) {
  (void)state;
  uint8_t described[312];
  import("2-7", 1);
  assert_false(placido_gadget_server_is_attached(server));
  import(PLACIDO_GADGET_BUS_ID, 0);
  assert_true(read_all(described, sizeof described));
  assert_true(placido_gadget_server_is_attached(server));
  bulk_transfers_pass_through(NULL);
  import(PLACIDO_GADGET_BUS_ID, 0); /* again, after it was let go */
  assert_true(read_all(described, sizeof described));
  bulk_transfers_pass_through(NULL);
}

static void strangers_are_hung_up_on(void **state) {
  (void)state;
  uint8_t byte;
  call_up();
  write_all("GET / HTTP/1.1\r\n\r\n", 18);
  assert_false(read_all(&byte, 1));
  the_list_tells_of_one_device(NULL);
}

static int write_text(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  return file && fputs(text, file) >= 0 && fclose(file) == 0;
}

/* The kernel's two files, played by a folder. */
static void a_free_port_of_the_speed_is_taken(void **state) {
  (void)state;
  char folder[] = "/tmp/placido-vhci-XXXXXX", path[64], line[64] = "";
  placido_error err = {0};
  int port = -1;
  assert_non_null(mkdtemp(folder));
  assert_int_equal(placido_vhci_attach(folder, &port, 7, PLACIDO_GADGET_SUPER, &err),
                   PLACIDO_UNSUPPORTED);
  assert_non_null(strstr(err.text, "modprobe vhci_hcd"));
  snprintf(path, sizeof path, "%s/status", folder);
  assert_true(write_text(path,
                         "hub port sta spd dev      sockfd local_busid\n"
                         "hs  0000 004 000 00000000 000000 0-0\n"
                         "ss  0008 006 005 00010002 000005 2-1\n"
                         "ss  0009 004 000 00000000 000000 0-0\n"
                         "ss  0010 004 000 00000000 000000 0-0\n"));
  assert_int_equal(placido_vhci_attach(folder, &port, 7, PLACIDO_GADGET_SUPER, &err),
                   PLACIDO_SYSTEM);
  snprintf(path, sizeof path, "%s/attach", folder);
  assert_true(write_text(path, ""));
  assert_int_equal(placido_vhci_check(folder, PLACIDO_GADGET_HIGH, &err), PLACIDO_OK);
  assert_int_equal(placido_vhci_attach(folder, &port, 7, PLACIDO_GADGET_SUPER, &err), PLACIDO_OK);
  assert_int_equal(port, 9);
  port = 10; /* back where it was */
  assert_int_equal(placido_vhci_attach(folder, &port, 7, PLACIDO_GADGET_SUPER, &err), PLACIDO_OK);
  assert_int_equal(port, 10);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  assert_non_null(fgets(line, sizeof line, file));
  fclose(file);
  assert_string_equal(line, "10 7 65538 5");
  unlink(path);
  snprintf(path, sizeof path, "%s/status", folder);
  unlink(path);
  rmdir(folder);
}

#define LOCAL(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
#define TCP(name) cmocka_unit_test_setup_teardown(name, set_up_tcp, tear_down)

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(packets_have_the_kernels_layout),
      cmocka_unit_test(claims_that_no_kernel_makes_are_refused),
      cmocka_unit_test(no_port_is_told),
      cmocka_unit_test(a_free_port_of_the_speed_is_taken),
      LOCAL(bulk_transfers_pass_through),
      LOCAL(transfers_of_an_endpoint_keep_their_order),
      LOCAL(control_transfers_carry_descriptors),
      LOCAL(a_control_transfer_without_data_is_answered),
      LOCAL(a_stall_is_a_broken_pipe),
      LOCAL(a_transfer_is_taken_back_or_answered_but_not_both),
      LOCAL(a_slow_host_gets_all_of_it),
      LOCAL(unplugged_it_comes_back_as_after_power_up),
      LOCAL(a_device_may_unplug_itself),
      LOCAL(a_kernel_that_lets_go_ends_it),
      LOCAL(nonsense_from_the_kernel_ends_it),
      LOCAL(transfers_without_number_are_refused),
      TCP(the_list_tells_of_one_device),
      TCP(imported_over_tcp_it_works_like_plugged_in),
      TCP(strangers_are_hung_up_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
