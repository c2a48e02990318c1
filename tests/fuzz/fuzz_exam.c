/* An exam's directory as `placido compare` reads it: exam.json, indices.json, maps.csv and
 * maps_sigma.csv in this order, a record separator (ASCII 30) between them. */
#include "acquire/cli/compare.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>

static const char surface[] = "{\"format\": \"placido-surface/1\", \"radius_mm\": 0.3, \"parts\": "
                              "[{\"kind\": \"biconic\", \"r1\": 7.8, \"q1\": -0.2}]}";

static void write_files(const uint8_t *data, size_t size) {
  static const char *const names[] = {"exam/exam.json", "exam/indices.json", "exam/maps.csv",
                                      "exam/maps_sigma.csv"};
  mkdir(fuzz_path("exam"), 0700); /* is there from the second time on */
  fuzz_file("exam/surface.json", surface, sizeof surface - 1);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    size_t part_size;
    const uint8_t *part = fuzz_part(&part_size, &data, &size);
    fuzz_file(names[i], part, part_size);
  }
}

static void check(const struct compared_exam *exam) {
  const placido_measured *measured = &exam->measured;
  FUZZ_REQUIRE(measured->surface != NULL && measured->step_mm > 0);
  FUZZ_REQUIRE(measured->half >= 1 && measured->size == 2 * measured->half + 1);
  size_t count = (size_t)measured->size * (size_t)measured->size;
  for (int kind = 0; kind < PLACIDO_DIFFERENCES; kind++) {
    for (size_t i = 0; i < count; i++) {
      FUZZ_REQUIRE(!isinf(measured->sigmas[kind][i]));
    }
  }
  FUZZ_REQUIRE(exam->index_count <= COMPARE_INDICES_MAX);
  for (size_t i = 0; i < exam->index_count; i++) {
    const struct compared_index *index = &exam->indices[i];
    FUZZ_REQUIRE(memchr(index->name, '\0', sizeof index->name) != NULL);
    FUZZ_REQUIRE(!isinf(index->value) && !isinf(index->sigma));
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  struct compared_exam *exam;
  static struct comparison comparison;
  placido_notes notes = {0};
  placido_error err = {0};
  write_files(data, size);
  comparison = (struct comparison){.change_count = 0};
  exam = &comparison.exams[0];
  if (fuzz_check(compared_exam_load(exam, fuzz_path("exam"), size % 2, &notes, &err), &err)) {
    check(exam);
    comparison.exams[1] = *exam;
    compared_indices_find(&comparison);
    FUZZ_REQUIRE(comparison.change_count <= exam->index_count);
  }
  placido_measured_free(&exam->measured);
  placido_notes_clear(&notes);
  return 0;
}
