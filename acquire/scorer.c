/* Judges frames as they come, as many as there is time for. */
#include "acquire/scorer.h"

#include "acquire/acquire.h"
#include "base/clock.h"

#include <math.h>

int placido_scorer_judge(placido_scorer *scorer, const placido_frame *frame, bool in_burst,
                         double *score, placido_error *err) {
  const int64_t started_ns = placido_clock_monotonic.now_ns();
  const bool is_pressed =
      !scorer->takes_its_time && started_ns - scorer->ended_ns < scorer->took_ns / 4;
  *score = NAN;
  if ((!scorer->guide && !in_burst) || is_pressed) {
    return PLACIDO_OK;
  }
  int status;
  if (scorer->guide) {
    status = placido_guide_look(scorer->guide, frame, &scorer->guidance, err);
    scorer->has_guidance = status == PLACIDO_OK;
    *score = scorer->has_guidance ? scorer->guidance.score : NAN;
  } else {
    status = placido_frame_score(score, frame, err);
  }
  scorer->ended_ns = placido_clock_monotonic.now_ns();
  scorer->took_ns = scorer->ended_ns - started_ns;
  return status;
}

double placido_scorer_readiness(const placido_scorer *scorer) {
  const bool is_ready = scorer->has_guidance && scorer->guidance.state == PLACIDO_GUIDE_READY;
  return is_ready ? scorer->guidance.score : NAN;
}
