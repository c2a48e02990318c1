/* One object through the whole chain: picture, mires, surface. */
#include "acquire/cli/ball.h"
#include "acquire/cli/iso_check.h"

#include <placido/mires.h>
#include <placido/phantom.h>
#include <placido/reconstruct.h>

#include <math.h>

/* A picture as a good camera takes it: a little out of focus, a little noise. */
static int render(placido_frame *frame, const struct iso_object *object,
                  const placido_instrument *instrument, unsigned seed, int threads,
                  placido_error *err) {
  const placido_disturbance disturbance = {.seed = seed, .blur_px = 0.8, .noise = 1.2};
  return placido_phantom_render(frame, object->truth, instrument, &disturbance, threads, err);
}

static int read(placido_frame *frame, double *axis_z_mm, const struct iso_object *object,
                placido_notes *notes, placido_error *err) {
  placido_device_info source;
  const int status = ball_read(frame, &source, object->image, -1, notes, err);
  if (status == PLACIDO_OK && isnan(*axis_z_mm)) {
    *axis_z_mm = source.axis_z_mm;
  }
  if (status == PLACIDO_OK && isnan(*axis_z_mm)) {
    *axis_z_mm = 0;
    placido_notes_add(notes, "%s: its distance is not known and taken for 0: 0.1 mm amounts to "
                      "some 0.14 D (--axis-z)", object->name);
  }
  return status;
}

int iso_object_check(placido_iso_result *result, const struct iso_object *object,
                     const placido_instrument *instrument, const struct settings *settings,
                     unsigned seed, placido_notes *notes, placido_error *err) {
  *result = (placido_iso_result){.object = object->name, .image = object->image};
  placido_frame frame = {0};
  placido_mires mires = {0};
  placido_fit *fit = NULL;
  const int threads = settings_use_threads(settings);
  const placido_mires_options finding = {.meridians = settings->meridians, .threads = threads};
  placido_fit_options fitting = {
      .axis_z_mm = object->axis_z_mm, .knot_mm = settings->knot_mm, .threads = threads};
  int status = object->image[0] != '\0'
                   ? read(&frame, &fitting.axis_z_mm, object, notes, err)
                   : render(&frame, object, instrument, seed, threads, err);
  if (status == PLACIDO_OK) {
    status = placido_mires_find(&mires, &frame, instrument, &finding, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_fit_new(&fit, &mires, instrument, &fitting, notes, err);
  }
  if (status == PLACIDO_OK) {
    status = iso_compare(result, object, placido_fit_surface(fit), err);
  }
  placido_fit_free(fit);
  placido_mires_free(&mires);
  placido_frame_free(&frame);
  return status;
}
