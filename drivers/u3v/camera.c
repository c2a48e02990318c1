/* A USB3 Vision camera: found by serial number, name or place, opened, its description read. */
#include "drivers/u3v/camera.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

/* How well an address fits: a serial number before a name that a user gave. */
enum fit { NOT, BY_NAME, BY_SERIAL };

struct search {
  const char *address;
  placido_u3v_found *found;
  enum fit best;
  int best_count, camera_count;
  char places[300]; /* of those that fit best, as addresses */
  char others[300]; /* of all */
};

static enum fit fit_of(const placido_u3v_found *device, const char *address) {
  if (strncmp(address, "place=", 6) == 0) {
    return strcmp(device->place, address + 6) == 0 ? BY_SERIAL : NOT;
  }
  if (!address[0] || strcmp(device->serial, address) == 0) {
    return BY_SERIAL;
  }
  return strcmp(device->user_name, address) == 0 ? BY_NAME : NOT;
}

static void append(char text[300], const placido_u3v_found *device) {
  const size_t length = strlen(text);
  snprintf(text + length, 300 - length, "%s%s (u3v:place=%s, serial %s)", length ? ", " : "",
           device->model, device->place, device->serial[0] ? device->serial : "unknown");
}

static int weigh(void *user, const placido_u3v_found *device) {
  struct search *search = user;
  const enum fit fit = fit_of(device, search->address);
  search->camera_count++;
  append(search->others, device);
  if (fit == NOT || fit < search->best) {
    return 0;
  }
  if (fit > search->best) {
    search->best = fit;
    search->best_count = 0;
    search->places[0] = '\0';
    *search->found = *device;
  }
  search->best_count++;
  append(search->places, device);
  return 0;
}

int placido_u3v_camera_find(placido_u3v_found *found, const placido_u3v_calls *calls,
                            const char *address, placido_error *err) {
  struct search search = {.address = address, .found = found};
  *found = (placido_u3v_found){0};
  const int status = calls->each(calls->context, weigh, &search, err);
  if (status) {
    return status;
  }
  if (search.camera_count == 0) {
    return placido_error_set(err, PLACIDO_GONE, "no USB3 Vision camera is plugged in");
  }
  if (search.best_count == 0) {
    return placido_error_set(err, PLACIDO_GONE, "no USB3 Vision camera \"%.64s\"; there is %s",
                             address, search.others);
  }
  if (search.best_count > 1) {
    return placido_error_set(err, PLACIDO_INPUT, "u3v:%.64s fits %d cameras: %s", address,
                             search.best_count, search.places);
  }
  return PLACIDO_OK;
}

static int read_register(void *user, uint64_t address, void *bytes, size_t size,
                         placido_error *err) {
  return placido_u3v_channel_read(user, address, bytes, size, err);
}

static int write_register(void *user, uint64_t address, const void *bytes, size_t size,
                          placido_error *err) {
  return placido_u3v_channel_write(user, address, bytes, size, err);
}

static int read_description(placido_u3v_camera *camera, placido_error *err) {
  char *xml;
  size_t size;
  const int status = placido_u3v_description_read(&xml, &size, &camera->channel, err);
  if (status) {
    return status;
  }
  const placido_genicam_port port = {
      .read = read_register, .write = write_register, .user = &camera->channel};
  const int read = placido_genicam_read(&camera->features, xml, size, &port, err);
  placido_memory_free(xml);
  return read;
}

int placido_u3v_camera_open(placido_u3v_camera *camera, const placido_u3v_found *found,
                            const placido_u3v_calls *calls, placido_error *err) {
  *camera = (placido_u3v_camera){.calls = calls, .found = *found};
  int status = calls->open(calls->context, &camera->pipe, found, err);
  if (status) {
    camera->pipe = NULL;
    return status;
  }
  status = placido_u3v_channel_open(&camera->channel, calls, camera->pipe,
                                    (size_t)found->control_packet_bytes, err);
  if (!status) {
    status = placido_u3v_bootstrap_read(&camera->bootstrap, &camera->channel, err);
  }
  if (!status) {
    status = read_description(camera, err);
  }
  if (status) {
    placido_u3v_camera_close(camera);
  }
  return status;
}

void placido_u3v_camera_abandon(placido_u3v_camera *camera) {
  placido_genicam_free(camera->features);
  placido_u3v_channel_close(&camera->channel);
  camera->features = NULL;
  camera->pipe = NULL;
}

void placido_u3v_camera_close(placido_u3v_camera *camera) {
  void *pipe = camera->pipe;
  if (pipe) {
    placido_u3v_camera_abandon(camera);
    camera->calls->close(pipe);
  }
}
