/* What a host may write to a simulated device: USB/IP packets, with the camera's own commands in
 * them, through the real server and into the real camera. */
#include "gadget/server.h"
#include "gadget/u3v.h"
#include "gadget/usbip.h"
#include "tests/fuzz/target.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define WIDTH 32
#define HEIGHT 16

static const placido_frame *look(void *user, int64_t t_ns) {
  (void)t_ns;
  return user;
}

static int plug(void *user, int socket, enum placido_gadget_speed speed, placido_error *err) {
  (void)speed;
  (void)err;
  *(int *)user = dup(socket);
  return *(int *)user >= 0 ? PLACIDO_OK : PLACIDO_SYSTEM;
}

/* The server reads what was written, and answers; nobody minds the answers. */
static int serve(placido_gadget_server *server, int kernel) {
  static uint8_t answers[1 << 16];
  int status = PLACIDO_OK;
  for (int i = 0; i < 4 && status == PLACIDO_OK; i++) {
    status = placido_gadget_server_turn(server, 0, NULL);
    while (recv(kernel, answers, sizeof answers, MSG_DONTWAIT) > 0) {
    }
  }
  return status;
}

static void play(placido_gadget *gadget, const uint8_t *data, size_t size) {
  int kernel = -1;
  const placido_gadget_server_options options = {
      .gadget = gadget, .is_local = true, .plug = plug, .user = &kernel, .descriptor = -1};
  placido_gadget_server *server;
  if (placido_gadget_server_open(&server, &options, NULL) != PLACIDO_OK) {
    return;
  }
  int status = PLACIDO_OK;
  while (size > 0 && status == PLACIDO_OK) {
    const size_t piece = size < 4096 ? size : 4096;
    if (send(kernel, data, piece, MSG_NOSIGNAL | MSG_DONTWAIT) != (ssize_t)piece) {
      break;
    }
    data += piece;
    size -= piece;
    status = serve(server, kernel);
  }
  placido_gadget_server_close(server);
  close(kernel);
}

static void play_pure(const uint8_t *data, size_t size) {
  placido_usbip_request request;
  enum placido_usbip_greeting greeting;
  uint8_t bytes[PLACIDO_USBIP_DEVICE_BYTES], interfaces[64];
  const placido_usbip_description description = {.bus_id = "1-1",
                                                 .speed = PLACIDO_GADGET_SUPER,
                                                 .device = data,
                                                 .device_size = size,
                                                 .configuration = data,
                                                 .configuration_size = size};
  if (size >= PLACIDO_USBIP_HEADER_BYTES) {
    (void)placido_usbip_request_decode(&request, data, NULL);
    (void)placido_usbip_greeting_decode(&greeting, data, NULL);
  }
  (void)placido_usbip_device_encode(bytes, &description, NULL);
  (void)placido_usbip_interfaces_encode(interfaces, sizeof interfaces, &description);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static uint8_t samples[WIDTH * HEIGHT];
  placido_frame scene = {.width_px = WIDTH,
                         .height_px = HEIGHT,
                         .stride_bytes = WIDTH,
                         .format = PLACIDO_MONO8,
                         .bits = 8,
                         .data = samples};
  const placido_gadget_options options = {.view = {look, &scene, WIDTH, HEIGHT, 500},
                                          .speed = PLACIDO_GADGET_SUPER,
                                          .serial = "FUZZ"};
  placido_gadget gadget = {.function = placido_u3v_face.function, .speed = PLACIDO_GADGET_SUPER};
  play_pure(data, size);
  if (placido_u3v_face.open(&gadget.state, &options, NULL) == PLACIDO_OK) {
    play(&gadget, data, size);
  }
  placido_u3v_face.close(gadget.state);
  return 0;
}
