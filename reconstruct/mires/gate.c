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
#define FAINT 0.2         /* of the usual height: a lash's shadow, not a mire */
#define SAMPLED 2         /* meridians of a block at which its medians look */
#define BLOCK_FEW 8       /* fewer members of an edge say nothing */
#define COMPANY_EDGES 2   /* how far the nearest other edge may be */
/* With fewer edges there is nothing to compare with: a lid's border stands alone. */
#define BLOCK_EDGES_FEW 3

/* What is usual around a block, as shares of what is usual along the edge, and how far from it is
 * still ordinary. */
typedef struct usual {
  double height, width;
  double height_tolerance, width_tolerance;
} usual;

/* What is usual along one edge: the inner mires are brighter than the outer ones. */
typedef struct ring {
  double height, width_px;
} ring;

/* The crossing of an edge on a meridian, as an index into the list plus one; 0: none. */
typedef struct table {
  int edges, meridians, step; /* meridians of a block */
  size_t *at;
  ring *rings;              /* one an edge */
  double *heights, *widths; /* to find medians in */
  unsigned char *marks;     /* one a meridian */
  placido_crossing *list;
} table;

#define NOBODY 2 /* the mark where there is no crossing */

static size_t *cell(const table *t, int edge, int meridian) {
  int m = (meridian % t->meridians + t->meridians) % t->meridians;
  return &t->at[(size_t)edge * (size_t)t->meridians + (size_t)m];
}

/* The measured crossing of an edge on a meridian; NULL where there is none. */
static const placido_crossing *measured_at(const table *t, int edge, int meridian) {
  size_t at = edge >= 0 && edge < t->edges ? *cell(t, edge, meridian) : 0;
  return at && t->list[at - 1].sigma_px > 0 ? &t->list[at - 1] : NULL;
}

static void find_rings(const table *t) {
  for (int k = 0; k < t->edges; k++) {
    size_t count = 0;
    for (int m = 0; m < t->meridians; m++) {
      const placido_crossing *c = measured_at(t, k, m);
      if (c) {
        t->heights[count] = c->height;
        t->widths[count++] = c->width_px;
      }
    }
    t->rings[k] = (ring){placido_quantile(t->heights, count, 0.5),
                         placido_quantile(t->widths, count, 0.5)};
  }
}

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

/* Median over the block of (edges, meridians) that begins at (edge, meridian) and the blocks that
 * touch it. */
static usual usual_around(const table *t, int edge, int meridian) {
  size_t count = 0;
  int edges = 0, stride = t->step / SAMPLED > 1 ? t->step / SAMPLED : 1;
  for (int k = edge - BLOCK_EDGES; k < edge + 2 * BLOCK_EDGES; k++) {
    size_t before = count;
    for (int m = meridian - t->step; m < meridian + 2 * t->step; m += stride) {
      const placido_crossing *c = measured_at(t, k, m);
      if (c) {
        t->heights[count] = c->height / t->rings[k].height;
        t->widths[count++] = c->width_px / t->rings[k].width_px;
      }
    }
    edges += (count - before) * (size_t)stride >= BLOCK_FEW;
  }
  usual u = {NAN, NAN, 0, 0};
  if (edges >= BLOCK_EDGES_FEW) {
    u.height = centre_of(t->heights, count, HEIGHT_TOLERANCE, &u.height_tolerance);
    u.width = centre_of(t->widths, count, WIDTH_TOLERANCE, &u.width_tolerance);
  }
  return u;
}

/* Marks the members of a block that differ from what is usual; too faint ones lose their number. */
static void judge_block(const table *t, int edge, int meridian, usual u) {
  for (int k = edge; k < edge + BLOCK_EDGES && k < t->edges; k++) {
    for (int m = meridian; m < meridian + t->step && m < t->meridians; m++) {
      size_t at = *cell(t, k, m);
      if (!at) {
        continue;
      }
      placido_crossing *c = &t->list[at - 1];
      double height = c->height / (t->rings[k].height * u.height);
      double width = c->width_px / (t->rings[k].width_px * u.width);
      c->doubtful = !(c->sigma_px > 0) || !(fabs(height - 1) < u.height_tolerance) ||
                    !(fabs(width - 1) < u.width_tolerance);
      if (c->sigma_px > 0 && height < FAINT) {
        c->edge = -1;
      }
    }
  }
}

/* Makes the neighbours of doubtful ones doubtful, too, and those without neighbours. */
static void spread_doubt(const table *t, int edge) {
  int last = t->meridians - 1;
  for (int m = 0; m < t->meridians; m++) {
    size_t at = *cell(t, edge, m);
    t->marks[m] = at ? t->list[at - 1].doubtful : NOBODY;
  }
  for (int m = 0; m < t->meridians; m++) {
    unsigned char before = t->marks[m > 0 ? m - 1 : last], after = t->marks[m < last ? m + 1 : 0];
    if (t->marks[m] != NOBODY &&
        (before == 1 || after == 1 || (before == NOBODY && after == NOBODY))) {
      t->list[*cell(t, edge, m) - 1].doubtful = true;
    }
  }
}

/* Whether another edge of the same mire or its neighbours is seen beside a crossing. */
static bool has_company(const table *t, int edge, int meridian) {
  for (int k = edge - COMPANY_EDGES; k <= edge + COMPANY_EDGES; k++) {
    for (int m = meridian - 1; m <= meridian + 1; m++) {
      size_t at = k >= 0 && k < t->edges && k != edge ? *cell(t, k, m) : 0;
      if (at && t->list[at - 1].edge == k) {
        return true;
      }
    }
  }
  return false;
}

/* Drops what stands alone: the reflection of a wet lid is an edge too, but none runs beside it. */
static void drop_lonely(const table *t) {
  for (int k = 0; k < t->edges; k++) {
    for (int m = 0; m < t->meridians; m++) {
      size_t *at = cell(t, k, m);
      if (*at && !has_company(t, k, m)) {
        t->list[*at - 1].edge = -1;
      }
    }
  }
}

int placido_crossings_gate(placido_crossings *crossings, int edge_count, placido_error *err) {
  table t = {.edges = edge_count, .meridians = crossings->meridians, .list = crossings->list};
  t.step = (int)fmax(1, round(BLOCK_DEG * crossings->meridians / 360.0));
  size_t room = (size_t)(3 * BLOCK_EDGES) * (size_t)(3 * t.step);
  room = room > (size_t)t.meridians ? room : (size_t)t.meridians;
  t.at = placido_memory_new((size_t)edge_count * (size_t)t.meridians, sizeof *t.at, err);
  t.rings = placido_memory_new((size_t)edge_count, sizeof *t.rings, err);
  t.heights = placido_memory_new(room, sizeof *t.heights, err);
  t.widths = placido_memory_new(room, sizeof *t.widths, err);
  t.marks = placido_memory_new((size_t)t.meridians, 1, err);
  int status = t.at && t.rings && t.heights && t.widths && t.marks ? PLACIDO_OK
                                                                         : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < crossings->count; i++) {
      const placido_crossing *c = &crossings->list[i];
      if (c->edge >= 0) {
        *cell(&t, c->edge, c->meridian) = i + 1;
      }
    }
    find_rings(&t);
    for (int k = 0; k < edge_count; k += BLOCK_EDGES) {
      for (int m = 0; m < t.meridians; m += t.step) {
        judge_block(&t, k, m, usual_around(&t, k, m));
      }
    }
    for (int k = 0; k < edge_count; k++) {
      spread_doubt(&t, k);
    }
    drop_lonely(&t);
  }
  placido_memory_free(t.at);
  placido_memory_free(t.rings);
  placido_memory_free(t.heights);
  placido_memory_free(t.widths);
  placido_memory_free(t.marks);
  return status;
}
