/* A session of the phantom: it opens, its eye moves as an eye does, and the best frame has to be
 * looked for. */
#include "tests/phantom/locate.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <dirent.h>
#include <math.h>
#include <placido/phantom.h>
#include <placido/session.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FRAMES 8

typedef struct bench {
  char folder[64], path[128];
  placido_surface *surface;
  placido_instrument instrument;
} bench;

/* A quarter of the pixels: the tests are about sessions, not about edges. */
static int set_up(void **state) {
  bench *b = calloc(1, sizeof *b);
  *state = b;
  if (!b || placido_phantom_eye(&b->surface, "keratoconus", NULL) ||
      placido_phantom_instrument(&b->instrument, "cone24", NULL)) {
    return -1;
  }
  b->instrument.width_px = 640;
  b->instrument.height_px = 512;
  for (int i = 0; i < 2; i++) {
    b->instrument.focal_px[i] /= 2;
    b->instrument.principal_px[i] = (b->instrument.principal_px[i] - 0.5) / 2;
  }
  strcpy(b->folder, "/tmp/placido-phantom-XXXXXX");
  if (!mkdtemp(b->folder)) {
    return -1;
  }
  snprintf(b->path, sizeof b->path, "%s/eye.session", b->folder);
  return 0;
}

static void empty(const char *folder) {
  char path[1024];
  DIR *listing = opendir(folder);
  for (struct dirent *entry; listing && (entry = readdir(listing));) {
    snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
    if (entry->d_name[0] != '.') {
      unlink(path);
    }
  }
  if (listing) {
    closedir(listing);
  }
  rmdir(folder);
}

static int tear_down(void **state) {
  bench *b = *state;
  empty(b->path);
  empty(b->folder);
  placido_surface_free(b->surface);
  free(b);
  return 0;
}

static int record(const bench *b, const char *eye, int frames, placido_error *err) {
  placido_disturbance disturbance = {.seed = 11, .blur_px = 0.4, .noise = 1, .lashes = 4};
  return placido_phantom_session(b->path, b->surface, &b->instrument, eye, frames, 25, &disturbance,
                                 0, err);
}

/* Mean square of the differences between neighbours: what focus and motion take away. */
static double sharpness(const placido_frame *frame) {
  double sum = 0;
  for (int v = 0; v < frame->height_px; v++) {
    const uint8_t *row = frame->data + (size_t)v * frame->stride_bytes;
    for (int u = 0; u + 1 < frame->width_px; u++) {
      sum += (row[u + 1] - row[u]) * (row[u + 1] - row[u]);
    }
  }
  return sum / (frame->width_px * frame->height_px);
}

/* Mean grey where the upper lid comes down, 1.5 to 3 mm above the axis. */
static double lid_grey(const placido_frame *frame) {
  double sum = 0;
  int count = 0;
  for (int v = 256 - 135; v < 256 - 68; v++) {
    for (int u = 300; u < 340; u++) {
      sum += grey_between(frame, u, v);
      count++;
    }
  }
  return sum / count;
}

static void frames_differ_in_focus_and_lid(void **state) {
  const bench *b = *state;
  placido_error err = {0};
  placido_session_reader *reader;
  placido_frame frame = {0};
  double sharp[FRAMES], lid[FRAMES];
  int count = 0;
  assert_int_equal(record(b, "OD", FRAMES, &err), PLACIDO_OK);
  assert_int_equal(placido_session_reader_open(&reader, b->path, NULL, &err), PLACIDO_OK);
  while (placido_session_reader_next(reader, &frame, &err) == PLACIDO_OK) {
    assert_true(count < FRAMES);
    assert_int_equal(frame.width_px, 640);
    assert_int_equal(frame.t_ns, 1000000000 + count * 40000000);
    sharp[count] = sharpness(&frame);
    lid[count++] = lid_grey(&frame);
  }
  assert_int_equal(count, FRAMES);
  /* Frame 2 of 8 is out of focus, 4 has the lid down, 6 is jerked. */
  assert_true(sharp[2] < 0.5 * sharp[0] && sharp[2] < 0.5 * sharp[7]);
  assert_true(sharp[6] < 0.8 * sharp[7]);
  assert_true(sharp[1] > 0.7 * sharp[0]);
  assert_true(fabs(lid[4] - 126) < 12);
  assert_true(fabs(lid[0] - lid[1]) < 5);
  placido_frame_free(&frame);
  placido_session_reader_close(reader);
}

static void session_says_what_it_is(void **state) {
  const bench *b = *state;
  char path[256];
  placido_error err = {0};
  placido_session_reader *reader;
  placido_jet jet, truth_jet;
  placido_surface *truth;
  placido_instrument instrument;
  assert_int_equal(record(b, "OS", 1, &err), PLACIDO_OK);
  assert_int_equal(placido_session_reader_open(&reader, b->path, NULL, &err), PLACIDO_OK);
  const placido_session_info *info = placido_session_reader_info(reader);
  assert_string_equal(info->eye, "OS");
  assert_true(info->rate_hz == 25);
  assert_true(placido_surface_at(b->surface, 0, 0, &jet));
  assert_true(info->axis_z_mm == -jet.sag);
  assert_true(info->axis_z_sigma_mm == 0.02);
  assert_int_equal(
      placido_instrument_load(&instrument, placido_session_reader_instrument(reader), NULL, &err),
      PLACIDO_OK);
  assert_true(instrument.edges[7].z_mm == b->instrument.edges[7].z_mm);
  snprintf(path, sizeof path, "%s/truth-surface.json", b->path);
  assert_int_equal(placido_surface_load(&truth, path, NULL, &err), PLACIDO_OK);
  assert_true(placido_surface_at(b->surface, 1.1, -0.7, &jet));
  assert_true(placido_surface_at(truth, 1.1, -0.7, &truth_jet));
  assert_true(jet.sag == truth_jet.sag && jet.sxy == truth_jet.sxy);
  placido_surface_free(truth);
  placido_session_reader_close(reader);
}

static int entries(const char *folder) {
  int count = 0;
  DIR *listing = opendir(folder);
  assert_non_null(listing);
  for (struct dirent *entry; (entry = readdir(listing));) {
    count += entry->d_name[0] != '.' || strlen(entry->d_name) > 2;
  }
  closedir(listing);
  return count;
}

static void refusals_leave_nothing_behind(void **state) {
  bench *b = *state;
  placido_error err = {0};
  assert_int_equal(record(b, "left", 2, &err), PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "OD or OS"));
  assert_int_equal(record(b, "OD", 0, &err), PLACIDO_INPUT);
  b->instrument.width_px = -1;
  assert_int_equal(record(b, "OD", 1, &err), PLACIDO_INPUT);
  b->instrument.width_px = 640;
  b->instrument.edges[3].z_mm = NAN;
  assert_int_not_equal(record(b, "OD", 1, &err), PLACIDO_OK);
  assert_int_equal(entries(b->folder), 0);
}

static void a_session_is_not_overwritten(void **state) {
  const bench *b = *state;
  placido_error err = {0};
  assert_int_equal(record(b, "OD", 1, &err), PLACIDO_OK);
  int before = entries(b->path);
  assert_int_equal(record(b, "OS", 1, &err), PLACIDO_SYSTEM);
  assert_int_equal(entries(b->path), before);
  assert_int_equal(entries(b->folder), 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(frames_differ_in_focus_and_lid, set_up, tear_down),
      cmocka_unit_test_setup_teardown(session_says_what_it_is, set_up, tear_down),
      cmocka_unit_test_setup_teardown(refusals_leave_nothing_behind, set_up, tear_down),
      cmocka_unit_test_setup_teardown(a_session_is_not_overwritten, set_up, tear_down),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
