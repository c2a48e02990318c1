/* Reads what is examined: the device's best frame, the instrument, the distance of the cornea. */
#include "acquire/cli/examination.h"

#include <math.h>

#define REPLUG_S 10            /* to put a plug that was kicked out back in */
#define DISTANCE_SIGMA_MM 0.05 /* of a distance that nobody measured: a careful examiner's focus */

/* What the error bars leave out must be told. */
static void judge_instrument(const placido_instrument *instrument, bool uncertainty_known,
                             placido_notes *notes) {
  const char *left_out = "absolute values may be off by far more than their error bars, which do "
                         "not include the geometry";
  if (!instrument->calibrated && !uncertainty_known) {
    placido_notes_add(notes, "the geometry of \"%s\" is nominal, not calibrated: %s",
                      instrument->name, left_out);
  } else if (!instrument->calibrated) {
    placido_notes_add(notes,
                      "the geometry of \"%s\" is nominal, not calibrated: error bars are as good "
                      "as the standard deviations in its file",
                      instrument->name);
  } else if (!uncertainty_known) {
    placido_notes_add(notes, "the file of \"%s\" does not say how well its geometry is known: %s",
                      instrument->name, left_out);
  }
}

static int read_instrument(struct examination *examination, placido_error *err) {
  const struct settings *settings = examination->settings;
  placido_notes *notes = &examination->outcome->notes;
  const char *own = examination->source.instrument_path;
  const char *path = settings->instrument ? settings->instrument : own;
  if (path[0] == '\0') {
    return placido_error_set(err, STATUS_USAGE,
                             "%s is an image: give the topographer's geometry with --instrument "
                             "FILE",
                             settings->input);
  }
  if (settings->instrument && own[0] != '\0') {
    placido_notes_add(notes, "%s takes the place of the session's own instrument", path);
  }
  int status = placido_instrument_load(&examination->instrument, path, notes, err);
  if (status == PLACIDO_OK) {
    status = placido_uncertainty_load(&examination->geometry, path, err);
  }
  if (status == PLACIDO_OK) {
    judge_instrument(&examination->instrument, examination->geometry.sigma != NULL, notes);
  }
  return status;
}

/* The command line goes before the session, the session before the default (docs/formats.md). */
static void decide_distance(struct examination *examination) {
  const struct distance *asked = &examination->settings->axis_z;
  const placido_device_info *source = &examination->source;
  placido_notes *notes = &examination->outcome->notes;
  examination->axis_z_sigma_mm = DISTANCE_SIGMA_MM;
  if (asked->given) {
    examination->axis_z_mm = asked->value_mm;
    examination->axis_z_sigma_mm = asked->sigma_mm;
  } else if (isfinite(source->axis_z_mm)) {
    examination->axis_z_mm = source->axis_z_mm;
    if (isfinite(source->axis_z_sigma_mm)) {
      examination->axis_z_sigma_mm = source->axis_z_sigma_mm;
    } else {
      placido_notes_add(notes,
                        "the session gives no standard deviation of axis_z_mm: %g mm is assumed",
                        DISTANCE_SIGMA_MM);
    }
  } else {
    placido_notes_add(notes,
                      "the cornea's distance was not measured: axis-z 0 with a standard deviation "
                      "of %g mm is assumed (--axis-z)",
                      DISTANCE_SIGMA_MM);
  }
}

static int choose_frames(struct examination *examination, placido_device *device,
                         placido_error *err) {
  const struct settings *settings = examination->settings;
  if (settings->combine > 1) {
    return combination_capture(examination, device, err);
  }
  return placido_frame_choose(&examination->frame, &examination->choice, device, settings->frame,
                              &examination->outcome->notes, err);
}

static int read_device(struct examination *examination, placido_device *device,
                       placido_error *err) {
  examination->source = *placido_device_info_get(device);
  int status = placido_device_patience_set(device, REPLUG_S, err);
  if (status == PLACIDO_OK) {
    status = read_instrument(examination, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  decide_distance(examination);
  return choose_frames(examination, device, err);
}

int step_capture(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "read");
  if (examination->settings->combine > 1 && examination->settings->frame >= 0) {
    return placido_error_set(err, STATUS_USAGE,
                             "--frame %d asks for one frame and --combine %d for several: leave one "
                             "of them out",
                             examination->settings->frame, examination->settings->combine);
  }
  placido_device *device = NULL;
  int status = placido_device_open(&device, examination->settings->input,
                                   &examination->outcome->notes, err);
  if (status == PLACIDO_OK) {
    status = read_device(examination, device, err);
  }
  placido_device_close(device);
  return status;
}

double examination_mm_per_px(const struct examination *examination) {
  const placido_instrument *instrument = &examination->instrument;
  if (instrument->model == PLACIDO_TELECENTRIC) {
    return 1.0 / instrument->focal_px[0];
  }
  return (instrument->position_mm[2] - examination->axis_z_mm) / instrument->focal_px[0];
}
