/* Settling the numbers: trust spreads from the innermost mires through neighbouring cells that
 * agree; then prediction and assignment by turns, which is iterated conditional modes (Besag, J. R.
 * Stat. Soc. B 48:259, 1986) on the field of edges × sectors. */
#include "reconstruct/mires/settle.h"

#include "base/memory.h"
#include "reconstruct/mires/field.h"

#include <math.h>

#define SEED_EDGES 4   /* the innermost, which the numbering is sure of */
#define STEP_MOST 0.5  /* periods from cell to cell; a wrong mire is 1 */
#define SKIPPED 2      /* cells over which trust reaches */
#define NEAR 0.25      /* periods from where an edge is expected */
#define FAR 0.6        /* periods at which a chain's own number is given up */
#define PASSES 12
#define LONG 12        /* a chain over one part in so many of the circle keeps its number */
#define RUN_DEG 3      /* an edge that is seen over less is taken for noise */
#define RUN_STEP 0.12  /* periods from meridian to meridian within a run */
#define COMPANY 0.5    /* share of a run beside which the band's other edge is seen */
#define DRIFT 0.3      /* periods by which a run may drift from where it is expected */

typedef struct settling {
  placido_crossings *all;
  placido_field field;
  bool first_rises;
  unsigned char *trusted; /* edges × sectors */
  int *queue;
  int *own;               /* by crossing: the number from its chain, -1: none that is trusted */
  size_t *chosen;         /* edges × meridians: the crossing plus one; 0: none */
} settling;

/* The ordinary distance between edges of one polarity around `edge`, as a share of the radius. */
static double ordinary_period(const placido_field *field, int edge) {
  const double *o = field->ordinary_px;
  int inner = edge > 0 ? edge - 1 : 0, outer = edge + 1 < field->edges ? edge + 1 : edge;
  return 2 * (o[outer] - o[inner]) / (outer - inner) / o[edge];
}

static bool agree(const placido_field *field, int edge, const placido_cell *a,
                  const placido_cell *b) {
  double step = fabs(a->ratio / a->count - b->ratio / b->count);
  return step < STEP_MOST * ordinary_period(field, edge);
}

/* Spreads trust from the innermost edges' cells. */
static void spread_trust(settling *n) {
  const placido_field *f = &n->field;
  int head = 0, tail = 0;
  for (int i = 0; i < f->edges * f->sectors; i++) {
    n->trusted[i] = i < SEED_EDGES * f->sectors && f->cells[i].count > 0;
    if (n->trusted[i]) {
      n->queue[tail++] = i;
    }
  }
  while (head < tail) {
    int here = n->queue[head++], edge = here / f->sectors, sector = here % f->sectors;
    for (int i = -SKIPPED; i <= SKIPPED; i++) {
      for (int j = -SKIPPED; j <= SKIPPED; j++) {
        if (edge + i < 0 || edge + i >= f->edges || (i && j)) {
          continue;
        }
        const placido_cell *cell = placido_field_cell(f, edge + i, sector + j);
        int there = (int)(cell - f->cells);
        if (cell->count && !n->trusted[there] && agree(f, edge, &f->cells[here], cell)) {
          n->trusted[there] = 1;
          n->queue[tail++] = there;
        }
      }
    }
  }
}

/* Fills the field from what is numbered; returns how much that is. */
static size_t fill(settling *n) {
  size_t count = 0;
  placido_field_clear(&n->field);
  for (size_t i = 0; i < n->all->count; i++) {
    const placido_crossing *c = &n->all->list[i];
    if (c->edge >= 0) {
      placido_field_add(&n->field, c->edge, c->meridian, c->radius_px);
      count++;
    }
  }
  return count;
}

static void drop_distrusted(settling *n) {
  const placido_field *f = &n->field;
  for (size_t i = 0; i < n->all->count; i++) {
    placido_crossing *c = &n->all->list[i];
    if (c->edge >= 0 &&
        !n->trusted[c->edge * f->sectors + placido_field_sector(f, c->meridian)]) {
      c->edge = -1;
    }
  }
}

/* How far from where edge `edge` is expected a crossing lies. */
static double distance_from(const placido_field *f, const placido_crossing *c, int edge) {
  return fabs(c->radius_px -
              f->expected_px[(size_t)edge * (size_t)f->meridians + (size_t)c->meridian]);
}

/* The edge of the crossing's polarity that is expected nearest to it; -1 where none is near. */
static int nearest_edge(const settling *n, const placido_crossing *c) {
  const placido_field *f = &n->field;
  int best = -1;
  double least = INFINITY;
  for (int k = ((c->slope > 0) == n->first_rises) ? 0 : 1; k < f->edges; k += 2) {
    double d = distance_from(f, c, k);
    if (d < least) {
      least = d;
      best = k;
    }
  }
  return best >= 0 && least < NEAR * placido_field_period(f, best, c->meridian) ? best : -1;
}

/* Whether a crossing's own number stands. */
static bool stands(const settling *n, size_t i) {
  const placido_crossing *c = &n->all->list[i];
  int own = n->own[i];
  return own >= 0 && !(distance_from(&n->field, c, own) >
                       FAR * placido_field_period(&n->field, own, c->meridian));
}

static size_t *chosen(const settling *n, int edge, int meridian) {
  int m = (meridian + n->all->meridians) % n->all->meridians;
  return &n->chosen[(size_t)edge * (size_t)n->all->meridians + (size_t)m];
}

/* Numbers the crossings of a meridian by where the edges are expected. */
static void assign(settling *n, int meridian) {
  for (int k = 0; k < n->field.edges; k++) {
    *chosen(n, k, meridian) = 0;
  }
  for (size_t i = n->all->first[meridian]; i < n->all->first[meridian + 1]; i++) {
    placido_crossing *c = &n->all->list[i];
    bool own = stands(n, i);
    int edge = own ? n->own[i] : nearest_edge(n, c);
    c->edge = -1;
    if (edge < 0) {
      continue;
    }
    size_t *place = chosen(n, edge, meridian);
    placido_crossing *rival = *place ? &n->all->list[*place - 1] : NULL;
    bool rival_own = rival && n->own[*place - 1] == edge;
    if (!rival || own > rival_own ||
        (own == rival_own &&
         distance_from(&n->field, c, edge) < distance_from(&n->field, rival, edge))) {
      c->edge = edge;
      *place = i + 1;
      if (rival) {
        rival->edge = -1;
      }
    }
  }
}

/* How far a chosen crossing lies outwards of where its edge is expected; NaN where none is. */
static double deviation(const settling *n, int edge, int meridian) {
  size_t at = *chosen(n, edge, meridian);
  const placido_field *f = &n->field;
  int m = (meridian + f->meridians) % f->meridians;
  return at ? n->all->list[at - 1].radius_px -
                  f->expected_px[(size_t)edge * (size_t)f->meridians + (size_t)m]
            : NAN;
}

/* Whether the other edge of the bright band is seen, too. */
static bool has_partner(const settling *n, int edge, int meridian) {
  bool rises = (edge % 2 == 0) == n->first_rises;
  int partner = rises ? edge + 1 : edge - 1;
  return partner < 0 || partner >= n->field.edges || *chosen(n, partner, meridian);
}

/* Takes the numbers from a run along an edge, [first, last), that cannot be a mire: it is short, or
 * alone, or runs across the mires. Chains that keep their numbers are left. */
static void judge_run(settling *n, int edge, int first, int last) {
  int meridians = n->all->meridians, partners = 0;
  for (int m = first; m < last; m++) {
    partners += has_partner(n, edge, m);
  }
  double drift = fabs(deviation(n, edge, last - 1) - deviation(n, edge, first));
  if ((last - first) * 360 >= RUN_DEG * meridians && partners >= COMPANY * (last - first) &&
      drift <= DRIFT * placido_field_period(&n->field, edge, first % meridians)) {
    return;
  }
  for (int m = first; m < last; m++) {
    size_t at = *chosen(n, edge, m);
    if (n->own[at - 1] != edge) {
      n->all->list[at - 1].edge = -1;
    }
  }
}

/* Cuts an edge into runs without jumps and judges each. */
static void drop_noise(settling *n, int edge) {
  int meridians = n->all->meridians, start = 0;
  while (start < meridians && *chosen(n, edge, start)) {
    start++; /* a run does not begin in the middle of one */
  }
  for (int m = start; m < start + meridians; m++) {
    double here = deviation(n, edge, m);
    if (isnan(here)) {
      continue;
    }
    int first = m;
    double most = RUN_STEP * placido_field_period(&n->field, edge, m % meridians);
    for (double next; m + 1 < start + meridians; m++, here = next) {
      next = deviation(n, edge, m + 1);
      if (!(fabs(next - here) <= most)) {
        break;
      }
    }
    judge_run(n, edge, first, m + 1);
  }
}

/* Predicts and assigns by turns until nothing changes. */
static int repeat(settling *n, placido_error *err) {
  size_t before = 0, count = fill(n);
  int status = PLACIDO_OK;
  for (int pass = 0; pass < PASSES && count != before && !status; pass++) {
    before = count;
    status = placido_field_predict(&n->field, err);
    for (int m = 0; m < n->all->meridians && !status; m++) {
      assign(n, m);
    }
    for (int k = 0; k < n->field.edges && !status; k++) {
      drop_noise(n, k);
    }
    fill(n);
    spread_trust(n);
    drop_distrusted(n);
    count = fill(n);
  }
  return status;
}

int placido_crossings_settle(placido_crossings *crossings, const placido_chains *chains,
                             int edge_count, bool first_rises, const double *ordinary_px,
                             placido_error *err) {
  settling n = {.all = crossings, .first_rises = first_rises};
  int status = placido_field_new(&n.field, edge_count, crossings->meridians, ordinary_px, err);
  if (status) {
    return status;
  }
  size_t cells = (size_t)edge_count * (size_t)n.field.sectors;
  n.trusted = placido_memory_new(cells, sizeof *n.trusted, err);
  n.queue = placido_memory_new(cells, sizeof *n.queue, err);
  n.own = placido_memory_new(crossings->count, sizeof *n.own, err);
  n.chosen = placido_memory_new((size_t)edge_count * (size_t)crossings->meridians,
                                sizeof *n.chosen, err);
  status = n.trusted && n.queue && n.own && n.chosen ? PLACIDO_OK : PLACIDO_MEMORY;
  if (!status) {
    fill(&n);
    spread_trust(&n);
    drop_distrusted(&n);
    for (size_t i = 0; i < crossings->count; i++) {
      placido_crossing *c = &crossings->list[i];
      bool is_long = c->edge >= 0 && chains->list[c->chain].length * LONG > crossings->meridians;
      n.own[i] = c->edge = is_long ? c->edge : -1;
    }
    status = repeat(&n, err);
  }
  placido_field_free(&n.field);
  placido_memory_free(n.trusted);
  placido_memory_free(n.queue);
  placido_memory_free(n.own);
  placido_memory_free(n.chosen);
  return status;
}
