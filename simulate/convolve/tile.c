/* Sizes and memory of a padded tile, the same for both precisions. */
#include "simulate/convolve/tile.h"

#include "base/memory.h"

#include <string.h>

placido_shape placido_shape_of(const placido_layout *layout, const placido_precision *precision) {
  placido_shape shape = {.columns = layout->x.padded,
                         .rows = layout->y.padded,
                         .reach_x = layout->x.reach,
                         .reach_y = layout->y.reach};
  shape.lanes = PLACIDO_LINE_BYTES / (int)(2 * precision->sample_bytes);
  shape.blocks = (shape.columns / 2 + shape.lanes) / shape.lanes;
  size_t line = 2 * (size_t)shape.lanes;
  shape.row = line * (size_t)shape.blocks;
  shape.column = line * (size_t)shape.rows;
  shape.block = shape.column + line; /* rows of all blocks would share few sets of the cache */
  return shape;
}

/* Takes `samples` from the front of what is left, a whole number of lines. */
static void *take(char **rest, size_t samples, size_t sample_bytes) {
  char *taken = *rest;
  *rest += samples * sample_bytes;
  return taken;
}

int placido_workspace_new(placido_workspace *work, const placido_shape *shape,
                          const placido_precision *precision, bool sum, placido_error *err) {
  size_t bytes = precision->sample_bytes, planes = (size_t)shape->blocks;
  size_t all = 2 * shape->row + shape->column + shape->block * planes;
  size_t more = sum ? shape->column * planes : 0;
  *work = (placido_workspace){0};
  char *rest = placido_memory_new_aligned((all + more) * bytes, err);
  if (rest == NULL) {
    return PLACIDO_MEMORY;
  }
  work->samples = take(&rest, shape->row, bytes);
  work->row = take(&rest, shape->row, bytes);
  work->column = take(&rest, shape->column, bytes);
  work->spectrum = take(&rest, shape->block * planes, bytes);
  work->sum = sum ? take(&rest, more, bytes) : NULL;
  memset(work->row, 0, shape->row * bytes); /* what lies behind the last column stays 0 */
  return PLACIDO_OK;
}

void placido_workspace_free(placido_workspace *work) {
  if (work != NULL) {
    placido_memory_free(work->samples);
    *work = (placido_workspace){0};
  }
}
