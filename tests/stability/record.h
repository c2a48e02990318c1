/* What a computation has given, to be compared bit by bit with what it gives again. */
#ifndef PLACIDO_TESTS_STABILITY_RECORD_H
#define PLACIDO_TESTS_STABILITY_RECORD_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>

/* What a stage has given, written down number by number: structs have gaps. */
struct record {
  double *numbers;
  size_t count, room;
};

static inline void note(struct record *record, double number) {
  if (record->count == record->room) {
    record->room = 2 * record->room + 1024;
    record->numbers = realloc(record->numbers, record->room * sizeof *record->numbers);
    assert_non_null(record->numbers);
  }
  record->numbers[record->count++] = number;
}

static inline void note_all(struct record *record, const double *numbers, size_t count) {
  for (size_t i = 0; i < count; i++) {
    note(record, numbers[i]);
  }
}

static inline void note_floats(struct record *record, const float *numbers, size_t count) {
  for (size_t i = 0; i < count; i++) {
    note(record, (double)numbers[i]);
  }
}

/* How many numbers differ in any bit. */
static inline size_t differing(const struct record *a, const struct record *b) {
  size_t count = 0;
  assert_int_equal(a->count, b->count);
  for (size_t i = 0; i < a->count; i++) {
    count += memcmp(&a->numbers[i], &b->numbers[i], sizeof *a->numbers) != 0;
  }
  return count;
}

#endif
