/* The way of a frame through the guide: small picture, centre, innermost mires, all mires, and what
 * it means. */
#include "acquire/guide.h"

#include "acquire/guide/blur.h"
#include "acquire/guide/centre.h"
#include "acquire/guide/expect.h"
#include "acquire/guide/focus.h"
#include "acquire/guide/inner.h"
#include "acquire/guide/judge.h"
#include "acquire/guide/walk.h"
#include "base/memory.h"

#include <math.h>

#define SPHERE_MM 7.8
#define EDGES_MIN 6
#define GAP_MIN_PX 3.5      /* finer mires cannot be told apart */
#define GAP_SAMPLES 4.0     /* along a meridian in the narrowest gap, where the picture has them */
#define SMALL_GAP_PX 3.4    /* in the small picture */
#define LIKENESS_MIN 0.68   /* of the sectors that show the pattern; a chequerboard has 0.65 */
#define INNER_MIN 0.75      /* share of the innermost edges */
#define ROUGHNESS_MAX 0.08  /* of a gap; skin has twice that, heavy noise half */
#define WINDOW 3.0          /* times the mires' radius: how far from the axis they are looked for */
#define BLUR_MAX_GAP 0.6    /* of the narrowest gap, that break-up can be told */
#define MOTION_MAX_GAP 1.2
#define REACH 1.35          /* of the ordinary cornea's mires: how far they are followed */

struct placido_guide {
  placido_instrument instrument;
  int edge_count;
  double expected_px[PLACIDO_EDGES_MAX];
  placido_guide_pattern pattern;
  placido_guide_small small;
  placido_guide_polar polar;
  placido_guide_inner inner;
  placido_guide_walk walk;
  placido_guide_focus focus;
  placido_guide_memory memory;
  placido_guide_point *points;
  size_t point_count;
};

/* Edges from the innermost outwards that an ordinary cornea shows ever farther out. */
static int count_edges(const double *expected_px, int edge_count) {
  int count = 0;
  while (count < edge_count && expected_px[count] > (count > 0 ? expected_px[count - 1] : 0)) {
    count++;
  }
  return count;
}

static int plan(placido_guide *guide, placido_error *err) {
  const placido_instrument *instrument = &guide->instrument;
  placido_guide_expect(guide->expected_px, instrument,
                       &(placido_guide_cornea){.radius_mm = SPHERE_MM});
  guide->edge_count = count_edges(guide->expected_px, instrument->edge_count);
  if (guide->edge_count < EDGES_MIN) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "instrument \"%s\": an ordinary cornea shows %d of its edges, the "
                             "guide needs %d", instrument->name, guide->edge_count, EDGES_MIN);
  }
  placido_guide_pattern_make(&guide->pattern, guide->expected_px, guide->edge_count,
                             instrument->first_band_bright);
  if (!(guide->pattern.gap_px >= GAP_MIN_PX)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "instrument \"%s\": its innermost edges stand %.1f px apart, the "
                             "guide needs %g", instrument->name, guide->pattern.gap_px, GAP_MIN_PX);
  }
  placido_guide_focus_prepare(&guide->focus, instrument, guide->edge_count);
  return PLACIDO_OK;
}

static double narrowest_gap(const placido_guide *guide) {
  double least = INFINITY;
  for (int k = 1; k < guide->edge_count; k++) {
    least = fmin(least, guide->expected_px[k] - guide->expected_px[k - 1]);
  }
  return least;
}

static int make_room(placido_guide *guide, placido_error *err) {
  const placido_instrument *instrument = &guide->instrument;
  placido_guide_small *small = &guide->small;
  placido_guide_polar *polar = &guide->polar;
  const size_t meridians = PLACIDO_GUIDE_MERIDIANS, edges = (size_t)guide->edge_count;
  small->bin = (int)fmax(1, floor(guide->pattern.gap_px / SMALL_GAP_PX));
  small->width = instrument->width_px / small->bin;
  small->height = instrument->height_px / small->bin;
  for (int i = 0; i < 2; i++) {
    small->axis[i] = (instrument->principal_px[i] + 0.5) / small->bin - 0.5;
  }
  polar->step_px = fmax(1, narrowest_gap(guide) / GAP_SAMPLES);
  polar->samples = (int)(REACH * guide->expected_px[edges - 1] / polar->step_px) + 8;
  guide->walk = (placido_guide_walk){.edge_count = guide->edge_count,
                                     .expected_px = guide->expected_px,
                                     .first_bright = instrument->first_band_bright};
  small->grey = placido_memory_new((size_t)small->width * (size_t)small->height,
                                   sizeof *small->grey, err);
  small->slopes = placido_memory_new(PLACIDO_GUIDE_SLOPES_MAX, sizeof *small->slopes, err);
  polar->data = placido_memory_new(meridians * (size_t)polar->samples, sizeof *polar->data, err);
  guide->walk.radius_px =
      placido_memory_new(meridians * edges, sizeof *guide->walk.radius_px, err);
  guide->walk.wavers = placido_memory_new(meridians * edges, sizeof *guide->walk.wavers, err);
  guide->walk.numbered = placido_memory_new(meridians, sizeof *guide->walk.numbered, err);
  guide->points = placido_memory_new(meridians * edges, sizeof *guide->points, err);
  return small->grey && small->slopes && polar->data && guide->walk.radius_px &&
                 guide->walk.wavers && guide->walk.numbered && guide->points
             ? PLACIDO_OK
             : PLACIDO_MEMORY;
}

int placido_guide_new(placido_guide **guide, const placido_instrument *instrument,
                      placido_error *err) {
  *guide = placido_memory_new(1, sizeof **guide, err);
  if (!*guide) {
    return PLACIDO_MEMORY;
  }
  (*guide)->instrument = *instrument;
  int status = plan(*guide, err);
  if (status == PLACIDO_OK) {
    status = make_room(*guide, err);
  }
  if (status != PLACIDO_OK) {
    placido_guide_free(*guide);
    *guide = NULL;
  }
  return status;
}

void placido_guide_free(placido_guide *guide) {
  if (guide) {
    placido_memory_free(guide->small.grey);
    placido_memory_free(guide->small.slopes);
    placido_memory_free(guide->polar.data);
    placido_memory_free(guide->walk.radius_px);
    placido_memory_free(guide->walk.wavers);
    placido_memory_free(guide->walk.numbered);
    placido_memory_free(guide->points);
    placido_memory_free(guide);
  }
}

/* About the point that the picture's edges run about, else about the last frame's centre. */
static void find_inner(placido_guide *guide, const placido_guide_view *view) {
  const placido_guide_pattern *pattern = &guide->pattern;
  const double outer_px = guide->expected_px[guide->edge_count - 1];
  guide->inner.found = false;
  placido_guide_view_shrink(guide->small.grey, view, guide->small.bin);
  placido_guide_slopes_find(&guide->small, WINDOW * outer_px / guide->small.bin);
  if (placido_guide_centre(guide->polar.centre_px, &guide->small, pattern->high_px, outer_px)) {
    placido_guide_inner_find(&guide->inner, pattern, &guide->polar, view);
  }
  if (!guide->inner.found && guide->memory.had_centre) {
    guide->polar.centre_px[0] = guide->memory.centre_px[0];
    guide->polar.centre_px[1] = guide->memory.centre_px[1];
    placido_guide_inner_find(&guide->inner, pattern, &guide->polar, view);
  }
}

static void list_points(placido_guide *guide) {
  for (int m = 0; m < PLACIDO_GUIDE_MERIDIANS; m++) {
    double along[2];
    placido_guide_direction(along, m);
    const float *row = guide->walk.radius_px + (size_t)m * (size_t)guide->edge_count;
    for (int k = 0; k < guide->edge_count; k++) {
      if (!isnan(row[k])) {
        guide->points[guide->point_count++] =
            (placido_guide_point){(float)(guide->inner.centre_px[0] + along[0] * (double)row[k]),
                                  (float)(guide->inner.centre_px[1] + along[1] * (double)row[k])};
      }
    }
  }
}

static void find_place(const placido_guide *guide, placido_guidance *guidance) {
  double mm[2];
  const double scale = guide->inner.scale;
  placido_guide_place(mm, &guide->instrument, guide->inner.centre_px);
  const double follow = placido_guide_follow(&guide->instrument, scale * SPHERE_MM);
  guidance->x_mm = mm[0] / follow;
  guidance->y_mm = mm[1] / follow;
  guidance->u_px = guide->inner.centre_px[0];
  guidance->v_px = guide->inner.centre_px[1];
}

/* Whether what looks like the innermost mires in most directions is a row of closed lines, too. */
static bool confirm(placido_guide *guide, const placido_guide_view *view) {
  const placido_guide_walk *walk = &guide->walk;
  if (!guide->inner.found || guide->inner.likeness < LIKENESS_MIN) {
    return false;
  }
  placido_guide_polar_fill(&guide->polar, view, guide->polar.samples);
  placido_guide_walk_run(&guide->walk, &guide->polar, &guide->inner);
  return walk->inner >= INNER_MIN && walk->roughness <= ROUGHNESS_MAX;
}

/* Whether the narrowest edges still stand apart: else they waver by themselves. */
static bool is_sharp(const placido_guide *guide, const placido_guidance *guidance) {
  const double gap_px = guide->inner.scale * narrowest_gap(guide);
  return guidance->blur_px < BLUR_MAX_GAP * gap_px && guidance->motion_px < MOTION_MAX_GAP * gap_px;
}

/* Everything that one frame tells by itself. */
static void measure(placido_guide *guide, const placido_guide_view *view,
                    placido_guidance *guidance, placido_guide_figures *figures) {
  const placido_guide_inner *inner = &guide->inner;
  const double radius_px = inner->scale * guide->expected_px[guide->edge_count - 1];
  const placido_guide_clipping clipping =
      placido_guide_view_clipping(view, inner->centre_px, radius_px);
  guidance->clipped = clipping.black + clipping.white;
  find_place(guide, guidance);
  placido_guide_blur(&guidance->blur_px, &guidance->motion_px, &guide->polar, &guide->pattern,
                     &guide->walk);
  guidance->coverage = guide->walk.coverage;
  guidance->break_up = is_sharp(guide, guidance) ? guide->walk.break_up : (double)NAN;
  guidance->focus_mm = -placido_guide_focus_find(&guide->focus, &guide->walk);
  list_points(guide);
  figures->found = true;
  figures->gap_px = (radius_px - inner->scale * guide->expected_px[0]) / (guide->edge_count - 1);
  figures->u_px = inner->centre_px[0];
  figures->v_px = inner->centre_px[1];
  figures->contrast = inner->contrast;
  figures->upper = guide->walk.upper;
  figures->lower = guide->walk.lower;
  figures->white = clipping.white;
}

int placido_guide_look(placido_guide *guide, const placido_frame *frame,
                       placido_guidance *guidance, placido_error *err) {
  const placido_instrument *instrument = &guide->instrument;
  *guidance = (placido_guidance){.x_mm = NAN, .y_mm = NAN, .focus_mm = NAN, .blur_px = NAN,
                                 .motion_px = NAN, .break_up = NAN, .u_px = NAN, .v_px = NAN};
  guide->point_count = 0;
  if (frame->width_px != instrument->width_px || frame->height_px != instrument->height_px) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a frame of %d × %d pixels: the instrument's have %d × %d",
                             frame->width_px, frame->height_px, instrument->width_px,
                             instrument->height_px);
  }
  placido_guide_figures figures = {.t_ns = frame->t_ns};
  const placido_guide_view view = placido_guide_view_of(frame);
  find_inner(guide, &view);
  if (confirm(guide, &view)) {
    measure(guide, &view, guidance, &figures);
  }
  placido_guide_judge(&guide->memory, guidance, &figures);
  return PLACIDO_OK;
}

const placido_guide_point *placido_guide_points(const placido_guide *guide, size_t *count) {
  *count = guide->point_count;
  return guide->points;
}
