/* Whatever stands in a script of faults: read, or refused with one line, and played on frames of
 * every format. */
#include "drivers/replay/strike.h"
#include "tests/fuzz/target.h"

#include <stdlib.h>
#include <string.h>

static void check_fault(const placido_fault *fault) {
  if ((int)fault->kind < 0 || fault->kind >= PLACIDO_FAULT_KINDS || fault->at < 0 ||
      fault->frames < 1 || fault->duration_ns < 0) {
    abort();
  }
}

static void play(const placido_faults *faults, enum placido_format format, int height_px) {
  static placido_strikes strikes;
  strikes.faults = *faults;
  placido_strikes_rewind(&strikes);
  placido_frame frame = {0};
  if (placido_frame_resize(&frame, 5, height_px, format, NULL)) {
    abort();
  }
  memset(frame.data, 1, (size_t)frame.height_px * frame.stride_bytes);
  for (int64_t i = 0; i < 40; i++) {
    const placido_strike strike = placido_strikes_at(&strikes, i, i * 100000000);
    placido_strike_spoil(&strike, &frame);
    if (strike.delay_ns < 0 || strike.absence_ns < 0) {
      abort();
    }
  }
  placido_frame_free(&frame);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  placido_faults faults;
  placido_error err = {0};
  if (placido_faults_parse(&faults, (const char *)data, size, "script", &err)) {
    if (faults.count != 0 || strncmp(err.text, "script:", 7) != 0 || strchr(err.text, '\n')) {
      abort();
    }
    return 0;
  }
  for (size_t i = 0; i < faults.count; i++) {
    check_fault(&faults.list[i]);
  }
  play(&faults, PLACIDO_MONO8, 1);
  play(&faults, PLACIDO_MONO16, 2);
  play(&faults, PLACIDO_RGB8, 3);
  return 0;
}
