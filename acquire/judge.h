/* Judges frames as they come, as many as there is time for. */
#ifndef PLACIDO_ACQUIRE_JUDGE_H
#define PLACIDO_ACQUIRE_JUDGE_H

#include "acquire/guide.h"

#include <placido/frame.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stdint.h>

/* Starts zeroed but for the guide. */
typedef struct placido_judge {
  placido_guide *guide;      /* NULL: none; then placido_frame_score judges, in bursts only */
  placido_guidance guidance; /* the latest */
  bool has_guidance;
  int64_t ended_ns, took_ns; /* the last time */
} placido_judge;

/* `score` is NaN where the frame was passed over: judging takes four fifths of the time at most, so
 * that a fast camera is not kept waiting. Returns PLACIDO_OK and what placido_guide_look returns. */
int placido_judge_frame(placido_judge *judge, const placido_frame *frame, bool in_burst,
                        double *score, placido_error *err);

/* The score that an automatic burst goes by: NaN unless the eye is ready. */
double placido_judge_readiness(const placido_judge *judge);

#endif
