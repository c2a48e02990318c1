/* The promise and its outcome for machines and for people. */
#include "acquire/cli/promise.h"

#include "acquire/cli/examination.h"
#include "acquire/cli/promise_knobs.h"
#include "acquire/cli/record.h"
#include "base/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A text that grows. */
struct text {
  char *at;
  size_t room;
  int count;
};

static json_t *real_or_null(double value) {
  return placido_json_real(value > 0 ? value : (double)NAN);
}

static json_t *asked(const struct accuracy_settings *settings) {
  const char *name = accuracy_name_text(settings->named);
  return json_pack("{s:o, s:o, s:o, s:o}", "max_error_um", real_or_null(settings->max_error_um),
                   "max_error_psf", real_or_null(settings->max_error_psf), "max_time_ms",
                   real_or_null(settings->max_time_ms), "accuracy",
                   name ? json_string(name) : json_null());
}

double promise_error(const struct examination *examination, enum accuracy_error error) {
  const struct promise *promise = &examination->promise;
  const bool of_it = error == ACCURACY_PSF_OTF ? examination->views.scene_count > 0
                                               : examination->fit != NULL;
  return promise->kept_in_table && of_it ? promise->choice.error[error] : (double)NAN;
}

static json_t *promised(const struct examination *examination) {
  return json_pack("{s:o, s:o, s:o}", "max_error_um",
                   placido_json_real(promise_error(examination, ACCURACY_ELEVATION_UM)),
                   "max_error_psf",
                   placido_json_real(promise_error(examination, ACCURACY_PSF_OTF)), "time_ms",
                   placido_json_real(promise_time_ms(&examination->promise)));
}

static void put_knob(void *user, const char *name, const char *value) {
  json_object_set_new(user, name, placido_json_real(strtod(value, NULL)));
}

static json_t *chosen(const struct promise *promise) {
  json_t *object = json_object();
  if (object && promise->kept_in_table) {
    promise_each_knob(&promise->choice, put_knob, object);
  }
  return object;
}

static json_t *table(const struct promise *promise) {
  return json_pack("{s:o, s:o, s:b, s:o}", "created", record_text(promise->created), "machine",
                   record_text(promise->machine), "built_in", promise->built_in, "probe_ms",
                   placido_json_real(promise->table_probe_ms));
}

static json_t *found(const struct examination *examination) {
  const struct promise *promise = &examination->promise;
  const bool measured = examination->fit != NULL;
  const double *by = promise->by_um, none = NAN;
  return json_pack(
      "{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "sigma_um", placido_json_real(promise->sigma_um),
      "noise_um", placido_json_real(measured ? by[PLACIDO_SIGMA_NOISE] : none), "distance_um",
      placido_json_real(measured ? by[PLACIDO_SIGMA_DISTANCE] : none), "geometry_um",
      placido_json_real(measured ? by[PLACIDO_SIGMA_GEOMETRY] : none), "time_ms",
      placido_json_real(promise->found_ms), "wall_ms", placido_json_real(promise->found_wall_ms),
      "probe_ms", placido_json_real(promise->probe_ms));
}

json_t *promise_json(const struct examination *examination) {
  const struct promise *promise = &examination->promise;
  return json_pack("{s:o, s:o, s:o, s:o, s:o}", "asked", asked(&promise->settings.accuracy),
                   "promised", promised(examination), "settings", chosen(promise), "table",
                   table(promise), "found", found(examination));
}

static void add_knob(void *user, const char *name, const char *value) {
  struct text *text = user;
  const int length = snprintf(text->at, text->room, "%s%s %s", text->count++ > 0 ? ", " : "", name,
                              value);
  if (length > 0 && (size_t)length < text->room) {
    text->at += length;
    text->room -= (size_t)length;
  }
}

void promise_describe(char *settings, char *by, size_t size, const struct promise *promise) {
  const char *name = accuracy_name_text(promise->settings.accuracy.named);
  const int length = snprintf(settings, size, "Settings%s%s: ", name ? ", by the name " : " chosen",
                              name ? name : "");
  struct text text = {.at = settings + length, .room = size - (size_t)length};
  if (promise->kept_in_table) {
    promise_each_knob(&promise->choice, add_knob, &text);
  }
  snprintf(by, size, "By %s accuracy table of %s (%s).",
           promise->built_in ? "the program's own" : "your", promise->created, promise->machine);
}

void promise_print(const struct examination *examination) {
  const struct promise *promise = &examination->promise;
  const struct settings *settings = examination->settings;
  const double um = promise_error(examination, ACCURACY_ELEVATION_UM);
  const double psf = promise_error(examination, ACCURACY_PSF_OTF);
  char elevation[64] = "", transfer[64] = "";
  if (!promise->made || !promise->kept_in_table) {
    return;
  }
  if (isfinite(um)) {
    snprintf(elevation, sizeof elevation, "elevation to %.2g um, ", um);
  }
  if (isfinite(psf)) {
    snprintf(transfer, sizeof transfer, "transfer function to %.2g, ", psf);
  }
  say(settings, "promised: %s%sin %.0f ms; it took %.0f ms of processor time", elevation, transfer,
      promise_time_ms(promise), promise->found_ms);
  if (examination->fit) {
    say(settings, "error bars of this measurement: %.2g um rms over 6 mm", promise->sigma_um);
  }
}
