/* Choosing among a device's frames: the best one, the one asked for, and what happens where frames
 * are damaged. The device is a script: this file defines the device's functions itself. */
#include "acquire/acquire.h"
#include "tests/acquire/rings.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = 64, FRAMES_MAX = 8 };

/* What one call of next gives: rings of a contrast, flags, or a status. */
struct scripted_frame {
  int contrast; /* grey levels */
  uint32_t flags;
  int status;
};

struct placido_device {
  placido_device_info info;
  struct scripted_frame frames[FRAMES_MAX];
  int count, next;
  bool started;
  bool is_hurried; /* told to give its frames without waiting */
  bool is_waiting; /* time-outs are those of an unplugged device */
  uint64_t replugs;
};

const placido_device_info *placido_device_info_get(const placido_device *device) {
  return &device->info;
}

int placido_device_start(placido_device *device, placido_error *err) {
  (void)err;
  device->started = true;
  device->next = 0;
  return PLACIDO_OK;
}

int placido_device_stop(placido_device *device, placido_error *err) {
  (void)err;
  device->started = false;
  return PLACIDO_OK;
}

int placido_device_set(placido_device *device, const char *control, double value,
                       placido_error *err) {
  (void)err;
  assert_string_equal(control, "speed");
  device->is_hurried = value == 0;
  return PLACIDO_OK;
}

bool placido_device_is_waiting(const placido_device *device) {
  return device->is_waiting;
}

void placido_device_statistics_get(const placido_device *device,
                                   placido_device_statistics *statistics) {
  *statistics = (placido_device_statistics){.replugs = device->replugs};
}

int placido_device_next(placido_device *device, placido_frame *frame, int timeout_ms,
                        placido_error *err) {
  (void)timeout_ms;
  assert_true(device->started);
  if (device->next == device->count && device->info.endless) {
    device->next = 0;
  }
  if (device->next == device->count) {
    return PLACIDO_END;
  }
  const struct scripted_frame *script = &device->frames[device->next++];
  if (script->status != PLACIDO_OK) {
    return placido_error_set(err, script->status, "scripted");
  }
  assert_int_equal(placido_frame_resize(frame, SIDE, SIDE, PLACIDO_MONO8, err), PLACIDO_OK);
  frame->flags = script->flags;
  frame->seq = (uint64_t)script->contrast; /* so that a test can tell which one it got */
  rings_draw(frame, script->contrast);
  return PLACIDO_OK;
}

/* Chooses and says which contrast was taken; -1 where nothing was. */
static int choose(placido_device *device, long wanted, placido_choice *choice,
                  placido_notes *notes, int *status, placido_error *err) {
  placido_frame frame = {0};
  *status = placido_frame_choose(&frame, choice, device, wanted, notes, err);
  const int taken = frame.data ? (int)frame.seq : -1;
  assert_false(device->started);
  placido_frame_free(&frame);
  return taken;
}

static void test_best_wins(void **state) {
  (void)state;
  placido_device device = {.frames = {{40, 0, 0}, {90, 0, 0}, {60, 0, 0}}, .count = 3};
  placido_choice choice;
  int status;
  assert_int_equal(choose(&device, -1, &choice, NULL, &status, NULL), 90);
  assert_int_equal(status, PLACIDO_OK);
  assert_int_equal(choice.index, 1);
  assert_int_equal(choice.frames, 3);
  assert_true(choice.score > 0.0);
}

static void test_a_recording_is_hurried_through(void **state) {
  (void)state;
  placido_device device = {.frames = {{40, 0, 0}}, .count = 1};
  placido_choice choice;
  int status;
  choose(&device, -1, &choice, NULL, &status, NULL);
  assert_true(device.is_hurried);
  device = (placido_device){
      .info.uri = "replay:a.session?speed=1", .frames = {{40, 0, 0}}, .count = 1};
  choose(&device, -1, &choice, NULL, &status, NULL);
  assert_false(device.is_hurried);
}

/* Chooses the best few and says which contrasts they have, as "90 60 ". */
static size_t choose_few(placido_device *device, size_t most, char *contrasts,
                         placido_choice *choices) {
  placido_frame frames[FRAMES_MAX];
  size_t count;
  placido_error err = {0};
  contrasts[0] = '\0';
  if (placido_frames_choose(frames, choices, most, &count, device, NULL, &err)) {
    assert_int_equal(count, 0);
    return 0;
  }
  for (size_t i = 0; i < count; i++) {
    sprintf(contrasts + strlen(contrasts), "%d ", (int)frames[i].seq);
    placido_frame_free(&frames[i]);
  }
  return count;
}

static void test_the_best_few_come_in_their_order(void **state) {
  (void)state;
  placido_device device = {
      .frames = {{40, 0, 0}, {90, 0, 0}, {60, 0, 0}, {20, 0, 0}, {80, 0, 0}}, .count = 5};
  placido_choice choices[FRAMES_MAX];
  char contrasts[64];
  assert_int_equal(choose_few(&device, 3, contrasts, choices), 3);
  assert_string_equal(contrasts, "90 80 60 ");
  assert_int_equal(choices[0].index, 1);
  assert_int_equal(choices[1].index, 4);
  assert_int_equal(choices[2].index, 2);
  assert_int_equal(choices[2].frames, 5);
  assert_int_equal(choose_few(&device, FRAMES_MAX, contrasts, choices), 5);
  assert_string_equal(contrasts, "90 80 60 40 20 ");
}

/* Of damaged frames the best comes only where no whole one does. */
static void test_the_best_few_are_whole(void **state) {
  (void)state;
  const uint32_t cut = PLACIDO_FRAME_TRUNCATED;
  placido_device device = {
      .frames = {{90, cut, 0}, {40, 0, 0}, {0, 0, PLACIDO_INPUT}, {60, 0, 0}}, .count = 4};
  placido_choice choices[FRAMES_MAX];
  char contrasts[64];
  assert_int_equal(choose_few(&device, 3, contrasts, choices), 2);
  assert_string_equal(contrasts, "60 40 ");
  assert_int_equal(choices[0].damaged, 2);
  device = (placido_device){.frames = {{90, cut, 0}, {95, cut, 0}}, .count = 2};
  assert_int_equal(choose_few(&device, 3, contrasts, choices), 1);
  assert_string_equal(contrasts, "95 ");
  device = (placido_device){.frames = {{90, 0, 0}, {0, 0, PLACIDO_GONE}}, .count = 2};
  assert_int_equal(choose_few(&device, 3, contrasts, choices), 0);
  assert_int_equal(choices[0].index, -1);
}

static void test_first_of_equals_wins(void **state) {
  (void)state;
  placido_device device = {.frames = {{40, 0, 0}, {90, 0, 0}, {90, 0, 0}}, .count = 3};
  placido_choice choice;
  int status;
  choose(&device, -1, &choice, NULL, &status, NULL);
  assert_int_equal(choice.index, 1);
}

static void test_asked_for_is_taken(void **state) {
  (void)state;
  placido_device device = {.frames = {{40, 0, 0}, {90, 0, 0}, {60, 0, 0}}, .count = 3};
  placido_choice choice;
  int status;
  assert_int_equal(choose(&device, 2, &choice, NULL, &status, NULL), 60);
  assert_int_equal(choice.index, 2);
}

/* The device's own patience ends the wait; a camera that is there and silent is given up at once. */
static void test_an_unplugged_device_is_waited_for(void **state) {
  (void)state;
  placido_device device = {.frames = {{40, 0, 0},
                                      {0, 0, PLACIDO_TIMEOUT},
                                      {0, 0, PLACIDO_TIMEOUT},
                                      {90, 0, 0}},
                           .count = 4,
                           .is_waiting = true,
                           .replugs = 2};
  placido_choice choice;
  placido_notes notes = {0};
  placido_error err = {0};
  int status;
  assert_int_equal(choose(&device, -1, &choice, &notes, &status, NULL), 90);
  assert_int_equal(status, PLACIDO_OK);
  assert_int_equal(choice.frames, 2);
  assert_int_equal(notes.count, 1);
  assert_non_null(strstr(notes.lines[0], "was unplugged and came back, 2 times"));
  placido_notes_clear(&notes);
  device.is_waiting = false;
  choose(&device, -1, &choice, NULL, &status, NULL);
  assert_int_equal(status, PLACIDO_TIMEOUT);
  device.is_waiting = true;
  device.frames[2].status = PLACIDO_GONE;
  assert_int_equal(choose(&device, -1, &choice, NULL, &status, &err), -1);
  assert_int_equal(status, PLACIDO_GONE);
}

/* Frames beyond the end and undecodable ones: told with the number of what is there. */
static void test_asked_for_is_not_there(void **state) {
  (void)state;
  placido_device device = {.frames = {{40, 0, 0}, {0, 0, PLACIDO_INPUT}}, .count = 2};
  placido_choice choice;
  placido_error err = {0};
  int status;
  assert_int_equal(choose(&device, 5, &choice, NULL, &status, &err), -1);
  assert_int_equal(status, PLACIDO_INPUT);
  assert_non_null(strstr(err.text, "frame 5"));
  assert_int_equal(choose(&device, 1, &choice, NULL, &status, &err), -1);
  assert_int_equal(status, PLACIDO_INPUT);
}

/* A whole frame goes before a damaged one of more contrast; what is damaged is told. */
static void test_damaged_loses(void **state) {
  (void)state;
  placido_device device = {
      .frames = {{90, PLACIDO_FRAME_TRUNCATED, 0}, {40, 0, 0}, {95, PLACIDO_FRAME_CORRUPT, 0},
                 {0, 0, PLACIDO_INPUT}},
      .count = 4};
  placido_notes notes = {0};
  placido_choice choice;
  int status;
  assert_int_equal(choose(&device, -1, &choice, &notes, &status, NULL), 40);
  assert_int_equal(status, PLACIDO_OK);
  assert_int_equal(choice.damaged, 3);
  assert_int_equal(choice.frames, 4);
  assert_int_equal(notes.count, 1);
  placido_notes_clear(&notes);
}

static void test_only_damaged_is_taken_and_told(void **state) {
  (void)state;
  placido_device device = {
      .frames = {{40, PLACIDO_FRAME_TRUNCATED, 0}, {60, PLACIDO_FRAME_TRUNCATED, 0}}, .count = 2};
  placido_notes notes = {0};
  placido_choice choice;
  int status;
  assert_int_equal(choose(&device, -1, &choice, &notes, &status, NULL), 60);
  assert_non_null(strstr(notes.lines[0], "the one examined among them"));
  placido_notes_clear(&notes);
}

static void test_nothing_there(void **state) {
  (void)state;
  placido_device device = {.count = 0};
  placido_choice choice;
  placido_error err = {0};
  int status;
  assert_int_equal(choose(&device, -1, &choice, NULL, &status, &err), -1);
  assert_int_equal(status, PLACIDO_INPUT);
}

/* A device that breaks ends the search with its own status and words. */
/* A camera never ends: a second or so of it is looked at, or as far as the frame asked for. */
static void test_endless_device_is_left_again(void **state) {
  (void)state;
  placido_device device = {
      .info = {.endless = true}, .frames = {{10, 0, 0}, {90, 0, 0}}, .count = 2};
  placido_choice choice;
  int status;
  assert_int_equal(choose(&device, -1, &choice, NULL, &status, NULL), 90);
  assert_int_equal(status, PLACIDO_OK);
  assert_true(choice.frames > 2 && choice.frames < 100);
  assert_int_equal(choose(&device, 6, &choice, NULL, &status, NULL), 10);
  assert_int_equal(choice.frames, 7);
}

static void test_device_error_is_passed_on(void **state) {
  (void)state;
  placido_device device = {.frames = {{40, 0, 0}, {0, 0, PLACIDO_TIMEOUT}}, .count = 2};
  placido_choice choice;
  placido_error err = {0};
  int status;
  assert_int_equal(choose(&device, -1, &choice, NULL, &status, &err), -1);
  assert_int_equal(status, PLACIDO_TIMEOUT);
  assert_string_equal(err.text, "scripted");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_best_wins),
      cmocka_unit_test(test_a_recording_is_hurried_through),
      cmocka_unit_test(test_the_best_few_come_in_their_order),
      cmocka_unit_test(test_the_best_few_are_whole),
      cmocka_unit_test(test_first_of_equals_wins),
      cmocka_unit_test(test_asked_for_is_taken),
      cmocka_unit_test(test_an_unplugged_device_is_waited_for),
      cmocka_unit_test(test_asked_for_is_not_there),
      cmocka_unit_test(test_damaged_loses),
      cmocka_unit_test(test_only_damaged_is_taken_and_told),
      cmocka_unit_test(test_nothing_there),
      cmocka_unit_test(test_endless_device_is_left_again),
      cmocka_unit_test(test_device_error_is_passed_on),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
