/* Numbering in two steps. First relative: of two chains that follow each other outwards and turn
 * opposite ways the outer one is one more; what hangs together by votes is a component (the gaps
 * of a cone's seam cut the mires in two). Then absolute: the component that shows the innermost
 * mire round the centre begins with edge 0, and the others are laid against it. */
#include "reconstruct/mires/number.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define VOTES_MIN 3
#define AGREEMENT 0.7       /* share of the votes that must say the same */
#define GAP_LOOK 3          /* edges either side in which the widest step is looked for */
#define GAP_MOST 1.7        /* of that step; with a pair missing it would be twice as wide or more */
#define RELATIVE_MAX 512    /* relative numbers lie within ± this */
#define ANCHOR_SHARE 0.5    /* of its neighbours' length and strength that the innermost edge must have */
#define ANCHOR_NEIGHBOURS 4
#define ROUND_SHARE 0.25    /* of the circle on which the innermost edge must be seen */
#define ARC_SHARE 0.1       /* of the circle that it must run without a break: squares do not */
#define MATCH_LOG 0.15      /* mean |log radius ratio| up to which two components agree */

static bool edge_rises(const placido_instrument *instrument, int edge) {
  return (edge % 2 == 0) == instrument->first_band_bright;
}

/* "Chain `outer` follows chain `inner` outwards", and on how many meridians that is seen. */
typedef struct follows {
  int inner, outer, votes;
} follows;

static int by_pair(const void *a, const void *b) {
  const follows *x = a, *y = b;
  return x->inner != y->inner ? (x->inner > y->inner) - (x->inner < y->inner)
                              : (x->outer > y->outer) - (x->outer < y->outer);
}

/* The widest step between edges that an ordinary cornea shows about this radius. */
static double widest_gap(const placido_instrument *instrument, const double *expected_px,
                         double radius_px) {
  int k = 0, last = instrument->edge_count - 1;
  while (k < last && expected_px[k] < radius_px) {
    k++;
  }
  double widest = 0;
  for (int i = k - GAP_LOOK; i < k + GAP_LOOK; i++) {
    if (i >= 0 && i < last && isfinite(expected_px[i + 1])) {
      widest = fmax(widest, expected_px[i + 1] - expected_px[i]);
    }
  }
  /* outwards of everything expected, the last steps tell */
  for (int i = last - 1; i > 0 && widest == 0; i--) {
    widest = isfinite(expected_px[i + 1]) ? expected_px[i + 1] - expected_px[i] : 0;
  }
  return widest;
}

/* Lists every pair of chains that follow each other, with votes. Where the step is so wide that a
 * pair of edges may have been missed between them, they do not vote. */
static int follows_new(follows **list, size_t *count, const placido_crossings *all,
                       const placido_instrument *instrument, const double *expected_px,
                       placido_error *err) {
  *count = 0;
  *list = placido_memory_new(all->count, sizeof **list, err);
  if (!*list) {
    return PLACIDO_MEMORY;
  }
  for (int m = 0; m < all->meridians; m++) {
    for (size_t i = all->first[m]; i + 1 < all->first[m + 1]; i++) {
      const placido_crossing *a = &all->list[i], *b = a + 1;
      if (a->chain >= 0 && b->chain >= 0 && (a->slope > 0) != (b->slope > 0) &&
          b->radius_px - a->radius_px <
              GAP_MOST * widest_gap(instrument, expected_px, a->radius_px)) {
        (*list)[(*count)++] = (follows){a->chain, b->chain, 1};
      }
    }
  }
  qsort(*list, *count, sizeof **list, by_pair);
  size_t kept = 0;
  for (size_t i = 0; i < *count; i++) {
    if (kept && by_pair(&(*list)[kept - 1], &(*list)[i]) == 0) {
      (*list)[kept - 1].votes++;
    } else {
      (*list)[kept++] = (*list)[i];
    }
  }
  *count = kept;
  return PLACIDO_OK;
}

/* What is known of one relative number of a component. */
typedef struct ring {
  int length;    /* meridians on which it is seen */
  int longest;   /* its longest chain */
  double radius; /* sums of radius and |slope| over them */
  double strength;
  bool rising;
} ring;

/* Chains whose relative numbers hang together. */
typedef struct component {
  int low, high; /* relative numbers present */
  int length;    /* of all chains */
  int offset;    /* absolute = relative + offset, once placed */
  bool placed;
} component;

/* The state of the numbering. */
typedef struct numbering {
  placido_chains *chains;
  const placido_crossings *crossings;
  const placido_instrument *instrument;
  const double *expected_px;
  follows *pairs;
  size_t pair_count;
  int *member;   /* component of a chain, -1: none */
  int *relative; /* its relative number there */
  int *tally;    /* votes for relative numbers, 2 RELATIVE_MAX + 1 */
  component *components;
  int component_count;
} numbering;

/* The relative number that the members of component `c` give chain `index`, and by how many votes;
 * 0 votes where they are few or disagree. */
static int elect(numbering *n, int index, int c, int *votes) {
  int total = 0, best = 0, low = RELATIVE_MAX, high = -RELATIVE_MAX;
  *votes = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < n->pair_count; i++) {
      const follows *f = &n->pairs[i];
      int other = f->outer == index ? f->inner : f->inner == index ? f->outer : -1;
      if (other < 0 || n->member[other] != c) {
        continue;
      }
      int number = n->relative[other] + (f->outer == index ? 1 : -1);
      int *count = &n->tally[number + RELATIVE_MAX];
      if (pass == 1) {
        *count = 0; /* leaves the tally clean */
        continue;
      }
      *count += f->votes;
      total += f->votes;
      low = number < low ? number : low;
      high = number > high ? number : high;
      if (*count > *votes) {
        *votes = *count;
        best = number;
      }
    }
  }
  if (*votes < VOTES_MIN || *votes < AGREEMENT * total || abs(best) >= RELATIVE_MAX) {
    *votes = 0;
  }
  return best;
}

/* Grows component `c` from chain `root`: always the chain with the most votes next, so that
 * doubtful ones are judged by the most neighbours. */
static void grow(numbering *n, int root, int c) {
  component *here = &n->components[c];
  int chosen = root, number = 0;
  while (chosen >= 0) {
    n->member[chosen] = c;
    n->relative[chosen] = number;
    here->length += n->chains->list[chosen].length;
    here->low = number < here->low ? number : here->low;
    here->high = number > here->high ? number : here->high;
    int most = 0;
    chosen = -1;
    for (int i = 0; i < n->chains->count; i++) {
      int votes = 0;
      int elected = n->member[i] < 0 ? elect(n, i, c, &votes) : 0;
      if (votes > most) {
        chosen = i;
        number = elected;
        most = votes;
      }
    }
  }
}

/* Splits the chains into components, each from its longest chain. */
static void split(numbering *n) {
  for (;;) {
    int root = -1;
    for (int i = 0; i < n->chains->count; i++) {
      if (n->member[i] < 0 &&
          (root < 0 || n->chains->list[i].length > n->chains->list[root].length)) {
        root = i;
      }
    }
    if (root < 0 || n->chains->list[root].length * 20 < n->crossings->meridians) {
      return;
    }
    grow(n, root, n->component_count++);
  }
}

static ring ring_of(const numbering *n, int c, int relative) {
  ring r = {0};
  for (size_t i = 0; i < n->crossings->count; i++) {
    const placido_crossing *x = &n->crossings->list[i];
    if (x->chain >= 0 && n->member[x->chain] == c && n->relative[x->chain] == relative) {
      int chain = n->chains->list[x->chain].length;
      r.length++;
      r.longest = chain > r.longest ? chain : r.longest;
      r.radius += x->radius_px;
      r.strength += fabs(x->slope);
      r.rising = x->slope > 0;
    }
  }
  return r;
}

/* Whether relative number `relative` of a component is as long and as strong as those outwards of
 * it: noise within the innermost mire is not. */
static bool stands_out(const numbering *n, int c, int relative) {
  ring here = ring_of(n, c, relative);
  double length = 0, strength = 0;
  for (int k = 1; k <= ANCHOR_NEIGHBOURS; k++) {
    ring next = ring_of(n, c, relative + k);
    length += (double)next.length / ANCHOR_NEIGHBOURS;
    strength += next.length ? next.strength / next.length / ANCHOR_NEIGHBOURS : 0;
  }
  return here.length > 0 && here.length >= ANCHOR_SHARE * length &&
         here.strength / here.length >= ANCHOR_SHARE * strength;
}

/* The relative number of edge 0 in a component, if it shows the innermost mire where an eye can
 * have it. */
static bool find_anchor(const numbering *n, int c, int *anchor) {
  const double *e = n->expected_px;
  double low = 0.35 * e[0], high = 1.6 * e[0];
  if (n->instrument->edge_count > 2 && isfinite(e[2])) {
    high = 0.5 * (e[0] + e[2]); /* beyond, it is rather edge 2 */
  }
  for (int k = n->components[c].low; k < n->components[c].high; k++) {
    ring r = ring_of(n, c, k);
    double radius = r.radius / r.length;
    if (r.length && radius > high) {
      return false;
    }
    if (stands_out(n, c, k) && r.rising == edge_rises(n->instrument, 0) && radius > low) {
      *anchor = k;
      return r.length >= ROUND_SHARE * n->crossings->meridians &&
             r.longest >= ARC_SHARE * n->crossings->meridians;
    }
  }
  return false;
}

/* How well a component laid at `offset` agrees with the reference where both show the same edges:
 * mean |log of the radii's ratio| over the innermost few; INFINITY where they share fewer than 3. */
static double disagreement(const numbering *n, int c, int offset, int reference) {
  double sum = 0;
  int shared = 0;
  const component *ref = &n->components[reference];
  for (int k = n->components[c].low; k <= n->components[c].high && shared < 6; k++) {
    ring a = ring_of(n, c, k), b = ring_of(n, reference, k + offset - ref->offset);
    if (a.length > n->crossings->meridians / 36 && b.length > n->crossings->meridians / 36) {
      sum += fabs(log(a.radius / a.length * b.length / b.radius));
      shared++;
    }
  }
  return shared >= 3 ? sum / shared : INFINITY;
}

/* Lays a component against the reference where one offset fits clearly best. */
static void place(numbering *n, int c, int reference) {
  component *here = &n->components[c];
  int parity = ring_of(n, c, here->low).rising == edge_rises(n->instrument, 0) ? 0 : 1;
  double best = INFINITY, second = INFINITY;
  for (int first = parity - 4; first < n->instrument->edge_count; first += 2) {
    double d = disagreement(n, c, first - here->low, reference);
    if (d < best) {
      second = best;
      best = d;
      here->offset = first - here->low;
    } else if (d < second) {
      second = d;
    }
  }
  here->placed = best < MATCH_LOG && second > 1.5 * best;
}

/* Finds the reference and places everything. Returns false where no component shows the innermost mire. */
static bool anchor_all(numbering *n) {
  int reference = -1;
  for (int c = 0; c < n->component_count; c++) {
    int anchor;
    if (find_anchor(n, c, &anchor) &&
        (reference < 0 || n->components[c].length > n->components[reference].length)) {
      reference = c;
      n->components[c].offset = -anchor;
    }
  }
  if (reference < 0) {
    return false;
  }
  n->components[reference].placed = true;
  for (int c = 0; c < n->component_count; c++) {
    if (c != reference) {
      place(n, c, reference);
    }
  }
  return true;
}

/* Along a meridian numbers must grow; where two do not, the one from the shorter chain goes. */
static void enforce_order(placido_crossings *all, const placido_chains *chains, int meridian) {
  for (size_t j = all->first[meridian]; j < all->first[meridian + 1]; j++) {
    placido_crossing *outer = &all->list[j];
    for (size_t i = all->first[meridian]; i < j && outer->edge >= 0; i++) {
      placido_crossing *inner = &all->list[i];
      if (inner->edge >= outer->edge) {
        bool drop_inner =
            chains->list[inner->chain].length < chains->list[outer->chain].length;
        (drop_inner ? inner : outer)->edge = -1;
      }
    }
  }
}

/* Writes the numbers into chains and crossings. */
static void hand_out(const numbering *n, placido_crossings *crossings) {
  for (int i = 0; i < n->chains->count; i++) {
    const component *c = n->member[i] >= 0 ? &n->components[n->member[i]] : NULL;
    int edge = c && c->placed ? n->relative[i] + c->offset : -1;
    bool possible = edge >= 0 && edge < n->instrument->edge_count;
    n->chains->list[i].edge = possible ? edge : -1;
  }
  for (size_t i = 0; i < crossings->count; i++) {
    placido_crossing *x = &crossings->list[i];
    x->edge = x->chain >= 0 ? n->chains->list[x->chain].edge : -1;
  }
  for (int m = 0; m < crossings->meridians; m++) {
    enforce_order(crossings, n->chains, m);
  }
}

int placido_chains_number(placido_chains *chains, placido_crossings *crossings,
                          const placido_instrument *instrument, const double *expected_px,
                          placido_error *err) {
  numbering n = {.chains = chains,
                 .crossings = crossings,
                 .instrument = instrument,
                 .expected_px = expected_px};
  size_t count = (size_t)chains->count;
  int status = follows_new(&n.pairs, &n.pair_count, crossings, instrument, expected_px, err);
  if (!status) {
    n.member = placido_memory_new(count, sizeof *n.member, err);
    n.relative = placido_memory_new(count, sizeof *n.relative, err);
    n.tally = placido_memory_new(2 * RELATIVE_MAX + 1, sizeof *n.tally, err);
    n.components = placido_memory_new(count, sizeof *n.components, err);
    status = n.member && n.relative && n.tally && n.components ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (!status) {
    for (size_t i = 0; i < count; i++) {
      n.member[i] = -1;
    }
    split(&n);
    if (anchor_all(&n)) {
      hand_out(&n, crossings);
    } else {
      status = placido_error_set(err, PLACIDO_QUALITY,
                                 "no mires, or the innermost one is not seen on a quarter of the "
                                 "circle: nothing can be numbered");
    }
  }
  placido_memory_free(n.pairs);
  placido_memory_free(n.member);
  placido_memory_free(n.relative);
  placido_memory_free(n.tally);
  placido_memory_free(n.components);
  return status;
}
