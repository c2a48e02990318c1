/* Components by votes, each grown from its longest chain. */
#include "reconstruct/mires/components.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define VOTES_MIN 3
#define AGREEMENT 0.7 /* share of the votes that must say the same */
#define GAP_LOOK 3    /* edges either side in which the widest step is looked for */
#define GAP_MOST 1.7  /* of that step; with a pair missing it would be twice as wide or more */
/* A component's longest chain runs over at least one part in so many of the circle. */
#define ROOT_SHARE 20

/* "Chain `outer` follows chain `inner` outwards", and on how many meridians that is seen. */
typedef struct follows {
  int inner, outer, votes;
} follows;

static int by_pair(const void *a, const void *b) {
  const follows *x = a, *y = b;
  return x->inner != y->inner ? (x->inner > y->inner) - (x->inner < y->inner)
                              : (x->outer > y->outer) - (x->outer < y->outer);
}

/* The widest step between edges that a cornea which shows the mires `scale` times as large as an
 * ordinary one shows about this radius. */
static double widest_gap(const placido_instrument *instrument, const double *expected_px,
                         double scale, double radius_px) {
  int k = 0, last = instrument->edge_count - 1;
  while (k < last && expected_px[k] * scale < radius_px) {
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
  return widest * scale;
}

/* Lists every pair of chains that follow each other, with votes. Where the step is so wide that a
 * pair of edges may have been missed between them, they do not vote. */
static int follows_new(follows **list, size_t *count, int chains, const placido_crossings *all,
                       const placido_instrument *instrument, const double *expected_px,
                       double scale, placido_error *err) {
  *count = 0;
  *list = placido_memory_new(all->count, sizeof **list, err);
  size_t *latest = placido_memory_new((size_t)chains, sizeof *latest, err);
  if (!*list || !latest) {
    placido_memory_free(latest);
    return PLACIDO_MEMORY;
  }
  for (int m = 0; m < all->meridians; m++) {
    for (size_t i = all->first[m]; i + 1 < all->first[m + 1]; i++) {
      const placido_crossing *a = &all->list[i], *b = a + 1;
      if (a->chain >= 0 && b->chain >= 0 && (a->slope > 0) != (b->slope > 0) &&
          b->radius_px - a->radius_px <
              GAP_MOST * widest_gap(instrument, expected_px, scale, a->radius_px)) {
        /* from meridian to meridian it is mostly the same pair */
        size_t *same = &latest[a->chain];
        if (*same < *count && (*list)[*same].inner == a->chain &&
            (*list)[*same].outer == b->chain) {
          (*list)[*same].votes++;
        } else {
          *same = *count;
          (*list)[(*count)++] = (follows){a->chain, b->chain, 1};
        }
      }
    }
  }
  qsort(*list, *count, sizeof **list, by_pair);
  size_t kept = 0;
  for (size_t i = 0; i < *count; i++) {
    if (kept && by_pair(&(*list)[kept - 1], &(*list)[i]) == 0) {
      (*list)[kept - 1].votes += (*list)[i].votes;
    } else {
      (*list)[kept++] = (*list)[i];
    }
  }
  *count = kept;
  placido_memory_free(latest);
  return PLACIDO_OK;
}

/* What the election works on. */
typedef struct ballot {
  const placido_chains *chains;
  int meridians;
  follows *pairs;
  size_t pair_count;
  int *votes; /* by chain: for its present relative number in the component that grows */
  int *tally; /* votes for relative numbers, 2 PLACIDO_RELATIVE_MAX + 1 */
  placido_components *out;
} ballot;

/* The relative number that the members of component `c` give chain `index`, and by how many votes;
 * 0 votes where they are few or disagree. */
static int elect(ballot *n, int index, int c, int *votes) {
  int total = 0, best = 0;
  *votes = 0;
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < n->pair_count; i++) {
      const follows *f = &n->pairs[i];
      int other = f->outer == index ? f->inner : f->inner == index ? f->outer : -1;
      if (other < 0 || n->out->member[other] != c) {
        continue;
      }
      int number = n->out->relative[other] + (f->outer == index ? 1 : -1);
      int *count = &n->tally[number + PLACIDO_RELATIVE_MAX];
      if (pass == 1) {
        *count = 0; /* leaves the tally clean */
        continue;
      }
      *count += f->votes;
      total += f->votes;
      if (*count > *votes) {
        *votes = *count;
        best = number;
      }
    }
  }
  if (*votes < VOTES_MIN || *votes < AGREEMENT * total || abs(best) >= PLACIDO_RELATIVE_MAX) {
    *votes = 0;
  }
  return best;
}

/* Elects anew what follows or is followed by chain `index`. */
static void elect_beside(ballot *n, int index, int c) {
  for (size_t i = 0; i < n->pair_count; i++) {
    const follows *f = &n->pairs[i];
    int other = f->outer == index ? f->inner : f->inner == index ? f->outer : -1;
    if (other >= 0 && n->out->member[other] < 0) {
      n->out->relative[other] = elect(n, other, c, &n->votes[other]);
    }
  }
}

/* Grows component `c` from chain `root`: always the chain with the most votes next, so that
 * doubtful ones are judged by the most neighbours. */
static void grow(ballot *n, int root, int c) {
  placido_component *here = &n->out->list[c];
  int chosen = root;
  for (int i = 0; i < n->chains->count; i++) {
    n->votes[i] = 0;
  }
  n->out->relative[root] = 0;
  while (chosen >= 0) {
    int number = n->out->relative[chosen], most = 0;
    n->out->member[chosen] = c;
    here->length += n->chains->list[chosen].length;
    here->low = number < here->low ? number : here->low;
    here->high = number > here->high ? number : here->high;
    elect_beside(n, chosen, c);
    chosen = -1;
    for (int i = 0; i < n->chains->count; i++) {
      if (n->out->member[i] < 0 && n->votes[i] > most) {
        chosen = i;
        most = n->votes[i];
      }
    }
  }
}

/* Splits the chains into components, each from its longest chain. */
static void split(ballot *n) {
  for (;;) {
    int root = -1;
    for (int i = 0; i < n->chains->count; i++) {
      if (n->out->member[i] < 0 &&
          (root < 0 || n->chains->list[i].length > n->chains->list[root].length)) {
        root = i;
      }
    }
    if (root < 0 || n->chains->list[root].length * ROOT_SHARE < n->meridians) {
      return;
    }
    grow(n, root, n->out->count++);
  }
}

int placido_components_find(placido_components *components, const placido_chains *chains,
                            const placido_crossings *crossings,
                            const placido_instrument *instrument, const double *expected_px,
                            double scale, placido_error *err) {
  size_t count = (size_t)chains->count;
  *components = (placido_components){
      .list = placido_memory_new(count, sizeof *components->list, err),
      .member = placido_memory_new(count, sizeof *components->member, err),
      .relative = placido_memory_new(count, sizeof *components->relative, err),
  };
  ballot n = {.chains = chains, .meridians = crossings->meridians, .out = components};
  n.tally = placido_memory_new(2 * PLACIDO_RELATIVE_MAX + 1, sizeof *n.tally, err);
  n.votes = placido_memory_new(count, sizeof *n.votes, err);
  bool room = components->list && components->member && components->relative && n.tally && n.votes;
  int status = room ? follows_new(&n.pairs, &n.pair_count, chains->count, crossings, instrument,
                                  expected_px, scale, err)
                    : PLACIDO_MEMORY;
  if (!status) {
    for (size_t i = 0; i < count; i++) {
      components->member[i] = -1;
    }
    split(&n);
  }
  placido_memory_free(n.pairs);
  placido_memory_free(n.tally);
  placido_memory_free(n.votes);
  if (status) {
    placido_components_free(components);
  }
  return status;
}

void placido_components_free(placido_components *components) {
  placido_memory_free(components->list);
  placido_memory_free(components->member);
  placido_memory_free(components->relative);
  *components = (placido_components){0};
}
