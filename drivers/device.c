/* A device opened by URI: finds the driver, guards the order of calls and the controls' ranges. */
#include "drivers/device.h"

#include "base/memory.h"
#include "base/text.h"
#include "drivers/replug.h"
#include "drivers/settings.h"

#include <placido/device.h>

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

struct placido_device {
  const placido_driver *driver;
  void *state;
  bool started;
  placido_replug replug;
};

/* The setting of an address that every device has. */
#define PATIENCE "replug_s"

static const placido_driver *find_driver(const char *scheme, size_t length) {
  size_t count;
  const placido_driver *const *drivers = placido_driver_table(&count);
  for (size_t i = 0; i < count; i++) {
    if (strlen(drivers[i]->scheme) == length && strncmp(drivers[i]->scheme, scheme, length) == 0) {
      return drivers[i];
    }
  }
  return NULL;
}

static bool exists(const char *path) {
  return access(path, F_OK) == 0;
}

/* The length of what looks like a scheme before a colon: two or more letters and digits. */
static size_t scheme_length(const char *uri) {
  size_t length = strspn(uri, "abcdefghijklmnopqrstuvwxyz0123456789");
  return length >= 2 && uri[length] == ':' ? length : 0;
}

/* The driver of a URI and what stands behind its colon. A path that exists is replayed, whatever
 * colons it has. */
static int choose_driver(const placido_driver **driver, const char **address, const char *uri,
                         placido_error *err) {
  size_t length = exists(uri) ? 0 : scheme_length(uri);
  *driver = length > 0 ? find_driver(uri, length) : find_driver("replay", strlen("replay"));
  *address = length > 0 ? uri + length + 1 : uri;
  if (!*driver) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "no driver \"%.*s\" in this build (and no file %s)",
                             (int)(length > 32 ? 32 : length), uri, placido_text_tail(uri));
  }
  return PLACIDO_OK;
}

/* Whether open has read a setting already. */
static bool is_option(const placido_device *device, const char *setting) {
  const size_t length = strcspn(setting, "=");
  const char *const *option = device->driver->options;
  while (option && *option && (strlen(*option) != length || strncmp(*option, setting, length))) {
    option++;
  }
  return option && *option;
}

/* Notes where the device took another value than it was asked to. */
static void note_difference(placido_device *device, const char *name, double asked,
                            placido_notes *notes) {
  double got;
  if (placido_device_get(device, name, &got, NULL) == PLACIDO_OK &&
      fabs(got - asked) > 1e-6 * fabs(asked)) {
    placido_notes_add(notes, "the device took %s=%.8g, not %.8g as asked", name, got, asked);
  }
}

static int set_patience(placido_device *device, double replug_s, bool by_address,
                        placido_error *err) {
  placido_replug *replug = &device->replug;
  if (!(replug_s >= 0 && replug_s <= PLACIDO_REPLUG_MAX_S)) {
    return placido_error_set(err, PLACIDO_INPUT, "%s=%g: it ranges from 0 to %d seconds", PATIENCE,
                             replug_s, PLACIDO_REPLUG_MAX_S);
  }
  if (by_address || !replug->is_address_patient) {
    replug->patience_s = replug_s;
    replug->is_address_patient = by_address;
  }
  return PLACIDO_OK;
}

static int set_by_address(placido_device *device, const char *name, double value,
                          placido_notes *notes, placido_error *err) {
  if (strcmp(name, PATIENCE) == 0) {
    return set_patience(device, value, true, err);
  }
  const int status = placido_device_set(device, name, value, err);
  if (!status) {
    note_difference(device, name, value, notes);
  }
  return status;
}

/* Sets one "control=value" of a query. */
static int apply_setting(placido_device *device, const char *setting, placido_notes *notes,
                         placido_error *err) {
  if (is_option(device, setting)) {
    return PLACIDO_OK;
  }
  char name[64] = "";
  const char *equals = strchr(setting, '=');
  size_t length = equals ? (size_t)(equals - setting) : strlen(setting);
  if (equals && length < sizeof name) {
    memcpy(name, setting, length);
    double value;
    if (placido_setting_read_number(&value, equals + 1)) {
      return set_by_address(device, name, value, notes, err);
    }
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "\"%.100s\" in the device's address is not CONTROL=NUMBER", setting);
}

static int apply_query(placido_device *device, char *query, placido_notes *notes,
                       placido_error *err) {
  int status = PLACIDO_OK;
  while (!status && query && *query) {
    char *next = strchr(query, '&');
    if (next) {
      *next++ = '\0';
    }
    status = apply_setting(device, query, notes, err);
    query = next;
  }
  return status;
}

/* Opens an address of which the caller gives a copy to cut up: "ADDRESS?control=value&...". */
static int open_address(placido_device *device, char *address, placido_notes *notes,
                        placido_error *err) {
  char *query = exists(address) ? NULL : strrchr(address, '?');
  if (query && !device->driver->options) {
    *query = '\0';
  }
  int status = device->driver->open(&device->state, address, notes, err);
  return status || !query ? status : apply_query(device, query + 1, notes, err);
}

int placido_device_open_with(placido_device **device, const placido_driver *driver,
                             const placido_clock *clock, const char *address,
                             placido_notes *notes, placido_error *err) {
  *device = NULL;
  placido_device *opened = placido_memory_new(1, sizeof *opened, err);
  char *copy = opened ? placido_memory_string(address, err) : NULL;
  if (!copy) {
    placido_memory_free(opened);
    return PLACIDO_MEMORY;
  }
  opened->driver = driver;
  opened->replug = (placido_replug){.driver = driver, .clock = clock};
  const int status = open_address(opened, copy, notes, err);
  placido_memory_free(copy);
  if (status) {
    placido_device_close(opened);
    return status;
  }
  opened->replug.state = opened->state;
  *device = opened;
  return PLACIDO_OK;
}

int placido_device_open(placido_device **device, const char *uri, placido_notes *notes,
                        placido_error *err) {
  *device = NULL;
  const placido_driver *driver;
  const char *address;
  const int status = choose_driver(&driver, &address, uri, err);
  return status ? status
                : placido_device_open_with(device, driver, &placido_clock_monotonic, address,
                                           notes, err);
}

void placido_device_close(placido_device *device) {
  if (!device) {
    return;
  }
  if (device->started) {
    placido_device_stop(device, NULL);
  }
  if (device->state) {
    device->driver->close(device->state);
  }
  placido_memory_free(device);
}

const placido_device_info *placido_device_info_get(const placido_device *device) {
  return device->driver->info(device->state);
}

const placido_control *placido_device_controls(const placido_device *device, size_t *count) {
  *count = 0;
  return device->driver->controls ? device->driver->controls(device->state, count) : NULL;
}

static int find_control(const placido_device *device, const char *name, size_t *index,
                        placido_error *err) {
  size_t count;
  const placido_control *controls = placido_device_controls(device, &count);
  for (*index = 0; *index < count; ++*index) {
    if (strcmp(controls[*index].name, name) == 0) {
      return PLACIDO_OK;
    }
  }
  return placido_error_set(err, PLACIDO_INPUT, "a %s device has no control \"%.100s\"",
                           device->driver->scheme, name);
}

int placido_device_get(placido_device *device, const char *control, double *value,
                       placido_error *err) {
  *value = 0;
  size_t index;
  int status = find_control(device, control, &index, err);
  return status ? status : device->driver->get(device->state, index, value, err);
}

int placido_device_set(placido_device *device, const char *control, double value,
                       placido_error *err) {
  size_t index, count;
  int status = find_control(device, control, &index, err);
  if (status) {
    return status;
  }
  const placido_control *row = &placido_device_controls(device, &count)[index];
  if (!(value >= row->min && value <= row->max)) {
    return placido_error_set(err, PLACIDO_INPUT, "control %s is %g to %g %s, not %g", row->name,
                             row->min, row->max, row->unit, value);
  }
  return device->driver->set(device->state, index, value, err);
}

int placido_device_modes(placido_device *device,
                         int (*each)(void *user, const placido_device_mode *mode), void *user,
                         placido_error *err) {
  return device->driver->modes
             ? device->driver->modes(device->state, each, user, err)
             : placido_error_set(err, PLACIDO_UNSUPPORTED,
                                 "a %s device has no formats to choose from",
                                 device->driver->scheme);
}

int placido_device_start(placido_device *device, placido_error *err) {
  if (device->started) {
    return placido_error_set(err, PLACIDO_INPUT, "the %s device is started already",
                             device->driver->scheme);
  }
  int status = device->driver->start(device->state, err);
  device->started = status == PLACIDO_OK;
  return status;
}

static int check_started(const placido_device *device, placido_error *err) {
  return device->started ? PLACIDO_OK
                         : placido_error_set(err, PLACIDO_INPUT, "the %s device is not started",
                                             device->driver->scheme);
}

/* One thing that a started device gives: a frame or an event. */
struct wish {
  placido_frame *frame; /* NULL: an event */
  placido_event *event;
};

/* Asks the driver for it, waiting for the device first where it is unplugged. */
static int take(placido_device *device, const struct wish *wish, int64_t until_ns,
                placido_error *err) {
  placido_replug *replug = &device->replug;
  int status = placido_replug_wait(replug, until_ns, err);
  if (status) {
    return status;
  }
  const int64_t left_ns = until_ns - replug->clock->now_ns();
  const int left_ms = left_ns > 0 ? (int)((left_ns + 999999) / 1000000) : 0;
  if (wish->frame) {
    status = device->driver->next(device->state, wish->frame, left_ms, err);
  } else {
    status = device->driver->event(device->state, wish->event, left_ms, err);
  }
  return status;
}

static int take_over_replugs(placido_device *device, const struct wish *wish, int timeout_ms,
                             placido_error *err) {
  placido_replug *replug = &device->replug;
  const int64_t until_ns =
      replug->clock->now_ns() + (timeout_ms > 0 ? timeout_ms : 0) * (int64_t)1000000;
  int status;
  do {
    status = take(device, wish, until_ns, err);
  } while (status == PLACIDO_GONE && placido_replug_await(replug));
  if (!status && wish->frame) {
    placido_replug_order(&replug->frames, replug->count, &wish->frame->seq, &wish->frame->t_ns);
  } else if (!status) {
    placido_replug_order(&replug->events, replug->count, &wish->event->seq, &wish->event->t_ns);
  }
  return status;
}

int placido_device_next(placido_device *device, placido_frame *frame, int timeout_ms,
                        placido_error *err) {
  if (!device->driver->next) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "a %s device gives no pictures",
                             device->driver->scheme);
  }
  const struct wish wish = {.frame = frame};
  const int status = check_started(device, err);
  return status ? status : take_over_replugs(device, &wish, timeout_ms, err);
}

int placido_device_event(placido_device *device, placido_event *event, int timeout_ms,
                         placido_error *err) {
  *event = (placido_event){0};
  if (!device->driver->event) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "a %s device tells of no events",
                             device->driver->scheme);
  }
  const struct wish wish = {.event = event};
  const int status = check_started(device, err);
  return status ? status : take_over_replugs(device, &wish, timeout_ms, err);
}

int placido_device_patience_set(placido_device *device, double replug_s, placido_error *err) {
  return set_patience(device, replug_s, false, err);
}

bool placido_device_is_waiting(const placido_device *device) {
  return device->replug.plug == PLACIDO_AWAITED;
}

int placido_device_stop(placido_device *device, placido_error *err) {
  if (!device->started) {
    return PLACIDO_OK;
  }
  const bool runs = device->replug.plug == PLACIDO_PLUGGED; /* else it has been stopped already */
  device->started = false;
  device->replug.plug = PLACIDO_PLUGGED;
  return runs && device->driver->stop ? device->driver->stop(device->state, err) : PLACIDO_OK;
}

void placido_device_statistics_get(const placido_device *device,
                                   placido_device_statistics *statistics) {
  *statistics = (placido_device_statistics){0};
  if (device->driver->statistics) {
    device->driver->statistics(device->state, statistics);
  }
  statistics->replugs = device->replug.count;
}
