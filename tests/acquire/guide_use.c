/* Frames of the phantom, and what the guide says of them. */
#include "tests/acquire/guide_use.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

/* A camera with half of the pixels along each side. */
static void halve(placido_instrument *instrument) {
  instrument->width_px /= 2;
  instrument->height_px /= 2;
  for (int i = 0; i < 2; i++) {
    instrument->focal_px[i] /= 2;
    instrument->principal_px[i] = (instrument->principal_px[i] - 0.5) / 2;
  }
}

void guide_use_open(struct guide_use *use, const char *instrument, const char *eye) {
  placido_error err = {0};
  *use = (struct guide_use){.surface = NULL};
  if (strcmp(instrument, "half cone24") == 0) {
    assert_int_equal(placido_phantom_instrument(&use->instrument, "cone24", &err), PLACIDO_OK);
    halve(&use->instrument);
  } else {
    assert_int_equal(placido_phantom_instrument(&use->instrument, instrument, &err), PLACIDO_OK);
  }
  assert_int_equal(placido_phantom_eye(&use->surface, eye, &err), PLACIDO_OK);
  assert_int_equal(placido_guide_new(&use->guide, &use->instrument, &err), PLACIDO_OK);
}

void guide_use_close(struct guide_use *use) {
  placido_guide_free(use->guide);
  placido_surface_free(use->surface);
  placido_frame_free(&use->frame);
}

void guide_use_render(struct guide_use *use, placido_disturbance how) {
  placido_error err = {0};
  /* One ray a pixel takes a quarter of the time; half as many pixels must not be jagged. */
  how.subsamples = use->instrument.width_px < 1000 ? 2 : 1;
  how.seed = how.seed ? how.seed : 1;
  assert_int_equal(
      placido_phantom_render(&use->frame, use->surface, &use->instrument, &how, 0, &err),
      PLACIDO_OK);
}

placido_guidance guide_use_look(struct guide_use *use) {
  placido_guidance guidance;
  placido_error err = {0};
  assert_int_equal(placido_guide_look(use->guide, &use->frame, &guidance, &err), PLACIDO_OK);
  return guidance;
}

placido_guidance guide_use_see(struct guide_use *use, placido_disturbance how) {
  guide_use_render(use, how);
  return guide_use_look(use);
}

placido_guidance guide_use_once(const char *instrument, const char *eye, placido_disturbance how) {
  struct guide_use use;
  guide_use_open(&use, instrument, eye);
  const placido_guidance guidance = guide_use_see(&use, how);
  guide_use_close(&use);
  return guidance;
}
