/* Judges frames as they come, as many as there is time for. */
#ifndef PLACIDO_ACQUIRE_SCORER_H
#define PLACIDO_ACQUIRE_SCORER_H

#include "acquire/guide.h"

#include <placido/frame.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stdint.h>

/* Starts zeroed but for the first two. */
typedef struct placido_scorer {
  placido_guide *guide;      /* NULL: none; then placido_frame_score judges, in bursts only */
  bool takes_its_time;       /* no frame is passed over: the source waits */
  placido_guidance guidance; /* the latest */
  bool has_guidance;
  int64_t ended_ns, took_ns; /* the last time */
} placido_scorer;

/* `score` is NaN where the frame was passed over: judging takes four fifths of the time at most, so
 * that a fast camera is not kept waiting. Returns PLACIDO_OK and what placido_guide_look and
 * placido_frame_score return. */
int placido_scorer_judge(placido_scorer *scorer, const placido_frame *frame, bool in_burst,
                         double *score, placido_error *err);

/* The score that an automatic burst goes by: NaN unless the eye is ready. */
double placido_scorer_readiness(const placido_scorer *scorer);

#endif
