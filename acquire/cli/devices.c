/* `placido devices`: which drivers this build has and which devices can be seen now. */
#include "acquire/cli/command.h"
#include "acquire/cli/record.h"

#include <placido/device.h>

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

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
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

static const struct option_group *const groups[] = {&options_general, NULL};

const struct command command_devices = {
    .name = "devices",
    .summary = "List the drivers of this build and the devices that can be seen.",
    .usage = "[OPTION...]",
    .examples = "  placido devices\n  placido devices --json\n",
    .groups = groups,
    .run = run,
};
