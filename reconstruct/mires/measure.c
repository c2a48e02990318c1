/* Sub-pixel place of every edge: a blurred step, four parameters, fitted to the profile about it,
 * less its neighbours' tails and under even light. */
#include "reconstruct/mires/edges.h"
#include "reconstruct/mires/scale.h"
#include "reconstruct/mires/steps.h"
#include "reconstruct/mires/tracks.h"
#include "reconstruct/mires/usual.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

#define LANES PLACIDO_STEPS_LANES
#define ROUNDS 16  /* of fits less their neighbours' tails, at most */
#define WINDOW_PX 3.8     /* half a window, at least where neighbours leave room, */
#define WINDOW_WIDTHS 2.8 /* or so many blur widths, */
#define WINDOW_STEPS 2.9  /* or samples */
#define CROWDED_STEPS 2.5 /* so many samples towards a neighbour, if need be past the middle */
#define ALONE_WIDTHS 3.5  /* a neighbour so far from the window does not show in it */
#define SAMPLES_FEW 4
#define CLIPPED_WORTH 0.5F /* of a clipped sample, against a known one */
#define MERIDIANS_ROUGH 120 /* so many tell what is usual, */
#define ROUGH_PX 0.05F      /* by fits that need not be better than this */
#define FINE_PX 0.01F     /* Gauss-Newton's next step would be about the square */
#define SETTLED_PX 0.002  /* no further round for less, */
#define SETTLED 0.003     /* nor for a smaller change of height and width, as a share */
#define WIDTH_SIGMA 0.05   /* how far the width may differ from what is usual, as a share */
/* A background of bend·t² moves the place by so much times bend·width³/height: least squares of t²
 * by a constant and the normal density, over windows of 2.4 to 3 widths. */
#define LIGHT_PULL 15.0
#define LIGHT_DOUBT 0.7   /* what may be wrong with taking that off, as a share of it */
#define LIKE 0.5          /* neighbours' heights that differ by more do not tell about the light */

typedef struct work {
  const placido_crossings *all;
  const placido_polar *polar;
  placido_fitted *now;
  placido_usual *usual;         /* width NaN: nothing is known yet */
  bool *waits;                  /* for another round */
  double width_px;              /* what is usual before anything is known */
} work;

/* What is put beside each lane. */
typedef struct beside {
  placido_step_lanes sides[2]; /* inner and outer neighbour */
  placido_step_light light;
} beside;

static placido_fitted guess(const placido_crossing *c, double width_px) {
  double height = c->slope * sqrt(2 * M_PI) * hypot(width_px, 1);
  return (placido_fitted){.place_px = c->radius_px,
                          .height = (float)height,
                          .width = (float)width_px,
                          .good = true};
}

/* Unlike fmax and fmin these are no calls. */
static double larger(double a, double b) {
  return a > b ? a : b;
}

static double smaller(double a, double b) {
  return a < b ? a : b;
}

static void start_usual(placido_fitted *f, const placido_usual *usual) {
  f->offset = usual->offset;
  f->height = copysignf(usual->height, f->height);
  f->width = usual->width;
}

/* The blur of the image alone, and that with what the sampling adds along the meridian. */
static float image_width(float width, const placido_meridian *along) {
  return sqrtf((float)larger((double)(width * width) - along->radial_px2, 0.05));
}

static float sampled_width(float width, const placido_meridian *along) {
  return sqrtf(width * width + (float)along->radial_px2);
}

/* How far the window of an edge may reach towards a neighbour `gap` away: somewhat past the middle
 * between them, further where that would leave too few samples. */
static double reach_towards(double gap, double width, double step) {
  double wanted = larger(larger(WINDOW_PX, WINDOW_STEPS * step), WINDOW_WIDTHS * width);
  double crowded = smaller(0.95 * gap, CROWDED_STEPS * step);
  return smaller(wanted, larger(0.55 * gap, crowded));
}

/* Puts the neighbour on one side beside a lane; how far away it is. */
static double put_neighbour(beside *b, bool *shows, int side, int lane, const work *w, size_t i,
                            double *reach) {
  const placido_crossing *c = &w->all->list[i];
  const placido_fitted *was = &w->now[i], *n = side ? was + 1 : was - 1;
  const placido_meridian *along = &w->polar->along[c->meridian];
  double gap = INFINITY;
  bool there = side ? i + 1 < w->all->first[c->meridian + 1] : i > w->all->first[c->meridian];
  if (there) {
    gap = fabs(n->place_px - was->place_px);
  }
  *reach = reach_towards(gap, (double)sampled_width(was->width, along), along->step_px);
  if (!there || !n->good || (n->height > 0) == (was->height > 0)) {
    return INFINITY;
  }
  if (gap - *reach < ALONE_WIDTHS * (double)n->width) {
    b->sides[side].place[lane] = (float)(n->place_px - c->radius_px);
    b->sides[side].height[lane] = n->height;
    b->sides[side].width[lane] = sampled_width(n->width, along);
    *shows = true;
  }
  return gap;
}

/* The light about a crossing, from what is usual of it and of its neighbours at these distances
 * (INFINITY: none). */
static void put_light(beside *b, int lane, const work *w, size_t i, const double gaps[2]) {
  const placido_usual *own = &w->usual[i];
  double at[2], level[2];
  bool known[2];
  for (int side = 0; side < 2; side++) {
    const placido_usual *n = side ? own + 1 : own - 1;
    known[side] = isfinite(gaps[side]) && !isnan(n->width) &&
                  fabs((double)(n->height / own->height) - 1) < LIKE;
    at[side] = side ? gaps[side] : -gaps[side];
    level[side] = known[side] ? (double)(n->offset - own->offset) / at[side] : 0;
  }
  if (isnan(own->width) || !known[0] || !known[1]) {
    return;
  }
  double bend = (level[1] - level[0]) / (at[1] - at[0]);
  b->light.place[lane] = (float)(w->now[i].place_px - w->all->list[i].radius_px);
  b->light.bend[lane] = (float)bend;
  b->light.rise[lane] = (float)(level[1] - bend * at[1]);
}

/* Puts crossing i's profile and what is beside it into a lane. False where it is too short. */
static bool load(placido_steps *s, beside *b, bool *shows, int lane, const work *w, size_t i) {
  const placido_crossing *c = &w->all->list[i];
  const placido_meridian *along = &w->polar->along[c->meridian];
  const placido_fitted *was = &w->now[i];
  size_t row = (size_t)c->meridian * (size_t)w->polar->samples;
  double gaps[2], reach[2];
  bool first_round = isnan(w->usual[i].width);
  for (int side = 0; side < 2; side++) {
    gaps[side] = put_neighbour(b, shows, side, lane, w, i, &reach[side]);
  }
  if (!first_round) {
    put_light(b, lane, w, i, gaps);
  }
  int from = (int)ceil((was->place_px - reach[0] - along->start_px) / along->step_px);
  int to = (int)floor((was->place_px + reach[1] - along->start_px) / along->step_px);
  from = from < 0 ? 0 : from;
  to = to > along->count - 1 ? along->count - 1 : to;
  to = to - from >= PLACIDO_STEPS_SAMPLES ? from + PLACIDO_STEPS_SAMPLES - 1 : to;
  s->first[lane] = (float)(along->start_px + from * along->step_px - c->radius_px);
  s->pitch[lane] = (float)along->step_px;
  s->samples = to - from + 1 > s->samples ? to - from + 1 : s->samples;
  float count = 0;
  for (int k = from; k <= to; k++) {
    bool clipped = w->polar->clipped && w->polar->clipped[row + (size_t)k];
    s->value[k - from][lane] = w->polar->data[row + (size_t)k];
    s->weight[k - from][lane] = clipped ? PLACIDO_STEPS_CLIPPED : PLACIDO_STEPS_KNOWN;
    count += clipped ? CLIPPED_WORTH : 1;
  }
  s->step.place[lane] = (float)(was->place_px - c->radius_px);
  s->step.offset[lane] = was->offset;
  s->step.height[lane] = was->height;
  s->step.width[lane] = sampled_width(was->width, along);
  double usual = first_round ? w->width_px : (double)w->usual[i].width;
  double sigma = (first_round ? 0.4 : WIDTH_SIGMA) * usual;
  double noise = first_round ? 0.0004 * (double)(was->height * was->height)
                             : (double)w->usual[i].variance;
  s->usual[lane] = sampled_width((float)usual, along);
  s->hold[lane] = (float)(noise / (sigma * sigma));
  return count >= SAMPLES_FEW;
}

static void clear(placido_steps *s, beside *b) {
  int samples = s->samples;
  for (int k = 0; k < samples; k++) {
    for (int l = 0; l < LANES; l++) {
      s->weight[k][l] = s->value[k][l] = 0;
    }
  }
  s->samples = 0;
  *b = (beside){0};
  for (int l = 0; l < LANES; l++) {
    s->step.place[l] = s->step.height[l] = s->step.offset[l] = s->first[l] = s->pitch[l] = 0;
    s->step.width[l] = s->hold[l] = s->usual[l] = 1;
    b->sides[0].width[l] = b->sides[1].width[l] = 1;
  }
}

static void store(const placido_steps *s, const beside *b, int lane, const work *w, size_t i,
                  bool shows) {
  const placido_crossing *c = &w->all->list[i];
  const placido_meridian *along = &w->polar->along[c->meridian];
  placido_fitted *f = &w->now[i];
  float count = 0;
  for (int k = 0; k < s->samples; k++) {
    count += s->weight[k][lane] > PLACIDO_STEPS_KNOWN ? CLIPPED_WORTH : s->weight[k][lane];
  }
  float height = s->step.height[lane], width = image_width(s->step.width[lane], along);
  bool settled = fabs(c->radius_px + (double)s->step.place[lane] - f->place_px) < SETTLED_PX &&
                 fabsf(height - f->height) < SETTLED * fabsf(height) &&
                 fabsf(width - f->width) < SETTLED * width;
  w->waits[i] = shows && !settled;
  f->place_px = c->radius_px + (double)s->step.place[lane];
  f->offset = s->step.offset[lane];
  f->height = height;
  f->width = width;
  f->squares = s->squares[lane];
  f->freedom = fmaxf(count - 4 + s->held[lane], 0.02F);
  f->spread = s->spread[lane];
  f->bend = b->light.bend[lane];
  double far = fmax(1.5, w->width_px);
  f->good = fabs((double)s->step.place[lane]) < far && isfinite(f->squares) &&
            (f->height > 0) == (c->slope > 0);
}

/* Fits every other crossing of a meridian, from the first (odd 0) or second on: those between keep
 * still meanwhile. Returns how many were fitted. */
static size_t fit_round(const work *w, int meridian, int odd, float settled_px, placido_steps *s) {
  size_t next = w->all->first[meridian] + (size_t)odd, last = w->all->first[meridian + 1];
  size_t fitted = 0;
  beside b;
  while (next < last) {
    size_t members[LANES];
    bool shows[LANES] = {false}, tails = false;
    int lanes = 0;
    clear(s, &b);
    for (; next < last && lanes < LANES; next += 2) {
      if (!w->now[next].good || !w->waits[next]) {
        continue;
      }
      if (load(s, &b, &shows[lanes], lanes, w, next)) {
        tails |= shows[lanes];
        members[lanes++] = next;
      } else {
        w->now[next].good = false;
      }
    }
    if (tails) {
      placido_steps_take_off(s, &b.sides[0], 1);
      placido_steps_take_off(s, &b.sides[1], 0);
    }
    placido_steps_even(s, &b.light);
    if (lanes) {
      placido_steps_fit(s, settled_px);
    }
    for (int l = 0; l < lanes; l++) {
      store(s, &b, l, w, members[l], shows[l]);
    }
    fitted += (size_t)lanes;
  }
  return fitted;
}

/* Rounds over every stride-th meridian until nothing waits. */
static void fit_rounds(const work *w, int stride, float settled_px, int threads) {
#pragma omp parallel for num_threads(threads) schedule(static)
  for (int m = 0; m < w->all->meridians; m += stride) {
    placido_steps steps = {.samples = PLACIDO_STEPS_SAMPLES};
    bool busy = true;
    for (int round = 0; round < ROUNDS && busy; round += 2) {
      busy = fit_round(w, m, 0, settled_px, &steps) + fit_round(w, m, 1, settled_px, &steps) > 0;
    }
  }
}

/* The usual width before anything is measured, from the bends of the derivative's tops. */
static double first_width(const placido_crossings *all, double *values) {
  size_t count = 0;
  for (size_t i = 0; i < all->count; i++) {
    if (all->list[i].edge >= 0) {
      values[count++] = all->list[i].width_px;
    }
  }
  return count ? fmax(0.7, placido_quantile(values, count, 0.5)) : 1;
}

/* Hands over what was measured. Blurring a curved edge across its own tangent pulls it inwards by
 * variance / (2 radius). */
static void finish(placido_crossing *c, const placido_fitted *f, const placido_usual *usual,
                   const placido_meridian *along) {
  if (c->edge < 0 || !f->good) {
    c->edge = -1;
    return;
  }
  double width = (double)f->width, variance = width * width + along->tangential_px2;
  c->radius_px = f->place_px + variance / (2 * f->place_px);
  c->height = fabs((double)f->height);
  c->width_px = width;
  double pull = LIGHT_PULL * (double)f->bend * pow((double)sampled_width(f->width, along), 3);
  c->sigma_px = sqrt((double)usual->variance * (double)f->spread);
  c->light_px = LIGHT_DOUBT * fabs(pull) / c->height;
}

/* Measures on some meridians to learn what is usual, and on all with that in hand. */
static void measure(work *w, placido_crossings *crossings, const placido_tracks *tracks,
                    int threads) {
  int stride = (crossings->meridians + MERIDIANS_ROUGH - 1) / MERIDIANS_ROUGH;
  for (size_t i = 0; i < crossings->count; i++) {
    w->now[i] = guess(&crossings->list[i], w->width_px);
    w->usual[i].width = NAN;
    w->waits[i] = true;
  }
  fit_rounds(w, stride, ROUGH_PX, threads);
  placido_usual_find(w->usual, crossings, tracks, w->now);
  for (size_t i = 0; i < crossings->count; i++) {
    w->waits[i] = true;
    if (!(w->now[i].freedom > 0) && !isnan(w->usual[i].width)) {
      start_usual(&w->now[i], &w->usual[i]);
    }
  }
  fit_rounds(w, 1, FINE_PX, threads);
  placido_usual_find(w->usual, crossings, tracks, w->now);
  for (size_t i = 0; i < crossings->count; i++) {
    placido_crossing *c = &crossings->list[i];
    finish(c, &w->now[i], &w->usual[i], &w->polar->along[c->meridian]);
  }
}

int placido_crossings_measure(placido_crossings *crossings, const placido_polar *polar,
                              int threads, placido_error *err) {
  size_t count = crossings->count;
  work w = {.all = crossings, .polar = polar};
  placido_tracks tracks;
  double *widths = NULL;
  int status = placido_tracks_new(&tracks, crossings, err);
  if (!status) {
    w.now = placido_memory_new(count, sizeof *w.now, err);
      w.usual = placido_memory_new(count, sizeof *w.usual, err);
    w.waits = placido_memory_new(count, sizeof *w.waits, err);
    widths = placido_memory_new(count, sizeof *widths, err);
    status = w.now && w.usual && w.waits && widths ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (!status) {
    w.width_px = first_width(crossings, widths);
    measure(&w, crossings, &tracks, threads);
    placido_tracks_free(&tracks); /* some have lost their numbers */
    status = placido_tracks_new(&tracks, crossings, err);
  }
  if (!status) {
    status = placido_crossings_scale(crossings, &tracks, err);
  }
  placido_tracks_free(&tracks);
  placido_memory_free(w.now);
  placido_memory_free(w.usual);
  placido_memory_free(w.waits);
  placido_memory_free(widths);
  return status;
}
