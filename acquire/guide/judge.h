/* What the figures of a frame mean, seen against those before. */
#ifndef PLACIDO_GUIDE_JUDGE_H
#define PLACIDO_GUIDE_JUDGE_H

#include "acquire/guide.h"

/* Of one frame. */
typedef struct placido_guide_figures {
  bool found;
  double u_px, v_px;
  double gap_px;        /* mean distance of two edges in this frame */
  double contrast;      /* share of full scale */
  double upper, lower;  /* coverage of the picture's two halves */
  double white;         /* share of samples at the upper end */
  int64_t t_ns;         /* 0: not known */
} placido_guide_figures;

/* What is remembered. Zero is the start. */
typedef struct placido_guide_memory {
  int64_t now_ns;
  int64_t seen_ns;    /* when an eye with open lids was seen last; 0: never */
  double coverage;    /* that is usual of this eye: of the last few seconds' best frames */
  bool had_centre;
  double centre_px[2]; /* of the last frame */
} placido_guide_memory;

/* Sets state, score, instruction, and motion where only a shift can tell; the other figures of
 * `guidance` stand already. */
void placido_guide_judge(placido_guide_memory *memory, placido_guidance *guidance,
                         const placido_guide_figures *figures);

#endif
