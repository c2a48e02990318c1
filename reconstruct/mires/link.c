/* Linking: a candidate's partner on the next meridian is the nearest of its polarity to where the
 * chain is heading, if that one's nearest is this one. */
#include "reconstruct/mires/link.h"

#include "base/memory.h"

#include <math.h>

#define NONE ((size_t)-1)
#define GAP_MOST_PX 12

/* Links to the next and from the previous meridian, and how fast the radius changes there. */
typedef struct link_state {
  size_t next, previous;
  double drift_px;
} link_state;

/* The first candidate on `meridian` that lies at or beyond `radius`. */
static size_t first_beyond(const placido_crossings *all, int meridian, double radius) {
  size_t low = all->first[meridian], high = all->first[meridian + 1];
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (all->list[middle].radius_px < radius) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/* The nearest candidate of the same polarity on `meridian` to `radius`, within tolerance. */
static size_t nearest(const placido_crossings *all, int meridian, double radius, bool rising,
                      double tolerance) {
  size_t best = NONE, last = all->first[meridian + 1];
  for (size_t i = first_beyond(all, meridian, radius - tolerance); i < last; i++) {
    const placido_crossing *c = &all->list[i];
    double distance = c->radius_px - radius;
    if (distance >= tolerance) {
      break;
    }
    if ((c->slope > 0) == rising && fabs(distance) < tolerance) {
      tolerance = fabs(distance);
      best = i;
    }
  }
  return best;
}

/* How far a partner may be: a third of the way to the neighbours of the same polarity, which are
 * two edges away. */
static double tolerance_at(const placido_crossings *all, size_t i) {
  const placido_crossing *c = &all->list[i];
  double gap = GAP_MOST_PX;
  for (size_t j = i; j-- > all->first[c->meridian];) {
    double distance = c->radius_px - all->list[j].radius_px;
    bool same = (all->list[j].slope > 0) == (c->slope > 0);
    gap = same ? fmin(gap, distance) : gap;
    if (same || distance > gap) {
      break;
    }
  }
  for (size_t j = i + 1; j < all->first[c->meridian + 1]; j++) {
    double distance = all->list[j].radius_px - c->radius_px;
    bool same = (all->list[j].slope > 0) == (c->slope > 0);
    gap = same ? fmin(gap, distance) : gap;
    if (same || distance > gap) {
      break;
    }
  }
  return fmax(1, gap / 3);
}

static void link_meridian(const placido_crossings *all, link_state *links, int meridian) {
  int next = (meridian + 1) % all->meridians;
  for (size_t i = all->first[meridian]; i < all->first[meridian + 1]; i++) {
    const placido_crossing *c = &all->list[i];
    bool rising = c->slope > 0;
    double tolerance = tolerance_at(all, i);
    size_t j = nearest(all, next, c->radius_px + links[i].drift_px, rising, tolerance);
    if (j == NONE || links[j].previous != NONE) {
      continue;
    }
    double back = all->list[j].radius_px - links[i].drift_px;
    if (nearest(all, meridian, back, rising, tolerance) == i) {
      links[i].next = j;
      links[j].previous = i;
      double drift = all->list[j].radius_px - c->radius_px;
      links[j].drift_px = 0.7 * links[i].drift_px + 0.3 * drift;
    }
  }
}

/* Walks a chain from its first member, counting; `number` >= 0 marks the members. */
static placido_chain walk(placido_crossings *all, const link_state *links, size_t start,
                          int number) {
  placido_chain chain = {.rising = all->list[start].slope > 0, .edge = -1};
  size_t i = start;
  do {
    chain.length++;
    chain.radius_px += all->list[i].radius_px;
    all->list[i].chain = number;
    i = links[i].next;
  } while (i != NONE && i != start);
  chain.radius_px /= chain.length;
  return chain;
}

int placido_chains_link(placido_chains *chains, placido_crossings *crossings, int length_min,
                        placido_error *err) {
  *chains = (placido_chains){0};
  link_state *links = placido_memory_new(crossings->count, sizeof *links, err);
  chains->list = placido_memory_new(crossings->count, sizeof *chains->list, err);
  if (!links || !chains->list) {
    placido_memory_free(links);
    placido_chains_free(chains);
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < crossings->count; i++) {
    links[i] = (link_state){.next = NONE, .previous = NONE};
  }
  for (int m = 0; m < crossings->meridians; m++) {
    link_meridian(crossings, links, m);
  }
  /* open chains begin where nothing leads to; what is left after them runs all the way round */
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < crossings->count; i++) {
      placido_crossing *c = &crossings->list[i];
      if (c->chain != -1 || (pass == 0 && links[i].previous != NONE)) {
        continue;
      }
      placido_chain chain = walk(crossings, links, i, chains->count);
      if (chain.length >= length_min) {
        chains->list[chains->count++] = chain;
      } else {
        walk(crossings, links, i, -2);
      }
    }
  }
  for (size_t i = 0; i < crossings->count; i++) {
    if (crossings->list[i].chain == -2) {
      crossings->list[i].chain = -1;
    }
  }
  placido_memory_free(links);
  return PLACIDO_OK;
}

void placido_chains_free(placido_chains *chains) {
  placido_memory_free(chains->list);
  *chains = (placido_chains){0};
}
