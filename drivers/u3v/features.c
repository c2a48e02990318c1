/* A camera's features as controls: one row of the table for each way that cameras name one.
 *
 * Names after GenICam's Standard Features Naming Convention, and the older ones (...Abs in the
 * standard unit, ...Raw in the camera's own) that cameras of ten years ago have. */
#include "drivers/u3v/features.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What a feature measures, and so which units its description may give. */
enum quantity { PURE, TIME, DECIBEL, RATE, TEMPERATURE };

/* How a feature is read and written. */
enum way {
  NUMBER,
  SWITCH, /* an enumeration of Off and On */
  CHOICE, /* an enumeration, by its entries' values */
  ACTION,
};

/* Of rows with one slot, the first that the camera has is taken: they are one thing in different
 * units. Of a row's features too. */
static const struct placido_u3v_known {
  const char *slot;
  const char *control, *unit, *help;
  const char *features[3];
  enum way way;
  enum quantity quantity;
  bool is_read_only;
  const char *automatic; /* the feature that regulates it, and goes to Off */
  const char *enable;    /* the feature that must be true before it counts */
} table[] = {
    {"exposure", "exposure_us", "us", "time of exposure",
     {"ExposureTime", "ExposureTimeAbs", "ExposureTimeRaw"}, NUMBER, TIME, false, "ExposureAuto",
     NULL},
    {"exposure", "exposure", "", "time of exposure in the camera's own unit",
     {"ExposureTimeRaw"}, NUMBER, PURE, false, "ExposureAuto", NULL},
    {"gain", "gain_db", "dB", "gain", {"Gain", "GainAbs"}, NUMBER, DECIBEL, false, "GainAuto",
     NULL},
    {"gain", "gain", "", "gain in the camera's own unit", {"Gain", "GainRaw"}, NUMBER, PURE, false,
     "GainAuto", NULL},
    {"black", "black_level", "", "what is added to every sample",
     {"BlackLevel", "BlackLevelRaw"}, NUMBER, PURE, false, "BlackLevelAuto", NULL},
    {"rate", "frame_rate_hz", "Hz", "frames per second",
     {"AcquisitionFrameRate", "AcquisitionFrameRateAbs"}, NUMBER, RATE, false,
     "AcquisitionFrameRateAuto", "AcquisitionFrameRateEnable"},
    {"trigger", "trigger", "", "1: a picture for each trigger; 0: free running", {"TriggerMode"},
     SWITCH, PURE, false, NULL, NULL},
    {"source", "trigger_source", "", "", {"TriggerSource"}, CHOICE, PURE, false, NULL, NULL},
    {"delay", "trigger_delay_us", "us", "from the trigger to the exposure",
     {"TriggerDelay", "TriggerDelayAbs"}, NUMBER, TIME, false, NULL, NULL},
    {"software", "trigger_software", "", "triggers now", {"TriggerSoftware"}, ACTION, PURE, false,
     NULL, NULL},
    {"temperature", "device_temperature_c", "C", "temperature of the camera",
     {"DeviceTemperature", "TemperatureAbs"}, NUMBER, TEMPERATURE, true, NULL, NULL},
};

#define KNOWN_COUNT (sizeof table / sizeof *table)
/* What a feature without limits is given, rather than the 308 digits of the largest number. */
#define LIMIT_MAX 1e12
#define FEATURES_MAX (sizeof table->features / sizeof *table->features)

/* Units as descriptions write them, to ours. An empty one is ours. */
static const struct {
  enum quantity quantity;
  const char *unit;
  double factor;
} units[] = {
    {TIME, "us", 1},      {TIME, "\xc2\xb5s", 1}, {TIME, "\xce\xbcs", 1}, {TIME, "usec", 1},
    {TIME, "ms", 1e3},    {TIME, "s", 1e6},       {TIME, "ns", 1e-3},     {DECIBEL, "dB", 1},
    {RATE, "Hz", 1},      {RATE, "fps", 1},       {RATE, "1/s", 1},       {TEMPERATURE, "C", 1},
    {TEMPERATURE, "\xc2\xb0""C", 1},
};

/* Our unit per the camera's; 0 where the feature is not in a unit of this quantity. */
static double factor_of(const struct placido_u3v_known *known, const char *name,
                        const placido_feature *feature) {
  if (known->quantity == PURE || known->quantity == TEMPERATURE) {
    return 1;
  }
  if (!feature->unit[0]) {
    const size_t length = strlen(name);
    const bool is_raw = (length > 3 && strcmp(name + length - 3, "Raw") == 0) ||
                        (known->quantity == DECIBEL && feature->kind == PLACIDO_FEATURE_INTEGER);
    return is_raw ? 0 : 1;
  }
  for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
    if (units[i].quantity == known->quantity && strcmp(units[i].unit, feature->unit) == 0) {
      return units[i].factor;
    }
  }
  return 0;
}

static bool is_of_kind(const struct placido_u3v_known *known, const placido_feature *feature) {
  switch (known->way) {
  case ACTION:
    return feature->kind == PLACIDO_FEATURE_COMMAND;
  case SWITCH:
    return feature->kind == PLACIDO_FEATURE_ENUMERATION;
  case CHOICE:
    return feature->kind == PLACIDO_FEATURE_ENUMERATION;
  default:
    return feature->kind == PLACIDO_FEATURE_INTEGER || feature->kind == PLACIDO_FEATURE_FLOAT;
  }
}

/* Failures that the next feature would have too; others are one feature's own. */
static bool is_fatal(int status) {
  return status == PLACIDO_GONE || status == PLACIDO_TIMEOUT || status == PLACIDO_MEMORY;
}

/* The trigger's features speak of the kind of trigger that is selected: ours is a frame's. */
static int select_trigger(placido_genicam *features, const char *name, placido_error *err) {
  placido_feature selector;
  char now[32];
  if (strncmp(name, "Trigger", 7) != 0) {
    return PLACIDO_OK;
  }
  int status = placido_genicam_describe(features, "TriggerSelector", &selector, err);
  if (status || !selector.can_write) {
    return status;
  }
  status = placido_genicam_get_text(features, "TriggerSelector", now, sizeof now, err);
  if (!status && strcmp(now, "FrameStart") != 0) {
    status = placido_genicam_set_text(features, "TriggerSelector", "FrameStart", err);
  }
  /* A camera without a frame trigger has one that begins the acquisition; it stays selected. */
  return is_fatal(status) ? status : PLACIDO_OK;
}

/* The entries of a choice, for a person: "0 Line0, 1 Software"; and the range of their values. */
struct entries {
  char *help;
  size_t size;
  double min, max;
};

static int add_entry(void *user, const char *entry, int64_t value) {
  struct entries *entries = user;
  const size_t length = strlen(entries->help);
  snprintf(entries->help + length, entries->size - length, "%s%lld %.40s", length ? ", " : "",
           (long long)value, entry);
  entries->min = fmin(entries->min, (double)value);
  entries->max = fmax(entries->max, (double)value);
  return 0;
}

/* The limits as they are now, in our unit. */
static int read_range(placido_control *row, placido_u3v_control *behind,
                      placido_genicam *features, const placido_feature *feature,
                      placido_error *err) {
  row->min = 0;
  row->max = row->step = 1;
  if (behind->known->way == CHOICE) {
    struct entries entries = {
        .help = behind->help, .size = sizeof behind->help, .min = INFINITY, .max = -INFINITY};
    behind->help[0] = '\0';
    const int status =
        placido_genicam_entries(features, behind->feature, add_entry, &entries, err);
    row->min = entries.min <= entries.max ? entries.min : 0;
    row->max = entries.min <= entries.max ? entries.max : 0;
    return status;
  }
  if (behind->known->way == NUMBER) {
    row->min = fmax(feature->min * behind->factor, -LIMIT_MAX);
    row->max = fmin(fmax(feature->max, feature->min) * behind->factor, LIMIT_MAX);
    row->step = feature->step * behind->factor;
  }
  return PLACIDO_OK;
}

static bool has_slot(const placido_u3v_controls *controls, const char *slot) {
  for (size_t i = 0; i < controls->count; i++) {
    if (strcmp(controls->behind[i].known->slot, slot) == 0) {
      return true;
    }
  }
  return false;
}

/* Adds a row where the camera has the feature, as this row of the table knows it. */
static int add_feature(placido_u3v_controls *controls, placido_genicam *features,
                       const struct placido_u3v_known *known, const char *name,
                       placido_error *err) {
  placido_feature feature;
  int status = select_trigger(features, name, err);
  status = status ? status : placido_genicam_describe(features, name, &feature, err);
  if (status) {
    return status;
  }
  /* A command, and what has to be enabled first, may be out of reach just now. */
  const bool is_there = feature.can_read || feature.can_write || known->way == ACTION ||
                        known->enable;
  const double factor = factor_of(known, name, &feature);
  if (!is_of_kind(known, &feature) || !is_there || factor <= 0) {
    return PLACIDO_OK;
  }
  placido_u3v_control *behind = &controls->behind[controls->count];
  placido_control *row = &controls->rows[controls->count];
  *behind = (placido_u3v_control){
      .known = known,
      .feature = name,
      .factor = factor,
      .is_read_only =
          known->is_read_only || (!feature.can_write && known->way == NUMBER && !known->enable),
      .is_write_only = known->way == ACTION};
  snprintf(behind->help, sizeof behind->help, "%s", known->help);
  *row = (placido_control){.name = known->control, .unit = known->unit, .help = behind->help};
  status = read_range(row, behind, features, &feature, err);
  controls->count += status == PLACIDO_OK;
  return status;
}

int placido_u3v_controls_list(placido_u3v_controls *controls, placido_genicam *features,
                              placido_error *err) {
  controls->count = 0;
  for (size_t i = 0; i < KNOWN_COUNT && controls->count < PLACIDO_U3V_CONTROLS_MAX; i++) {
    for (size_t k = 0; k < FEATURES_MAX && table[i].features[k]; k++) {
      const int status = has_slot(controls, table[i].slot)
                             ? PLACIDO_OK
                             : add_feature(controls, features, &table[i], table[i].features[k],
                                           err);
      if (is_fatal(status)) {
        return status;
      }
    }
  }
  return PLACIDO_OK;
}

size_t placido_u3v_control_find(const placido_u3v_controls *controls, const char *name) {
  size_t i = 0;
  while (i < controls->count && strcmp(controls->rows[i].name, name) != 0) {
    i++;
  }
  return i;
}

int placido_u3v_control_get(const placido_u3v_controls *controls, placido_genicam *features,
                            size_t control, double *value, placido_error *err) {
  const placido_u3v_control *behind = &controls->behind[control];
  const char *name = behind->feature;
  *value = 0;
  if (behind->is_write_only) {
    return PLACIDO_OK;
  }
  int status = select_trigger(features, name, err);
  if (status) {
    return status;
  }
  if (behind->known->way == SWITCH) {
    char text[16];
    status = placido_genicam_get_text(features, name, text, sizeof text, err);
    *value = !status && strcmp(text, "On") == 0;
    return status;
  }
  status = placido_genicam_get_float(features, name, value, err);
  *value *= behind->factor;
  return status;
}

/* Puts one of a control's helpers where it must be; cameras need not have it. */
static int prepare(placido_genicam *features, const char *name, const char *text, int64_t number,
                   placido_error *err) {
  placido_feature feature;
  const int status = name ? placido_genicam_describe(features, name, &feature, err) : PLACIDO_OK;
  if (status || !name || !feature.can_write) {
    return status;
  }
  return feature.kind == PLACIDO_FEATURE_ENUMERATION
             ? placido_genicam_set_text(features, name, text, err)
             : placido_genicam_set_integer(features, name, number, err);
}

static int apply(const placido_u3v_control *behind, placido_genicam *features, double value,
                 placido_error *err) {
  const char *name = behind->feature;
  switch (behind->known->way) {
  case ACTION:
    return placido_genicam_execute(features, name, err);
  case SWITCH:
    return placido_genicam_set_text(features, name, value != 0 ? "On" : "Off", err);
  case CHOICE:
    return placido_genicam_set_integer(features, name, (int64_t)llround(value), err);
  default:
    return placido_genicam_set_float(features, name, value / behind->factor, err);
  }
}

/* What was set may have moved the limits of all. Of no consequence for what was set where it
 * fails. */
static void refresh(placido_u3v_controls *controls, placido_genicam *features) {
  for (size_t i = 0; i < controls->count; i++) {
    placido_u3v_control *behind = &controls->behind[i];
    placido_feature feature;
    if (behind->known->way == NUMBER &&
        placido_genicam_describe(features, behind->feature, &feature, NULL) == PLACIDO_OK) {
      read_range(&controls->rows[i], behind, features, &feature, NULL);
    }
  }
}

int placido_u3v_control_set(placido_u3v_controls *controls, placido_genicam *features,
                            size_t control, double value, placido_error *err) {
  const placido_u3v_control *behind = &controls->behind[control];
  const struct placido_u3v_known *known = behind->known;
  if (behind->is_read_only) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED, "%s of the camera can only be read",
                             known->control);
  }
  int status = select_trigger(features, behind->feature, err);
  status = status ? status : prepare(features, known->automatic, "Off", 0, err);
  status = status ? status : prepare(features, known->enable, "On", 1, err);
  status = status ? status : apply(behind, features, value, err);
  if (!status && known->way != ACTION) {
    refresh(controls, features);
  }
  return status;
}
