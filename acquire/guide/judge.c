/* Every figure has a limit above which a frame is not worth measuring. The score is the product of
 * how well each keeps it; the instruction is about the first one that does not, in the order in
 * which a person puts things right. */
#include "acquire/guide/judge.h"

#include <math.h>
#include <stdio.h>

#define FRAME_NS 33333333LL       /* where frames have no time */
#define BLINK_NS 700000000LL      /* a blink lasts 0.1 to 0.4 s; what hides longer is no blink */
#define FORGET_S 3.0              /* after which the usual coverage has fallen to a third */
#define LOST_SHARE 0.75           /* of the usual coverage: below it, something hides the eye */
#define LID_LEAD 0.15             /* and the upper half is hidden by so much more: a lid */

static const double centring_max_mm = 0.25;
static const double focus_max_mm = 0.25;
static const double blur_max_gap = 0.28;   /* of a gap: the slope falls to half of what it was */
static const double motion_max_gap = 0.35; /* likewise, as a length */
static const double white_max = 0.03;
static const double break_up_max = 0.1;
static const double coverage_min = 0.6;
static const double contrast_min = 0.08;

/* Half of the score is left at the limit. */
static double part(double value, double limit) {
  const double ratio = value / limit;
  return isnan(value) ? 1 : exp2(-ratio * ratio);
}

static bool is_over(double value, double limit) {
  return value > limit; /* NaN: cannot be told */
}

static double score_of(const placido_guidance *g, const placido_guide_figures *f) {
  return g->coverage * part(hypot(g->x_mm, g->y_mm), 2 * centring_max_mm) *
         part(g->focus_mm, 2 * focus_max_mm) * part(g->blur_px, blur_max_gap * f->gap_px) *
         part(g->motion_px, motion_max_gap * f->gap_px) * part(f->white, white_max) *
         part(g->break_up, 2 * break_up_max) * fmin(1, f->contrast / contrast_min);
}

/* "left 0.3 mm, up 0.2 mm": the ways that are worth it. */
static void say_way(char *text, size_t size, double x_mm, double y_mm) {
  const double least_mm = fmin(0.1, 0.5 * fmax(fabs(x_mm), fabs(y_mm)));
  char across[24] = "", along[24] = "";
  if (fabs(x_mm) > least_mm) {
    snprintf(across, sizeof across, "%s %.1f mm", x_mm < 0 ? "left" : "right", fabs(x_mm));
  }
  if (fabs(y_mm) > least_mm) {
    snprintf(along, sizeof along, "%s %.1f mm", y_mm < 0 ? "down" : "up", fabs(y_mm));
  }
  snprintf(text, size, "%s%s%s", across, across[0] && along[0] ? ", " : "", along);
}

static bool is_out_of_focus(const placido_guidance *g, const placido_guide_figures *f) {
  return is_over(fabs(g->focus_mm), focus_max_mm) ||
         is_over(g->blur_px, blur_max_gap * f->gap_px);
}

static void say_focus(char *text, size_t size, double focus_mm) {
  if (is_over(fabs(focus_mm), 0.5 * focus_max_mm)) {
    snprintf(text, size, "%s %.1f mm", focus_mm > 0 ? "closer" : "back", fabs(focus_mm));
  } else {
    snprintf(text, size, "focus");
  }
}

/* True where the frame is worth measuring. */
static bool instruct(placido_guidance *g, const placido_guide_figures *f) {
  char *text = g->instruction;
  const size_t size = sizeof g->instruction;
  if (is_over(hypot(g->x_mm, g->y_mm), centring_max_mm)) {
    say_way(text, size, g->x_mm, g->y_mm);
  } else if (is_over(f->white, white_max)) {
    snprintf(text, size, "less light");
  } else if (f->contrast < contrast_min) {
    snprintf(text, size, "more light");
  } else if (is_over(g->motion_px, motion_max_gap * f->gap_px)) {
    snprintf(text, size, "hold still");
  } else if (is_out_of_focus(g, f)) {
    say_focus(text, size, g->focus_mm);
  } else if (f->upper < f->lower - LID_LEAD && g->coverage < coverage_min) {
    snprintf(text, size, "open the eye wider");
  } else if (g->coverage < coverage_min) {
    snprintf(text, size, "mires are hidden");
  } else if (is_over(g->break_up, break_up_max)) {
    snprintf(text, size, "blink, then hold");
  } else {
    snprintf(text, size, "hold");
    return true;
  }
  return false;
}

static void advance(placido_guide_memory *memory, int64_t t_ns) {
  const int64_t before_ns = memory->now_ns;
  memory->now_ns = t_ns > 0 ? t_ns : before_ns + FRAME_NS;
  const double seconds = fmax(0, 1e-9 * (double)(memory->now_ns - before_ns));
  memory->coverage *= exp(-seconds / FORGET_S);
}

/* Lids hide what was open a moment ago. */
static bool is_blink(const placido_guide_memory *memory, const placido_guidance *guidance,
                     const placido_guide_figures *f) {
  if (memory->seen_ns == 0 || memory->now_ns - memory->seen_ns > BLINK_NS) {
    return false;
  }
  return !f->found ||
         (guidance->coverage < LOST_SHARE * memory->coverage && f->upper < f->lower - LID_LEAD);
}

/* Without motion blur to be measured, the way since the last frame. */
static void follow(placido_guide_memory *memory, placido_guidance *guidance,
                   const placido_guide_figures *f) {
  if (f->found && isnan(guidance->motion_px) && memory->had_centre) {
    guidance->motion_px = hypot(f->u_px - memory->centre_px[0], f->v_px - memory->centre_px[1]);
  }
  memory->had_centre = f->found;
  memory->centre_px[0] = f->u_px;
  memory->centre_px[1] = f->v_px;
}

void placido_guide_judge(placido_guide_memory *memory, placido_guidance *guidance,
                         const placido_guide_figures *figures) {
  advance(memory, figures->t_ns);
  follow(memory, guidance, figures);
  guidance->score = figures->found ? score_of(guidance, figures) : 0;
  if (is_blink(memory, guidance, figures)) {
    guidance->state = PLACIDO_GUIDE_BLINK;
    snprintf(guidance->instruction, sizeof guidance->instruction, "wait: a blink");
    return;
  }
  if (!figures->found) {
    guidance->state = PLACIDO_GUIDE_NO_EYE;
    snprintf(guidance->instruction, sizeof guidance->instruction, "no eye");
    return;
  }
  memory->seen_ns = memory->now_ns;
  memory->coverage = fmax(memory->coverage, guidance->coverage);
  guidance->state =
      instruct(guidance, figures) ? PLACIDO_GUIDE_READY : PLACIDO_GUIDE_ALIGN;
}
