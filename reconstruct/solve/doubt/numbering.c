/* Neighbouring points of an edge hang together, and so do neighbouring edges of a meridian: groups
 * that hang together share their mistakes, and where two groups touch one of them shows (union and
 * find, Tarjan 1975). */
#include "reconstruct/solve/doubt/numbering.h"

#include "base/memory.h"
#include "reconstruct/median.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define JUMP 0.5   /* of the distance of edges of one polarity: edges run on */
#define PARTED 1.8 /* of the usual distance of two edges: one between them was numbered wrongly */
#define PARTS_MOST 0.1 /* of the points: more groups than that hang together by their meridians */
#define CONTACTS 3     /* jumps at a group's border that make it doubtful */
#define SHIFT_MOST 4   /* edges by which a number may be wrong */
#define MOVED_MIN 10   /* fewer points than these are strays */

/* Which sample lies where: its index and 1, or 0. */
typedef struct table {
  int edges, meridians;
  const placido_sample *samples;
  const placido_mires *mires;
  size_t *at;
  double *usual_px; /* distance of each edge and the next, the median of all meridians; NaN */
} table;

static int meridian_of(const table *t, size_t sample) {
  double turn = t->mires->points[t->samples[sample].point].meridian_deg / 360;
  return (int)(lrint(turn * t->meridians) % t->meridians);
}

static int edge_of(const table *t, size_t sample) {
  return t->mires->points[t->samples[sample].point].edge;
}

/* The sample there, or -1. */
static long sample_at(const table *t, int edge, int meridian) {
  if (edge < 0 || edge >= t->edges) {
    return -1;
  }
  return (long)t->at[edge * t->meridians + (meridian + t->meridians) % t->meridians] - 1;
}

static double radius_px(const table *t, long sample) {
  const placido_mire_point *p = &t->mires->points[t->samples[sample].point];
  return hypot(p->u_px - t->mires->centre_u_px, p->v_px - t->mires->centre_v_px);
}

/* `gaps` has room for all meridians. */
static void find_usual(table *t, double *gaps) {
  for (int edge = 0; edge < t->edges; edge++) {
    size_t n = 0;
    for (int m = 0; m < t->meridians; m++) {
      long inner = sample_at(t, edge, m), outer = sample_at(t, edge + 1, m);
      if (inner >= 0 && outer >= 0) {
        gaps[n++] = radius_px(t, outer) - radius_px(t, inner);
      }
    }
    t->usual_px[edge] = placido_quantile(gaps, n, 0.5);
  }
}

static int table_new(table *t, const placido_sample *samples, size_t count,
                     const placido_mires *mires, placido_error *err) {
  *t = (table){.edges = mires->edge_count,
               .meridians = mires->meridian_count,
               .samples = samples,
               .mires = mires};
  size_t meridians = (size_t)t->meridians;
  t->at = placido_memory_new((size_t)t->edges * meridians, sizeof *t->at, err);
  t->usual_px = placido_memory_new((size_t)t->edges, sizeof *t->usual_px, err);
  double *gaps = placido_memory_new(meridians, sizeof *gaps, err);
  int status = t->at && t->usual_px && gaps ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < count; i++) {
      t->at[edge_of(t, i) * t->meridians + meridian_of(t, i)] = i + 1;
    }
    find_usual(t, gaps);
  }
  placido_memory_free(gaps);
  return status;
}

/* Whether the next edge outwards, on the same meridian, is not where the next one is elsewhere. */
static bool are_parted(const table *t, long inner, long outer) {
  double gap = radius_px(t, outer) - radius_px(t, inner);
  return !(gap > 0 && gap < PARTED * t->usual_px[edge_of(t, (size_t)inner)]);
}

/* Whether an edge jumps from sample a to sample b on the next meridian. */
static bool jumps(const table *t, long a, long b) {
  int edge = edge_of(t, (size_t)a), meridian = meridian_of(t, (size_t)a);
  long outer = sample_at(t, edge + 2, meridian), inner = sample_at(t, edge - 2, meridian);
  long other = outer >= 0 ? outer : inner;
  double step = fabs(radius_px(t, b) - radius_px(t, a));
  return other >= 0 && step > JUMP * fabs(radius_px(t, other) - radius_px(t, a));
}

static size_t root_of(size_t *parents, size_t i) {
  while (parents[i] != i) {
    parents[i] = parents[parents[i]];
    i = parents[i];
  }
  return i;
}

static void join(size_t *parents, size_t a, size_t b) {
  size_t ra = root_of(parents, a), rb = root_of(parents, b);
  parents[ra > rb ? ra : rb] = ra < rb ? ra : rb;
}

/* The sample on the next meridian of the same edge, or -1. */
static long beside(const table *t, size_t i) {
  return sample_at(t, edge_of(t, i), meridian_of(t, i) + 1);
}

/* Joins what hangs together, edges of a meridian only where they are not parted if `parts`; returns
 * the number of jumps. */
static size_t join_all(const table *t, size_t count, size_t *parents, bool parts) {
  size_t jumped = 0;
  for (size_t i = 0; i < count; i++) {
    parents[i] = i;
  }
  for (size_t i = 0; i < count; i++) {
    long next = beside(t, i);
    long outer = sample_at(t, edge_of(t, i) + 1, meridian_of(t, i));
    bool jump = next >= 0 && jumps(t, (long)i, next);
    jumped += jump;
    if (next >= 0 && !jump) {
      join(parents, i, (size_t)next);
    }
    if (outer >= 0 && !(parts && are_parted(t, (long)i, outer))) {
      join(parents, i, (size_t)outer);
    }
  }
  return jumped;
}

/* Sizes of the groups and jumps at their borders, by root. */
static size_t measure_groups(const table *t, size_t count, size_t *parents, size_t *sizes,
                             size_t *contacts) {
  size_t largest = 0;
  for (size_t i = 0; i < count; i++) {
    size_t root = root_of(parents, i);
    long next = beside(t, i);
    sizes[root]++;
    if (next >= 0 && root_of(parents, (size_t)next) != root) {
      contacts[root]++;
      contacts[root_of(parents, (size_t)next)]++;
    }
  }
  for (size_t i = 1; i < count; i++) {
    largest = sizes[i] > sizes[largest] ? i : largest;
  }
  return largest;
}

/* Whether a sample belongs to a doubtful group. */
static bool is_doubtful(size_t *parents, const size_t *contacts, size_t largest, size_t i) {
  size_t root = root_of(parents, i);
  return root != largest && contacts[root] >= CONTACTS;
}

/* Takes the doubtful groups out of use, unless they are more than `most`. Returns how many points
 * they have. `parents` has room for three lists. */
static size_t doubt(placido_sample *samples, const table *t, size_t count, size_t *parents,
                    bool parts, size_t most) {
  size_t *sizes = parents + count, *contacts = parents + 2 * count, doubtful = 0;
  memset(sizes, 0, 2 * count * sizeof *sizes);
  if (join_all(t, count, parents, parts) == 0) {
    return 0;
  }
  size_t largest = measure_groups(t, count, parents, sizes, contacts);
  for (size_t i = 0; i < count; i++) {
    doubtful += is_doubtful(parents, contacts, largest, i);
  }
  for (size_t i = 0; i < count && doubtful <= most; i++) {
    if (is_doubtful(parents, contacts, largest, i)) {
      samples[i].used = false;
    }
  }
  return doubtful;
}

int placido_numbering_doubt(placido_sample *samples, size_t count, const placido_mires *mires,
                            size_t *doubtful, placido_error *err) {
  table t;
  *doubtful = 0;
  int status = table_new(&t, samples, count, mires, err);
  size_t *parents = placido_memory_new(count, 3 * sizeof *parents, err);
  if (!status && !parents) {
    status = PLACIDO_MEMORY;
  }
  if (!status) {
    size_t most = (size_t)(PARTS_MOST * (double)count);
    *doubtful = doubt(samples, &t, count, parents, true, most);
    if (*doubtful > most) {
      *doubtful = doubt(samples, &t, count, parents, false, count);
    }
  }
  placido_memory_free(t.at);
  placido_memory_free(t.usual_px);
  placido_memory_free(parents);
  return status;
}

/* How far a sample lies from another edge, px, first order. */
static double residual_under(const placido_sample *s, const placido_edge *edge) {
  placido_miss miss = placido_mirror_miss(&s->ray, &s->hit, edge);
  return fabs(miss.f) / sqrt(miss.by_u * miss.by_u + miss.by_v * miss.by_v);
}

/* The number under which the surface takes a point; its own where none does. */
static int number_for(const placido_sample *s, int edge, const placido_instrument *instrument,
                      double limit_px) {
  for (int shift = -SHIFT_MOST; shift <= SHIFT_MOST; shift += 2) {
    int other = edge + shift;
    if (shift && other >= 0 && other < instrument->edge_count &&
        residual_under(s, &instrument->edges[other]) < limit_px) {
      return other;
    }
  }
  return edge;
}

static int by_place(const void *a, const void *b) {
  const placido_mire_point *p = a, *q = b;
  if (p->edge != q->edge) {
    return p->edge < q->edge ? -1 : 1;
  }
  if (p->meridian_deg != q->meridian_deg) {
    return p->meridian_deg < q->meridian_deg ? -1 : 1;
  }
  return (int)q->used - (int)p->used; /* what the surface took stands first */
}

/* Puts the points in order again; of two in one place the first stays. */
static void put_in_order(placido_mires *mires) {
  size_t kept = 0;
  qsort(mires->points, mires->count, sizeof *mires->points, by_place);
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *p = &mires->points[i];
    const placido_mire_point *last = kept ? &mires->points[kept - 1] : NULL;
    if (!last || last->edge != p->edge || last->meridian_deg != p->meridian_deg) {
      mires->points[kept++] = *p;
    }
  }
  mires->count = kept;
}

int placido_numbering_settle(placido_mires *mires, const placido_sample *samples, size_t count,
                             const placido_instrument *instrument, double limit_px, size_t *changed,
                             placido_error *err) {
  *changed = 0;
  int *numbers = placido_memory_new(count, sizeof *numbers, err);
  if (!numbers) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    const placido_sample *s = &samples[i];
    int edge = mires->points[s->point].edge;
    bool refused = !s->used && fabs(s->residual_px * s->noise) > 2 * limit_px;
    numbers[i] = refused ? number_for(s, edge, instrument, limit_px) : edge;
    *changed += numbers[i] != edge;
  }
  if (*changed >= MOVED_MIN) {
    for (size_t i = 0; i < count; i++) {
      mires->points[samples[i].point].edge = numbers[i];
      mires->points[samples[i].point].used = samples[i].used;
    }
    put_in_order(mires);
  } else {
    *changed = 0;
  }
  placido_memory_free(numbers);
  return PLACIDO_OK;
}

/* Of a list; returns how many are left. */
static size_t shift_points(placido_mire_point *points, size_t count, int shift, int edge_count) {
  size_t kept = 0;
  for (size_t i = 0; i < count; i++) {
    placido_mire_point point = points[i];
    point.edge += shift;
    if (point.edge >= 0 && point.edge < edge_count) {
      points[kept++] = point;
    }
  }
  return kept;
}

void placido_numbering_shift(placido_mires *mires, int shift) {
  mires->count = shift_points(mires->points, mires->count, shift, mires->edge_count);
  mires->doubtful_count =
      shift_points(mires->doubtful, mires->doubtful_count, shift, mires->edge_count);
}

int placido_numbering_shifted(placido_mires *copy, const placido_mires *mires, int shift,
                              int stride, placido_error *err) {
  *copy = *mires;
  copy->count = copy->doubtful_count = 0;
  copy->doubtful = NULL;
  copy->points = placido_memory_new(mires->count, sizeof *copy->points, err);
  if (!copy->points) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < mires->count; i++) {
    double meridian = mires->points[i].meridian_deg * mires->meridian_count / 360;
    if (lrint(meridian) % stride == 0) {
      copy->points[copy->count++] = mires->points[i];
    }
  }
  placido_numbering_shift(copy, shift);
  return PLACIDO_OK;
}
