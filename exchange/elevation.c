/* Others' heights: which reader takes them, which way is up, and that no point stands twice. */
#include "exchange/elevation.h"

#include "base/memory.h"
#include "base/text.h"

#include <math.h>
#include <stdlib.h>

#define ROOM_FIRST 4096
#define SAME_MM 1e-9 /* of heights: rounding in files */

int placido_elevation_add(placido_elevation *elevation, size_t *room, placido_height height,
                          int line, placido_error *err) {
  if (elevation->count == *room) {
    size_t more = *room ? 2 * *room : ROOM_FIRST;
    placido_height *heights =
        placido_memory_grow(elevation->heights, more, sizeof *heights, err);
    if (!heights) {
      return PLACIDO_MEMORY;
    }
    elevation->heights = heights;
    int *lines = placido_memory_grow(elevation->lines, more, sizeof *lines, err);
    if (!lines) {
      return PLACIDO_MEMORY;
    }
    elevation->lines = lines;
    *room = more;
  }
  elevation->lines[elevation->count] = line;
  elevation->heights[elevation->count++] = height;
  return PLACIDO_OK;
}

/* A point with its line, for sorting. */
struct entry {
  placido_height height;
  int line;
};

static int compare(const void *left, const void *right) {
  const struct entry *a = left, *b = right;
  if (a->height.y_mm != b->height.y_mm) {
    return a->height.y_mm < b->height.y_mm ? -1 : 1;
  }
  if (a->height.x_mm != b->height.x_mm) {
    return a->height.x_mm < b->height.x_mm ? -1 : 1;
  }
  return a->line < b->line ? -1 : a->line > b->line;
}

static int compare_lines(const void *left, const void *right) {
  const struct entry *a = left, *b = right;
  return a->line < b->line ? -1 : a->line > b->line;
}

static bool is_same_place(const struct entry *a, const struct entry *b) {
  return a->height.x_mm == b->height.x_mm && a->height.y_mm == b->height.y_mm;
}

/* Drops what stands twice, in place among `count` sorted entries; `*kept` are left. */
static int drop(struct entry *entries, size_t count, size_t *kept, const char *path,
                placido_error *err) {
  *kept = count > 0;
  for (size_t i = 1; i < count; i++) {
    const struct entry *last = &entries[*kept - 1], *this = &entries[i];
    if (!is_same_place(last, this)) {
      entries[(*kept)++] = *this;
    } else if (fabs(last->height.z_mm - this->height.z_mm) > SAME_MM) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "%s:%d: the point (%g, %g) mm stands in line %d, too, %g um higher",
                               placido_text_tail(path), this->line, this->height.x_mm,
                               this->height.y_mm, last->line,
                               1e3 * (last->height.z_mm - this->height.z_mm));
    }
  }
  return PLACIDO_OK;
}

static int drop_duplicates(placido_elevation *e, const char *path, placido_notes *notes,
                           placido_error *err) {
  struct entry *entries = placido_memory_new(e->count, sizeof *entries, err);
  size_t kept;
  if (!entries) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < e->count; i++) {
    entries[i] = (struct entry){e->heights[i], e->lines[i]};
  }
  qsort(entries, e->count, sizeof *entries, compare);
  int status = drop(entries, e->count, &kept, path, err);
  if (!status && kept < e->count) {
    placido_notes_add(notes, "%zu points stand twice with one height: taken once", e->count - kept);
    qsort(entries, kept, sizeof *entries, compare_lines);
    for (size_t i = 0; i < kept; i++) {
      e->heights[i] = entries[i].height;
      e->lines[i] = entries[i].line;
    }
    e->count = kept;
  }
  placido_memory_free(entries);
  return status;
}

/* Turns heights into those that grow towards the camera. */
static void turn_up(placido_elevation *e, enum placido_height_sign sign, placido_notes *notes) {
  bool down = sign == PLACIDO_HEIGHT_DOWN;
  if (sign == PLACIDO_HEIGHT_GUESS && placido_heights_curvature(e->heights, e->count) < 0) {
    placido_notes_add(notes, "the heights are taken for depths, which grow into the eye: else the "
                             "cornea would be hollow");
    down = true;
  }
  for (size_t i = 0; down && i < e->count; i++) {
    e->heights[i].z_mm = -e->heights[i].z_mm;
  }
}

int placido_elevation_load(placido_elevation *elevation, const char *path,
                           const placido_elevation_options *options, placido_notes *notes,
                           placido_error *err) {
  placido_elevation_options o = options ? *options : (placido_elevation_options){0};
  placido_reader reader;
  *elevation = (placido_elevation){
      .maker = {{NAN, NAN}, {NAN, NAN}, NAN, NAN, NAN, ""}};
  o.xy_mm = o.xy_mm > 0 ? o.xy_mm : 1;
  o.z_mm = o.z_mm > 0 ? o.z_mm : 1;
  int status = placido_reader_open(&reader, path, err);
  if (!status) {
    status = placido_cso_recognise(reader.text) ? placido_cso_read(elevation, &reader, err)
                                               : placido_points_read(elevation, &reader, &o, err);
  }
  placido_reader_close(&reader);
  if (!status) {
    status = drop_duplicates(elevation, path, notes, err);
  }
  if (status) {
    placido_elevation_free(elevation);
    return status;
  }
  turn_up(elevation, o.sign, notes);
  return PLACIDO_OK;
}

void placido_elevation_free(placido_elevation *elevation) {
  placido_memory_free(elevation->heights);
  placido_memory_free(elevation->lines);
  placido_memory_free(elevation->ring_x_mm);
  placido_memory_free(elevation->ring_y_mm);
  *elevation = (placido_elevation){0};
}
