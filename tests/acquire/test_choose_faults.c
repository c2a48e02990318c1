/* The best frame is chosen, or it is said why not, whatever a device does: every fault that a
 * replay can be told to have. */
#include "acquire/acquire.h"
#include "tests/base/recording.h"
#include "tests/base/scratch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 6, SIDE = 32, BEST = 3 };

/* Frames of noise; number BEST shows mires besides. */
static void record(const char *path) {
  placido_session_info info = recording_info(PLACIDO_MONO8, 8);
  placido_session_writer *writer;
  placido_frame frame = {0};
  assert_int_equal(placido_session_writer_create(&writer, path, &info, RECORDING_INSTRUMENT, NULL),
                   PLACIDO_OK);
  for (int i = 0; i < FRAMES; i++) {
    recording_fill(&frame, i, PLACIDO_MONO8, 8, SIDE, SIDE);
    for (int at = 0; at < SIDE * SIDE; at++) {
      const int dx = abs(2 * (at % SIDE) - SIDE + 1), dy = abs(2 * (at / SIDE) - SIDE + 1);
      const bool bright = i == BEST && (dx > dy ? dx : dy) / 8 % 2;
      uint8_t *sample = &frame.data[(size_t)(at / SIDE) * frame.stride_bytes + (size_t)(at % SIDE)];
      *sample = (uint8_t)(*sample / 8 + (bright ? 150 : 50));
    }
    assert_int_equal(placido_session_writer_append(writer, &frame, NULL, NULL), PLACIDO_OK);
  }
  placido_frame_free(&frame);
  assert_int_equal(placido_session_writer_close(writer, NULL), PLACIDO_OK);
}

typedef struct fault_case {
  const char *script;
  int status;
  long index, frames, damaged; /* where status is PLACIDO_OK */
  const char *said;            /* in the note or in the message; NULL: nothing */
} fault_case;

static const fault_case cases[] = {
    {"", PLACIDO_OK, BEST, 6, 0, NULL},
    {"at frame 0 drop 2", PLACIDO_OK, 1, 4, 0, NULL},
    {"at frame 3 truncate", PLACIDO_OK, -1, 6, 1, "1 of 6 frames are damaged"},
    {"at frame 3 corrupt", PLACIDO_OK, -1, 6, 1, "1 of 6 frames are damaged"},
    {"at frame 1 damage", PLACIDO_OK, BEST, 6, 1, "1 of 6 frames are damaged"},
    {"at frame 0 corrupt 9", PLACIDO_OK, -1, 6, 6, "the one examined among them"},
    {"at frame 2 delay 120ms", PLACIDO_OK, BEST, 6, 0, NULL},
    {"at frame 1 disconnect 10ms", PLACIDO_OK, 2, 5, 0, "unplugged and came back, 1 time"},
    {"at frame 1 disconnect", PLACIDO_GONE, 0, 0, 0, "waited 1 s for it to come back"},
    {"at frame 5 error", PLACIDO_SYSTEM, 0, 0, 0, "failed, as its script says"},
    {"at frame 0 drop 6", PLACIDO_INPUT, 0, 0, 0, "holds no frame that can be read"},
    {"at frame 0 damage 6", PLACIDO_INPUT, 0, 0, 0, "(6 are damaged)"},
};

static void check_case(void **state, const char *session, const fault_case *c) {
  char uri[1024];
  char *script = scratch_write_text(state, "faults", c->script);
  snprintf(uri, sizeof uri, "replay:%s?faults=%s", session, script);
  placido_device *device;
  placido_frame frame = {0};
  placido_choice choice;
  placido_notes notes = {0};
  placido_error err = {0};
  assert_int_equal(placido_device_open(&device, uri, NULL, &err), PLACIDO_OK);
  assert_int_equal(placido_device_patience_set(device, 1, NULL), PLACIDO_OK);
  const int status = placido_frame_choose(&frame, &choice, device, -1, &notes, &err);
  assert_int_equal(status, c->status);
  assert_int_equal(frame.data != NULL, status == PLACIDO_OK);
  if (status == PLACIDO_OK) {
    assert_int_equal(choice.frames, c->frames);
    assert_int_equal(choice.damaged, c->damaged);
    assert_true(c->index < 0 || choice.index == c->index);
  }
  const char *said = status != PLACIDO_OK ? err.text : notes.count > 0 ? notes.lines[0] : NULL;
  assert_int_equal(said != NULL, c->said != NULL);
  assert_true(!said || strstr(said, c->said));
  placido_notes_clear(&notes);
  placido_frame_free(&frame);
  placido_device_close(device);
  free(script);
}

static void every_fault_is_survived_or_told(void **state) {
  char *session = scratch_path(state, "a.session");
  record(session);
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    check_case(state, session, &cases[i]);
  }
  free(session);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(every_fault_is_survived_or_told, scratch_setup,
                                      scratch_teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
