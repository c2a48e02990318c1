/* Absolute numbers: the component that shows the innermost mire round the centre begins with edge
 * 0, and the others (the gaps of a cone's seam cut the mires in two) are laid against it. */
#include "reconstruct/mires/number.h"

#include "base/memory.h"
#include "reconstruct/median.h"
#include "reconstruct/mires/components.h"

#include <math.h>
#include <string.h>

/* The innermost edge has at least this share of its neighbours' length and strength. */
#define ANCHOR_SHARE 0.5
#define ANCHOR_NEIGHBOURS 4
#define ANCHOR_PATTERN 8    /* edges whose pattern tells a flat cornea from a missed mire */
#define ROUND_SHARE 0.25    /* of the circle on which the innermost edge must be seen */
#define ARC_SHARE 0.1       /* of the circle that it must run without a break: squares do not */
/* An edge within the innermost mire that has this share of its strength is a mire too. */
#define INSIDE_STRONG 0.5
#define INSIDE_MOST 0.05    /* share of the meridians on which one may be seen */
#define PASSES 4
#define MATCH_LOG 0.15      /* mean |log radius ratio| up to which two components agree */

static bool edge_rises(const placido_instrument *instrument, int edge) {
  return (edge % 2 == 0) == instrument->first_band_bright;
}

/* What is known of one relative number of a component. */
typedef struct ring {
  int length;    /* meridians on which it is seen */
  int longest;   /* its longest chain */
  double radius; /* sums of radius and |slope| over them */
  double strength;
  bool rising;
} ring;

/* Where a component has been laid. */
typedef struct place_of {
  int offset; /* absolute = relative + offset */
  bool placed;
  int first_ring; /* its lowest relative number's place in `rings` */
} place_of;

/* The state of the numbering. */
typedef struct numbering {
  placido_chains *chains;
  const placido_crossings *crossings;
  const placido_instrument *instrument;
  const double *expected_px;
  placido_components components;
  place_of *places; /* one a component, room for one a chain */
  ring *rings;      /* of every component, by relative number */
} numbering;

static ring ring_of(const numbering *n, int c, int relative) {
  const placido_component *component = &n->components.list[c];
  bool present = relative >= component->low && relative <= component->high;
  return present ? n->rings[n->places[c].first_ring + relative - component->low] : (ring){0};
}

/* Sums up all rings of all components in one pass over the crossings. */
static int sum_rings(numbering *n, placido_error *err) {
  int total = 0;
  for (int c = 0; c < n->components.count; c++) {
    n->places[c].first_ring = total;
    total += n->components.list[c].high - n->components.list[c].low + 1;
  }
  placido_memory_free(n->rings);
  n->rings = placido_memory_new((size_t)total, sizeof *n->rings, err);
  if (!n->rings) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < n->crossings->count; i++) {
    const placido_crossing *x = &n->crossings->list[i];
    int c = x->chain >= 0 ? n->components.member[x->chain] : -1;
    if (c < 0) {
      continue;
    }
    int chain = n->chains->list[x->chain].length;
    ring *r = &n->rings[n->places[c].first_ring + n->components.relative[x->chain] -
                        n->components.list[c].low];
    r->length++;
    r->longest = chain > r->longest ? chain : r->longest;
    r->radius += x->radius_px;
    r->strength += fabs(x->slope);
    r->rising = x->slope > 0;
  }
  return PLACIDO_OK;
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

/* How unevenly the innermost edges lie to those expected if relative number `first` is edge
 * `edge`: range of log(radius / expected) over them. INFINITY where fewer than 3 can be told. */
static double unevenness(const numbering *n, int c, int first, int edge) {
  double low = INFINITY, high = -INFINITY;
  int told = 0;
  for (int k = 0; k < ANCHOR_PATTERN && edge + k < n->instrument->edge_count; k++) {
    ring r = ring_of(n, c, first + k);
    double expected = n->expected_px[edge + k];
    if (r.length && isfinite(expected)) {
      double ratio = log(r.radius / r.length / expected);
      low = fmin(low, ratio);
      high = fmax(high, ratio);
      told++;
    }
  }
  return told >= 3 ? high - low : INFINITY;
}

/* The relative number of edge 0 in a component, if it shows the innermost mire where an eye can
 * have it. */
static bool find_anchor(const numbering *n, int c, int *anchor) {
  const double *e = n->expected_px;
  double low = 0.35 * e[0], high = 1.7 * e[0];
  for (int k = n->components.list[c].low; k < n->components.list[c].high; k++) {
    ring r = ring_of(n, c, k);
    double radius = r.radius / r.length;
    if (r.length && radius > high) {
      return false;
    }
    if (stands_out(n, c, k) && r.rising == edge_rises(n->instrument, 0) && radius > low) {
      *anchor = k;
      if (n->instrument->edge_count > 2 && radius > 0.5 * (e[0] + e[2]) &&
          unevenness(n, c, k, 2) < unevenness(n, c, k, 0)) {
        return false; /* so far out it is rather edge 2, unless the pattern speaks for a flat eye */
      }
      return r.length >= ROUND_SHARE * n->crossings->meridians &&
             r.longest >= ARC_SHARE * n->crossings->meridians;
    }
  }
  return false;
}

/* How well a component laid at `offset` agrees with the reference where both show the same edges:
 * mean |log of the radii's ratio| over the innermost few; INFINITY where they share fewer than 3.
 */
static double disagreement(const numbering *n, int c, int offset, int reference) {
  double sum = 0;
  int shared = 0;
  for (int k = n->components.list[c].low; k <= n->components.list[c].high && shared < 6; k++) {
    ring a = ring_of(n, c, k), b = ring_of(n, reference, k + offset - n->places[reference].offset);
    if (a.length > n->crossings->meridians / 36 && b.length > n->crossings->meridians / 36) {
      sum += fabs(log(a.radius / a.length * b.length / b.radius));
      shared++;
    }
  }
  return shared >= 3 ? sum / shared : INFINITY;
}

/* Lays a component against the reference where one offset fits clearly best. */
static void lay_against(numbering *n, int c, int reference) {
  const placido_component *here = &n->components.list[c];
  place_of *place = &n->places[c];
  int parity = ring_of(n, c, here->low).rising == edge_rises(n->instrument, 0) ? 0 : 1;
  double best = INFINITY, second = INFINITY;
  for (int first = parity - 4; first < n->instrument->edge_count; first += 2) {
    double d = disagreement(n, c, first - here->low, reference);
    if (d < best) {
      second = best;
      best = d;
      place->offset = first - here->low;
    } else if (d < second) {
      second = d;
    }
  }
  place->placed = best < MATCH_LOG && second > 1.5 * best;
}

/* Finds the reference and places everything. Returns false where no component shows the innermost
 * mire. */
static bool anchor_all(numbering *n) {
  int reference = -1;
  for (int c = 0; c < n->components.count; c++) {
    int anchor;
    if (find_anchor(n, c, &anchor) &&
        (reference < 0 || n->components.list[c].length > n->components.list[reference].length)) {
      reference = c;
      n->places[c].offset = -anchor;
    }
  }
  if (reference < 0) {
    return false;
  }
  n->places[reference].placed = true;
  for (int c = 0; c < n->components.count; c++) {
    if (c != reference) {
      lay_against(n, c, reference);
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
    const place_of *p =
        n->components.member[i] >= 0 ? &n->places[n->components.member[i]] : NULL;
    int edge = p && p->placed ? n->components.relative[i] + p->offset : -1;
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

/* Median of radius / expected over the numbered crossings: how much larger than in an ordinary
 * cornea the mires are. `work` holds as many numbers as there are crossings. */
static double scale_of(const numbering *n, double *work) {
  size_t count = 0;
  for (size_t i = 0; i < n->crossings->count; i++) {
    const placido_crossing *x = &n->crossings->list[i];
    if (x->edge >= 0 && isfinite(n->expected_px[x->edge])) {
      work[count++] = x->radius_px / n->expected_px[x->edge];
    }
  }
  return count ? placido_quantile(work, count, 0.5) : 1;
}

/* Share of the meridians on which an edge nearly as strong as the innermost mire's, and turning the
 * other way as a mire's far side does, lies within it. A small bright spot in the middle is the
 * reflection of a lamp and no such edge. */
static double share_inside(const numbering *n, const placido_crossings *crossings) {
  double strength = 0, least = 0.35 * n->expected_px[0];
  size_t count = 0;
  int disturbed = 0;
  for (size_t i = 0; i < crossings->count; i++) {
    if (crossings->list[i].edge == 0) {
      strength += fabs(crossings->list[i].slope);
      count++;
    }
  }
  for (int m = 0; m < crossings->meridians; m++) {
    bool strong = false, round = false;
    for (size_t i = crossings->first[m]; i < crossings->first[m + 1] && !round; i++) {
      const placido_crossing *x = &crossings->list[i];
      round = x->edge >= 0;
      strong |= !round && x->radius_px > least &&
                (x->slope > 0) != edge_rises(n->instrument, 0) &&
                fabs(x->slope) > INSIDE_STRONG * strength / (double)count;
    }
    disturbed += strong && round;
  }
  return (double)disturbed / crossings->meridians;
}

/* One pass at a scale; *found is false where nothing can be numbered. */
static int number_at(numbering *n, placido_crossings *crossings, double scale, bool *found,
                     placido_error *err) {
  placido_components_free(&n->components);
  int status = placido_components_find(&n->components, n->chains, crossings, n->instrument,
                                       n->expected_px, scale, err);
  if (!status) {
    memset(n->places, 0, (size_t)n->chains->count * sizeof *n->places);
    status = sum_rings(n, err);
  }
  if (!status) {
    *found = anchor_all(n);
    if (*found) {
      hand_out(n, crossings);
    }
  }
  return status;
}

int placido_chains_number(placido_chains *chains, placido_crossings *crossings,
                          const placido_instrument *instrument, const double *expected_px,
                          placido_error *err) {
  numbering n = {.chains = chains,
                 .crossings = crossings,
                 .instrument = instrument,
                 .expected_px = expected_px};
  size_t count = (size_t)chains->count;
  n.places = placido_memory_new(count, sizeof *n.places, err);
  double *work = placido_memory_new(crossings->count, sizeof *work, err);
  int status = n.places && work ? PLACIDO_OK : PLACIDO_MEMORY;
  /* the steps allowed between edges follow the size of the mires, which the innermost tell */
  double scale = 1, before = 0;
  bool found = true;
  for (int pass = 0; pass < PASSES && found && fabs(scale - before) > 0.03 && !status; pass++) {
    before = scale;
    status = number_at(&n, crossings, scale, &found, err);
    scale = !status && found ? scale_of(&n, work) : scale;
  }
  if (!status && !found) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "no mires, or the innermost one is not seen on a quarter of the "
                               "circle: nothing can be numbered");
  }
  if (!status && share_inside(&n, crossings) > INSIDE_MOST) {
    status = placido_error_set(err, PLACIDO_QUALITY,
                               "another edge lies within the innermost mire that was found, on "
                               "%.0f %% of the meridians: the mires cannot be numbered safely",
                               100 * share_inside(&n, crossings));
  }
  placido_components_free(&n.components);
  placido_memory_free(n.places);
  placido_memory_free(n.rings);
  placido_memory_free(work);
  return status;
}
