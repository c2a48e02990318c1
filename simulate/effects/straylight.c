/* Straylight: the eye's media scatter a sixth of the light, more with age, over the whole field.
 * A lamp veils what is dark beside it, and light and dark are less apart everywhere.
 *
 * What is bounded is scattered light against what stands in its place. Light of a cell of the
 * coarse picture may be anywhere in it, and the glare function is the mean over the distances that
 * this leaves possible, give or take half their difference. */
#include "base/dispatch.h"
#include "base/memory.h"
#include "simulate/effects/coarse.h"
#include "simulate/effects/effect.h"
#include "simulate/eye.h"
#include "simulate/models/veil.h"
#include "simulate/plan/view.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = PLACIDO_FACTS_SIDE, CELLS = SIDE * SIDE };

/* The coarse picture in rows of SIDE cells, and the veil over it. Where planes differ, two of
 * them: of what is least and of what is most in one of them. A cell's light is less the mean of the
 * picture, and times the cell's area. */
typedef struct outlook {
  int columns, rows;
  double cell_arcmin, share;
  double mean[2];
  float light[2][CELLS], unrest[CELLS]; /* unrest: mean distance of samples from the mean */
  float least[CELLS], most[CELLS];      /* of what the spread may bring there */
  float excess[2][CELLS], doubt[CELLS]; /* of the veil over an even one; give or take */
} outlook;

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }

/* At most so far are samples from least to most from the picture's mean, on the average, whose own
 * mean is `light`: where all of them are at one of the ends. */
static double unrest(double light, double least, double most, double mean) {
  double high = most > least ? (light - least) / (most - least) : 0;
  high = smaller(larger(high, 0), 1);
  return high * fabs(most - mean) + (1 - high) * fabs(mean - least);
}

/* Of a cell in all planes: the least (0) or most (1) of their light. */
static double light_of(const placido_facts *facts, int cell, int most) {
  double found = (double)facts->light[0][cell];
  for (int plane = 1; plane < facts->planes; plane++) {
    double light = (double)facts->light[plane][cell];
    found = most ? larger(found, light) : smaller(found, light);
  }
  return found;
}

static void take_light(outlook *o, const placido_question *question) {
  const placido_facts *facts = question->facts;
  double area[CELLS], whole = 0;
  for (int i = 0; i < o->rows * o->columns; i++) {
    area[i] = placido_coarse_area(facts, question->scene, i % o->columns, i / o->columns);
    whole += area[i];
    o->mean[0] += area[i] * light_of(facts, i, 0);
    o->mean[1] += area[i] * light_of(facts, i, 1);
  }
  o->mean[0] /= whole;
  o->mean[1] /= whole;
  for (int i = 0; i < o->rows * o->columns; i++) {
    int at = i / o->columns * SIDE + i % o->columns;
    double least = (double)facts->least[i], most = (double)facts->most[i], worst = 0;
    for (int k = 0; k < 2; k++) {
      double light = light_of(facts, i, k);
      o->light[k][at] = (float)(area[i] * (light - o->mean[k]));
      worst = larger(worst, larger(unrest(light, least, most, o->mean[0]),
                               unrest(light, least, most, o->mean[1])));
    }
    o->unrest[at] = (float)(area[i] * worst);
  }
}

/* How many cells away light may come from that is not scattered: what rays, colours and distances
 * out of focus do. */
static int reach(const placido_question *question) {
  const double colours_D = 1.5;
  const placido_sketch_rays *rays = question->rays;
  double depth_D = question->facts->nearest_D - question->facts->farthest_D;
  double farthest = 0;
  for (int i = 0; i < rays->count; i++) {
    farthest = larger(farthest, larger(fabs((double)rays->angle_x[i]),
                                       fabs((double)rays->angle_y[i])));
  }
  double arcmin = farthest + question->eye->pupil_mm / 2 * 1e-3 *
                                       (colours_D + fabs(depth_D)) / PLACIDO_ARCMIN_RAD;
  return (int)smaller(ceil(arcmin / question->facts->cell_arcmin), SIDE);
}

/* Extremes along `count` cells `step` apart: of each and those up to `near` cells from it. */
static void widen(float *least, float *most, int count, int step, int near) {
  float low[SIDE], high[SIDE];
  for (int i = 0; i < count; i++) {
    low[i] = least[i * step];
    high[i] = most[i * step];
  }
  for (int i = 0; i < count; i++) {
    for (int k = i > near ? i - near : 0; k < count && k <= i + near; k++) {
      least[i * step] = low[k] < least[i * step] ? low[k] : least[i * step];
      most[i * step] = high[k] > most[i * step] ? high[k] : most[i * step];
    }
  }
}

static void take_extremes(outlook *o, const placido_question *question) {
  const placido_facts *facts = question->facts;
  const int near = reach(question);
  for (int row = 0; row < o->rows; row++) {
    const size_t bytes = (size_t)o->columns * sizeof(float);
    memcpy(&o->least[row * SIDE], &facts->least[row * o->columns], bytes);
    memcpy(&o->most[row * SIDE], &facts->most[row * o->columns], bytes);
    widen(&o->least[row * SIDE], &o->most[row * SIDE], o->columns, 1, near);
  }
  for (int column = 0; column < o->columns; column++) {
    widen(&o->least[column], &o->most[column], o->rows, SIDE, near);
  }
}

/* Glare between cells `down` rows and up to SIDE columns apart, left and right: its mean and half
 * of its range. */
static void fill_glare(float *middle, float *half, const outlook *o, const placido_glare *glare,
                       int down) {
  const double side = o->cell_arcmin * PLACIDO_ARCMIN_RAD;
  const double slack = sqrt(2) * (o->cell_arcmin + 2 * PLACIDO_VEIL_CELL_ARCMIN);
  for (int k = 0; k < o->columns; k++) {
    double apart = hypot(k, down) * o->cell_arcmin;
    double near = placido_glare_veil(glare, larger(apart - slack, 0) / 60);
    double far = placido_glare_veil(glare, (apart + slack) / 60);
    middle[SIDE - 1 + k] = middle[SIDE - 1 - k] = (float)(side * side * (near + far) / 2);
    half[SIDE - 1 + k] = half[SIDE - 1 - k] = (float)(side * side * (near - far) / 2);
  }
}

/* From the rows `down` above and below a row of cells to it. */
PLACIDO_WIDE static void spread_row(outlook *o, const float *middle, const float *half, int to,
                                    int down) {
  const bool over = to - down >= 0, under = down > 0 && to + down < o->rows;
  float least[SIDE], most[SIDE], doubt[SIDE];
  memcpy(least, &o->excess[0][to * SIDE], sizeof least);
  memcpy(most, &o->excess[1][to * SIDE], sizeof most);
  memcpy(doubt, &o->doubt[to * SIDE], sizeof doubt);
  for (int k = 0; k < o->columns; k++) {
    const int a = (over ? to - down : 0) * SIDE + k, b = (under ? to + down : 0) * SIDE + k;
    const float low = (over ? o->light[0][a] : 0) + (under ? o->light[0][b] : 0);
    const float high = (over ? o->light[1][a] : 0) + (under ? o->light[1][b] : 0);
    const float restless = (over ? o->unrest[a] : 0) + (under ? o->unrest[b] : 0);
    const float *near = &middle[SIDE - 1 - k], *range = &half[SIDE - 1 - k];
#pragma omp simd
    for (int i = 0; i < SIDE; i++) {
      least[i] += low * near[i];
      most[i] += high * near[i];
      doubt[i] += restless * range[i];
    }
  }
  memcpy(&o->excess[0][to * SIDE], least, sizeof least);
  memcpy(&o->excess[1][to * SIDE], most, sizeof most);
  memcpy(&o->doubt[to * SIDE], doubt, sizeof doubt);
}

static void look_out(outlook *o, const placido_question *question, const placido_glare *glare) {
  const placido_facts *facts = question->facts;
  *o = (outlook){.columns = facts->columns, .rows = facts->rows,
                 .cell_arcmin = facts->cell_arcmin, .share = placido_glare_veil_share(glare)};
  take_light(o, question);
  take_extremes(o, question);
  for (int down = 0; down < o->rows; down++) {
    float middle[2 * SIDE] = {0}, half[2 * SIDE] = {0};
    fill_glare(middle, half, o, glare, down);
    for (int to = 0; to < o->rows; to++) {
      spread_row(o, middle, half, to, down);
    }
  }
}

/* The largest change where what stands there is from least to most and the scattered light from
 * veil_least to veil_most: what is above white shows as white. */
static double change(double share, double least, double most, double veil_least,
                     double veil_most) {
  if (least > 1) {
    return larger(1 - (1 - share) * least - veil_least, 0);
  }
  double gain = smaller(veil_most - share * least, 1 - least);
  double loss = share * smaller(most, 1) - veil_least;
  return larger(larger(gain, loss), 0);
}

/* The largest in a plane: what is scattered of it is between its extremes, too. */
static double bound_of_plane(const outlook *o, const placido_facts *facts, int plane) {
  const double share = o->share;
  const double darkest = facts->darkest[plane], brightest = facts->brightest[plane];
  double bound = 0;
  for (int i = 0; i < o->rows * o->columns; i++) {
    int at = i / o->columns * SIDE + i % o->columns;
    double doubt = (double)o->doubt[at];
    double veil_least = share * o->mean[0] + (double)o->excess[0][at] - doubt;
    double veil_most = share * o->mean[1] + (double)o->excess[1][at] + doubt;
    double least = larger((double)o->least[at], darkest);
    double most = smaller((double)o->most[at], brightest);
    bound = larger(bound, change(share, least, most, larger(veil_least, share * darkest),
                                 smaller(veil_most, share * brightest)));
  }
  return bound;
}

/* Gathering, laying and the transforms of the cells. */
static double cost_ms(const placido_question *question) {
  const double sample_ms = 2.2e-6, cell_ms = 25e-6, kernel_ms = 60e-6, start_ms = 0.3;
  const placido_image *image = &question->scene->image;
  double area_arcmin2 = (double)image->width_px * image->height_px *
                        question->scene->arcmin_per_px * question->scene->arcmin_per_px;
  double cells = area_arcmin2 / (PLACIDO_VEIL_CELL_ARCMIN * PLACIDO_VEIL_CELL_ARCMIN);
  double samples = area_arcmin2 / (question->bucket_arcmin * question->bucket_arcmin);
  return start_ms + cells * kernel_ms +
         question->facts->planes * (samples * sample_ms + cells * cell_ms);
}

static void tell(placido_answer *answer, double share, double age_years, double brightest) {
  const char *what = answer->bound < 0.005 ? "no bright light beside dark: it changes"
                     : brightest > 2       ? "bright lights veil the dark beside them: it changes"
                                           : "it veils what is dark and dims what is light:";
  snprintf(answer->reason, sizeof answer->reason,
           "%.0f %% of the light is scattered at %.0f years; %s at most %.2g of white",
           100 * share, age_years, what, answer->bound);
}

static void ask(const placido_question *question, placido_answer *answer) {
  const placido_facts *facts = question->facts;
  const placido_glare glare = placido_glare_of(question->eye);
  outlook o;
  double brightest = 0;
  look_out(&o, question, &glare);
  for (int plane = 0; plane < facts->planes; plane++) {
    answer->bound = larger(answer->bound, bound_of_plane(&o, facts, plane));
    answer->applies = answer->applies || facts->brightest[plane] > facts->darkest[plane];
    brightest = larger(brightest, facts->brightest[plane]);
  }
  answer->cost_ms = cost_ms(question);
  if (answer->applies) {
    tell(answer, o.share, glare.age_years, brightest);
  } else {
    snprintf(answer->reason, sizeof answer->reason,
             "the picture is even: as much light is scattered into each place as out of it");
  }
}

/* The part of the canvas around the scene's own picture, its bleed included, which only continues
 * it: around the scene there is its mean light, however far light is spread. */
static int margin_of(const placido_view *view) {
  const placido_scene *scene = view->scene;
  double own = scene->bleed_px * scene->arcmin_per_px / view->settings->bucket_arcmin;
  int margin_px = view->bleed_px - (int)lround(own);
  return margin_px > 0 ? margin_px : 0;
}

/* The canvas is the scene unspread, whatever its layers. Alpha only counts where it spreads. */
static int prepare(void **state, placido_view *view, placido_error *err) {
  const placido_glare glare = placido_glare_of(&view->eye);
  placido_image light = view->canvas;
  light.planes = light.planes == 4 && !view->holes ? 3 : light.planes;
  placido_veil *veil = placido_memory_new(1, sizeof *veil, err);
  *state = veil;
  if (veil == NULL) {
    return PLACIDO_MEMORY;
  }
  return placido_veil_new(veil, &light, margin_of(view), view->settings->bucket_arcmin,
                          &glare, view->threads, err);
}

static int apply(void *state, placido_view *view, placido_error *err) {
  (void)err;
  placido_veil_lay(&view->seen, state, view->threads);
  return PLACIDO_OK;
}

static void release(void *state) {
  if (state != NULL) {
    placido_veil_free(state);
    placido_memory_free(state);
  }
}

const placido_effect placido_effect_straylight = {
  .name = "straylight",
  .summary = "light scattered in the eye veils the picture",
  .stage = PLACIDO_STAGE_IMAGE,
  .ask = ask,
  .prepare = prepare,
  .apply = apply,
  .release = release,
};
