/* Recorded sessions: session.json, frames.jsonl, events.jsonl and frames.mkv in this order, a record
 * separator (ASCII 30) between them, read, surveyed, checked, repaired and exported. */
#include "base/memory.h"
#include "base/session/archive.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <placido/session.h>

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define FRAMES_MAX 40

static const char instrument[] =
    "{\"format\": \"placido-instrument/1\", \"name\": \"fuzz\", \"camera\": {\"model\": "
    "\"pinhole\", \"image_size_px\": [16, 8], \"focal_px\": 100, \"principal_px\": [8, 4], "
    "\"position_mm\": [0, 0, 100]}, \"mires\": {\"first_band\": \"dark\", \"edges\": "
    "[{\"radius_mm\": 10, \"z_mm\": 50}]}}";

static void write_files(const uint8_t *data, size_t size) {
  static const char *const names[] = {"fuzz.session/session.json", "fuzz.session/frames.jsonl",
                                      "fuzz.session/events.jsonl"};
  mkdir(fuzz_path("fuzz.session"), 0700); /* is there from the second time on */
  fuzz_file("fuzz.session/instrument.json", instrument, sizeof instrument - 1);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
    size_t part_size;
    const uint8_t *part = fuzz_part(&part_size, &data, &size);
    fuzz_file(names[i], part, part_size);
  }
  fuzz_file("fuzz.session/frames.mkv", data, size);
}

/* Every frame: given, or refused with a reason. */
static int64_t read_frames(placido_session_reader *reader) {
  placido_frame frame = {0};
  int64_t whole = 0;
  for (int64_t i = 0; i < FRAMES_MAX; i++) {
    placido_error err = {0};
    int status = placido_session_reader_next(reader, &frame, &err);
    if (fuzz_check(status, &err)) {
      whole++;
      FUZZ_REQUIRE(frame.width_px >= 1 && frame.height_px >= 1 && frame.bits >= 8);
      FUZZ_REQUIRE(placido_session_reader_frame_info(reader).index >= 0);
    } else if (status != PLACIDO_INPUT) {
      break;
    }
  }
  placido_frame_free(&frame);
  return whole;
}

static void read_twice(const char *path, placido_notes *notes) {
  placido_session_reader *reader;
  placido_error err = {0};
  if (fuzz_check(placido_session_reader_open(&reader, path, notes, &err), &err)) {
    int64_t whole = read_frames(reader);
    if (fuzz_check(placido_session_reader_rewind(reader, &err), &err)) {
      FUZZ_REQUIRE(read_frames(reader) == whole);
    }
  } else {
    FUZZ_REQUIRE(reader == NULL);
  }
  placido_session_reader_close(reader);
}

static void check(const char *path, placido_notes *notes) {
  static placido_findings findings;
  placido_session_survey survey;
  placido_error err = {0};
  fuzz_check(placido_session_survey_take(&survey, path, notes, &err), &err);
  if (fuzz_check(placido_session_check(&findings, &survey, path, &err), &err)) {
    FUZZ_REQUIRE(findings.count >= 1 && findings.count <= PLACIDO_FINDINGS_MAX);
    FUZZ_REQUIRE(findings.damage <= findings.count);
  }
}

/* What a repair leaves is whole. */
static void repair(const char *path, placido_notes *notes) {
  static placido_findings findings;
  static unsigned number;
  placido_session_survey survey;
  placido_repair_summary summary;
  placido_error err = {0};
  char name[32];
  snprintf(name, sizeof name, "whole-%u.session", number++);
  const char *target = fuzz_path(name);
  if (fuzz_check(placido_session_repair(&summary, path, target, NULL, notes, &err), &err)) {
    FUZZ_REQUIRE(summary.kept >= 1);
    FUZZ_REQUIRE(fuzz_check(placido_session_check(&findings, &survey, target, &err), &err));
    FUZZ_REQUIRE(survey.frames == summary.kept && survey.damaged == 0);
  }
  placido_repair_summary_free(&summary);
  fuzz_remove(target);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  placido_notes notes = {0};
  write_files(data, size);
  const char *path = fuzz_path("fuzz.session");
  read_twice(path, &notes);
  check(path, &notes);
  repair(fuzz_path("fuzz.session"), &notes);
  placido_notes_clear(&notes);
  return 0;
}
