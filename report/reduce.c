/* Few colours instead of many: greedily the one that the pixels miss most (count times squared
 * distance to the nearest colour so far), which is Gonzalez' farthest-point clustering (Theor.
 * Comput. Sci. 38, 293-306, 1985) with weights. The order of the pixels does not matter to it. */
#include "report/reduce.h"

#include "base/memory.h"

#include <stddef.h>

enum { SLOTS = 1 << 16, DISTINCT_MAX = SLOTS / 2 };

static const double error_max = 12; /* mean square, summed over the channels: 2 of 255 each */

/* A colour of the canvas. */
typedef struct shade {
  uint32_t colour;  /* 0xRRGGBB */
  uint32_t pixels;  /* that have it; 0: the slot is free */
  uint32_t missed;  /* squared distance to the nearest colour of the palette */
  uint8_t nearest;
} shade;

/* All colours of the canvas, hashed, and the filled slots in the order in which they came up. */
typedef struct shades {
  shade *slots;
  uint32_t *filled;
  uint32_t count;
} shades;

static const uint32_t *row_of(const placido_canvas *canvas, int y) {
  const unsigned char *data = cairo_image_surface_get_data(canvas->surface);
  size_t stride = (size_t)cairo_image_surface_get_stride(canvas->surface);
  return (const uint32_t *)(const void *)(data + (size_t)y * stride);
}

static shade *find(const shades *s, uint32_t colour) {
  uint32_t slot = (colour * 2654435761u) >> 16; /* Knuth's multiplicative hash */
  while (s->slots[slot].pixels > 0 && s->slots[slot].colour != colour) {
    slot = (slot + 1) % SLOTS;
  }
  return &s->slots[slot];
}

/* False where there are too many colours. */
static bool count_colours(shades *s, const placido_canvas *canvas) {
  for (int y = 0; y < canvas->height_px; y++) {
    const uint32_t *row = row_of(canvas, y);
    for (int x = 0; x < canvas->width_px; x++) {
      uint32_t colour = row[x] & 0xffffff;
      shade *found = find(s, colour);
      if (found->pixels == 0) {
        if (s->count == DISTINCT_MAX) {
          return false;
        }
        s->filled[s->count++] = (uint32_t)(found - s->slots);
        *found = (shade){.colour = colour, .missed = UINT32_MAX};
      }
      found->pixels++;
    }
  }
  return true;
}

static uint32_t distance(uint32_t a, uint32_t b) {
  uint32_t sum = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    int difference = (int)(a >> shift & 255) - (int)(b >> shift & 255);
    sum += (uint32_t)(difference * difference);
  }
  return sum;
}

/* Takes a colour into the palette, and returns the one that is missed most then. */
static uint32_t take(shades *s, placido_reduced *reduced, uint32_t colour, double *most,
                     double *all) {
  uint8_t index = (uint8_t)reduced->count++;
  uint32_t next = colour;
  for (int k = 0; k < 3; k++) {
    reduced->colours[index][k] = (uint8_t)(colour >> (16 - 8 * k));
  }
  *most = *all = 0;
  for (uint32_t i = 0; i < s->count; i++) {
    shade *one = &s->slots[s->filled[i]];
    uint32_t away = distance(one->colour, colour);
    if (away < one->missed) {
      one->missed = away;
      one->nearest = index;
    }
    double weight = (double)one->missed * one->pixels;
    *all += weight;
    if (weight > *most) {
      *most = weight;
      next = one->colour;
    }
  }
  return next;
}

static uint32_t most_frequent(const shades *s) {
  uint32_t best = s->filled[0];
  for (uint32_t i = 1; i < s->count; i++) {
    best = s->slots[s->filled[i]].pixels > s->slots[best].pixels ? s->filled[i] : best;
  }
  return s->slots[best].colour;
}

static void choose(shades *s, placido_reduced *reduced, double pixels) {
  double most = 1, all = 0;
  uint32_t colour = most_frequent(s);
  while (reduced->count < PLACIDO_COLOURS_MAX && most > 0) {
    colour = take(s, reduced, colour, &most, &all);
  }
  if (all > error_max * pixels) {
    reduced->count = 0;
  }
}

static int fill_indices(const shades *s, placido_reduced *reduced, const placido_canvas *canvas,
                        placido_error *err) {
  size_t width = (size_t)canvas->width_px;
  reduced->indices = placido_memory_new(width, (size_t)canvas->height_px, err);
  if (reduced->indices == NULL) {
    return PLACIDO_MEMORY;
  }
  for (int y = 0; y < canvas->height_px; y++) {
    const uint32_t *row = row_of(canvas, y);
    for (int x = 0; x < canvas->width_px; x++) {
      reduced->indices[(size_t)y * width + (size_t)x] = find(s, row[x] & 0xffffff)->nearest;
    }
  }
  return PLACIDO_OK;
}

int placido_reduce(placido_reduced *reduced, const placido_canvas *canvas, placido_error *err) {
  *reduced = (placido_reduced){0};
  shades s = {.slots = placido_memory_new(SLOTS, sizeof *s.slots, err),
              .filled = placido_memory_new(DISTINCT_MAX, sizeof *s.filled, err)};
  int status = s.slots != NULL && s.filled != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  cairo_surface_flush(canvas->surface);
  if (status == PLACIDO_OK && count_colours(&s, canvas)) {
    choose(&s, reduced, (double)canvas->width_px * canvas->height_px);
  }
  if (status == PLACIDO_OK && reduced->count > 0) {
    status = fill_indices(&s, reduced, canvas, err);
  }
  placido_memory_free(s.slots);
  placido_memory_free(s.filled);
  return status;
}

void placido_reduced_free(placido_reduced *reduced) {
  placido_memory_free(reduced->indices);
  *reduced = (placido_reduced){0};
}
