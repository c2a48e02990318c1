/* Judges frames as they come, as many as there is time for. */
#include "acquire/judge.h"

#include "acquire/acquire.h"
#include "drivers/clock.h"

#include <math.h>

int placido_judge_frame(placido_judge *judge, const placido_frame *frame, bool in_burst,
                        double *score, placido_error *err) {
  const int64_t started_ns = placido_clock_monotonic.now_ns();
  *score = NAN;
  if ((!judge->guide && !in_burst) || started_ns - judge->ended_ns < judge->took_ns / 4) {
    return PLACIDO_OK;
  }
  int status;
  if (judge->guide) {
    status = placido_guide_look(judge->guide, frame, &judge->guidance, err);
    judge->has_guidance = status == PLACIDO_OK;
    *score = judge->has_guidance ? judge->guidance.score : NAN;
  } else {
    status = placido_frame_score(score, frame, err);
  }
  judge->ended_ns = placido_clock_monotonic.now_ns();
  judge->took_ns = judge->ended_ns - started_ns;
  return status;
}

double placido_judge_readiness(const placido_judge *judge) {
  const bool is_ready = judge->has_guidance && judge->guidance.state == PLACIDO_GUIDE_READY;
  return is_ready ? judge->guidance.score : NAN;
}
