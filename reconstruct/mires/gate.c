/* The gate: medians of height and blur in blocks of some edges by some degrees say what is usual.
 */
#include "reconstruct/mires/gate.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>

#define BLOCK_EDGES 4
#define BLOCK_DEG 12
#define HEIGHT_TOLERANCE 0.35 /* least; noisy pictures get up to twice as much */
#define WIDTH_TOLERANCE 0.25
#define BLOCK_FEW 8       /* fewer members of an edge say nothing */
#define COMPANY_EDGES 2   /* how far the nearest other edge may be */
/* With fewer edges there is nothing to compare with: a lid's border stands alone. */
#define BLOCK_EDGES_FEW 3

/* What is usual around a block, and how far from it is still ordinary, as shares. */
typedef struct usual {
  double height, width_px;
  double height_tolerance, width_tolerance;
} usual;

/* Median, and a tolerance of three robust standard deviations, within once and twice the least. */
static double centre_of(double *values, size_t count, double least, double *tolerance) {
  double middle = placido_quantile(values, count, 0.5);
  for (size_t i = 0; i < count; i++) {
    values[i] = fabs(values[i] / middle - 1);
  }
  double spread = 3 * 1.4826 * placido_quantile(values, count, 0.5);
  *tolerance = fmax(least, fmin(2 * least, spread));
  return middle;
}

/* The crossing of an edge on a meridian, as an index into the list plus one; 0: none. */
typedef struct table {
  int edges, meridians;
  size_t *at;
} table;

static size_t *cell(const table *t, int edge, int meridian) {
  int m = (meridian % t->meridians + t->meridians) % t->meridians;
  return &t->at[(size_t)edge * (size_t)t->meridians + (size_t)m];
}

/* Median over the block of (edges, meridians) that begins at (edge, meridian) and the blocks that
 * touch it. */
static usual usual_around(const table *t, const placido_crossings *all, int edge, int meridian,
                          int step, double *heights, double *widths) {
  size_t count = 0;
  int edges = 0;
  for (int k = edge - BLOCK_EDGES; k < edge + 2 * BLOCK_EDGES; k++) {
    size_t before = count;
    for (int m = meridian - step; k >= 0 && k < t->edges && m < meridian + 2 * step; m++) {
      size_t at = *cell(t, k, m);
      if (at) {
        heights[count] = all->list[at - 1].height;
        widths[count++] = all->list[at - 1].width_px;
      }
    }
    edges += count - before >= BLOCK_FEW;
  }
  usual u = {NAN, NAN, 0, 0};
  if (edges >= BLOCK_EDGES_FEW) {
    u.height = centre_of(heights, count, HEIGHT_TOLERANCE, &u.height_tolerance);
    u.width_px = centre_of(widths, count, WIDTH_TOLERANCE, &u.width_tolerance);
  }
  return u;
}

/* Marks (negative sigma) the members of a block that differ from what is usual. */
static void judge_block(const table *t, placido_crossings *all, int edge, int meridian, int step,
                        usual u) {
  for (int k = edge; k < edge + BLOCK_EDGES && k < t->edges; k++) {
    for (int m = meridian; m < meridian + step && m < t->meridians; m++) {
      size_t at = *cell(t, k, m);
      if (!at) {
        continue;
      }
      placido_crossing *c = &all->list[at - 1];
      if (!(fabs(c->height / u.height - 1) < u.height_tolerance) ||
          !(fabs(c->width_px / u.width_px - 1) < u.width_tolerance)) {
        c->sigma_px = -fabs(c->sigma_px);
      }
    }
  }
}

/* Drops the marked, those beside them, and runs shorter than three. */
static void drop_marked(const table *t, placido_crossings *all) {
  for (int k = 0; k < t->edges; k++) {
    for (int m = 0; m < t->meridians; m++) {
      size_t at = *cell(t, k, m);
      if (!at) {
        continue;
      }
      int alone = 0;
      for (int side = -1; side <= 1; side++) {
        size_t beside = *cell(t, k, m + side);
        alone += beside == 0;
        if (beside && all->list[beside - 1].sigma_px < 0) {
          all->list[at - 1].edge = -1;
        }
      }
      if (alone == 2) {
        all->list[at - 1].edge = -1;
      }
    }
  }
}

/* Whether another edge of the same mire or its neighbours is seen beside a crossing. */
static bool has_company(const table *t, const placido_crossings *all, int edge, int meridian) {
  for (int k = edge - COMPANY_EDGES; k <= edge + COMPANY_EDGES; k++) {
    for (int m = meridian - 1; m <= meridian + 1; m++) {
      size_t at = k >= 0 && k < t->edges && k != edge ? *cell(t, k, m) : 0;
      if (at && all->list[at - 1].edge == k) {
        return true;
      }
    }
  }
  return false;
}

/* Drops what stands alone: the reflection of a wet lid is an edge too, but none runs beside it. */
static void drop_lonely(const table *t, placido_crossings *all) {
  for (int k = 0; k < t->edges; k++) {
    for (int m = 0; m < t->meridians; m++) {
      size_t at = *cell(t, k, m);
      if (at && all->list[at - 1].edge == k && !has_company(t, all, k, m)) {
        all->list[at - 1].sigma_px = -fabs(all->list[at - 1].sigma_px);
      }
    }
  }
  for (size_t i = 0; i < all->count; i++) {
    if (all->list[i].sigma_px < 0) {
      all->list[i].edge = -1;
    }
  }
}

int placido_crossings_gate(placido_crossings *crossings, int edge_count, placido_error *err) {
  table t = {.edges = edge_count, .meridians = crossings->meridians};
  int step = (int)fmax(1, round(BLOCK_DEG * crossings->meridians / 360.0));
  size_t room = (size_t)(3 * BLOCK_EDGES) * (size_t)(3 * step);
  t.at = placido_memory_new((size_t)edge_count * (size_t)t.meridians, sizeof *t.at, err);
  double *heights = placido_memory_new(room, sizeof *heights, err);
  double *widths = placido_memory_new(room, sizeof *widths, err);
  int status = t.at && heights && widths ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < crossings->count; i++) {
      const placido_crossing *c = &crossings->list[i];
      if (c->edge >= 0) {
        *cell(&t, c->edge, c->meridian) = i + 1;
      }
    }
    for (int k = 0; k < edge_count; k += BLOCK_EDGES) {
      for (int m = 0; m < t.meridians; m += step) {
        usual u = usual_around(&t, crossings, k, m, step, heights, widths);
        judge_block(&t, crossings, k, m, step, u);
      }
    }
    drop_marked(&t, crossings);
    drop_lonely(&t, crossings);
  }
  placido_memory_free(t.at);
  placido_memory_free(heights);
  placido_memory_free(widths);
  return status;
}
