/* `placido devices`: which drivers this build has, which devices can be seen now, one of them in
 * detail, or whatever comes and goes. */
#include "acquire/cli/command.h"
#include "acquire/cli/device_detail.h"
#include "acquire/cli/record.h"

#include <placido/device.h>
#include <placido/hotplug.h>
#include <stdio.h>

#define WATCH_MS 1000

/* Both lists, as JSON; people get the same printed. */
struct listing {
  const struct settings *settings;
  json_t *drivers, *devices;
};

static void list_driver(void *user, const char *scheme, const char *summary) {
  struct listing *listing = user;
  json_t *row = json_object();
  json_object_set_new(row, "scheme", record_text(scheme));
  json_object_set_new(row, "summary", record_text(summary));
  json_array_append_new(listing->drivers, row);
  say(listing->settings, "%-10s %s", scheme, summary);
}

static int list_device(void *user, const char *uri, const char *description) {
  struct listing *listing = user;
  json_t *row = json_object();
  json_object_set_new(row, "uri", record_text(uri));
  json_object_set_new(row, "description", record_text(description));
  json_array_append_new(listing->devices, row);
  say(listing->settings, "%-30s %s", uri, description);
  return PLACIDO_OK;
}

static int list_all(const struct settings *settings, struct outcome *outcome,
                    placido_error *err) {
  struct listing listing = {
      .settings = settings, .drivers = json_array(), .devices = json_array()};
  say(settings, "drivers");
  placido_driver_list(list_driver, &listing);
  say(settings, "\ndevices");
  const int status = placido_device_scan(NULL, list_device, &listing, err);
  if (status == PLACIDO_OK && json_array_size(listing.devices) == 0) {
    say(settings, "(none seen)");
  }
  outcome->result = json_object();
  json_object_set_new(outcome->result, "drivers", listing.drivers);
  json_object_set_new(outcome->result, "devices", listing.devices);
  return status;
}

/* One change as one line, which must be out before the next is waited for. */
static int tell_change(const struct settings *settings, const placido_change *change,
                       placido_error *err) {
  const char *what = change->is_added ? "added" : "removed";
  if (settings->json) {
    json_t *row = json_object();
    json_object_set_new(row, "change", json_string(what));
    json_object_set_new(row, "uri", record_text(change->uri));
    json_object_set_new(row, "description", record_text(change->description));
    json_dumpf(row, stdout, JSON_COMPACT);
    putchar('\n');
    json_decref(row);
  } else {
    say(settings, "%-8s %-30s %s", what, change->uri, change->description);
  }
  if (fflush(stdout) != 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "standard output cannot be written");
  }
  return PLACIDO_OK;
}

/* Ends by a signal (interrupt.h), or where it cannot go on. */
static int watch(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  stages_end(&outcome->stages); /* there is nothing to be waited for */
  placido_watch *watch;
  int status = placido_watch_open(&watch, err);
  while (status == PLACIDO_OK || status == PLACIDO_TIMEOUT) {
    placido_change change;
    status = placido_watch_next(watch, &change, WATCH_MS, err);
    if (status == PLACIDO_OK) {
      status = tell_change(settings, &change, err);
    }
  }
  placido_watch_close(watch);
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  if (settings->watch && settings->input) {
    return placido_error_set(err, STATUS_USAGE, "--watch is of all devices: %.200s is too much",
                             settings->input);
  }
  return settings->watch   ? watch(settings, outcome, err)
         : settings->input ? device_detail(settings, outcome, err)
                           : list_all(settings, outcome, err);
}

static const struct option_group *const groups[] = {&options_devices, &options_general, NULL};

const struct command command_devices = {
    .name = "devices",
    .summary = "List the drivers of this build and the devices that can be seen, or one of them in "
               "detail.",
    .usage = "[URI] [OPTION...]",
    .examples = "  placido devices\n  placido devices v4l2:/dev/video0\n"
                "  placido devices --watch --json\n",
    .groups = groups,
    .may_have_word = true,
    .run = run,
};
