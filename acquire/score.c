/* How well a frame shows mires: slopes that point along the radius, everywhere in the disc.
 *
 * The squared slope is the classical measure of focus (Tenenbaum 1970; Krotkov 1988). Here its
 * tangential part is taken off the radial part: mires have the radial one only, while noise, skin
 * and iris texture have both alike and cancel, and lashes, which run outwards, count against. */
#include "acquire/acquire.h"

#include "base/memory.h"

#include <math.h>

#define SIDE_MIN_PX 16
#define SAMPLES_WANTED 400000.0 /* enough for a stable mean; keeps 1280 × 1024 near 2 ms */
#define INNER_SHARE 0.05        /* of the radius: too near the centre for a direction */

enum { OCTANTS = 8, RINGS = 3, CELLS = OCTANTS * RINGS };

struct cell {
  double energy;
  long samples;
};

/* A plane's samples of one frame, 0..1 of full scale. */
struct plane {
  int width, height;
  float *samples;
  double saturated; /* share of them */
};

static void read_row(float *row, const placido_frame *frame, int y, int channel, float scale) {
  const uint8_t *bytes = frame->data + (size_t)y * frame->stride_bytes;
  if (frame->format == PLACIDO_MONO16) {
    const uint16_t *words = (const uint16_t *)(const void *)bytes;
    for (int x = 0; x < frame->width_px; x++) {
      row[x] = scale * (float)words[x];
    }
    return;
  }
  const size_t pitch = placido_format_bytes(frame->format);
  for (int x = 0; x < frame->width_px; x++) {
    row[x] = scale * (float)bytes[(size_t)x * pitch + (size_t)channel];
  }
}

static void read_plane(struct plane *plane, const placido_frame *frame, int channel) {
  const float scale = 1.0f / (float)((1u << frame->bits) - 1u);
  long saturated = 0;
  for (int y = 0; y < plane->height; y++) {
    float *row = plane->samples + (size_t)y * (size_t)plane->width;
    read_row(row, frame, y, channel, scale);
    for (int x = 0; x < plane->width; x++) {
      saturated += row[x] >= 1.0f;
    }
  }
  plane->saturated = (double)saturated / ((double)plane->width * plane->height);
}

/* Octant by signs and the larger coordinate: no arc tangent for every sample. */
static int octant_of(double dx, double dy) {
  return (dx < 0.0) | ((dy < 0.0) << 1) | ((fabs(dx) < fabs(dy)) << 2);
}

/* Radial less tangential squared slope at one sample, into the cell where it lies. */
static void add_sample(struct cell cells[CELLS], const struct plane *plane, int x, int y,
                       double radius) {
  const double dx = x - 0.5 * (plane->width - 1), dy = y - 0.5 * (plane->height - 1);
  const double share = (dx * dx + dy * dy) / (radius * radius);
  if (share >= 1.0 || share < INNER_SHARE * INNER_SHARE) {
    return;
  }
  const float *here = plane->samples + (size_t)y * (size_t)plane->width + x;
  const double gx = 0.5 * (here[1] - here[-1]);
  const double gy = 0.5 * (here[plane->width] - here[-plane->width]);
  const double radial = gx * dx + gy * dy, tangential = gx * dy - gy * dx;
  struct cell *cell = &cells[octant_of(dx, dy) * RINGS + (int)(share * RINGS)];
  cell->energy += (radial * radial - tangential * tangential) / (share * radius * radius);
  cell->samples++;
}

static double score_plane(const struct plane *plane) {
  struct cell cells[CELLS] = {{0.0, 0}};
  const double area = (double)plane->width * plane->height;
  const int step = (int)fmax(1.0, ceil(sqrt(area / SAMPLES_WANTED)));
  const double radius = 0.5 * fmin(plane->width, plane->height);
  for (int y = 1; y < plane->height - 1; y += step) {
    for (int x = 1; x < plane->width - 1; x += step) {
      add_sample(cells, plane, x, y, radius);
    }
  }
  double sum = 0.0;
  for (int i = 0; i < CELLS; i++) {
    if (cells[i].samples > 0) {
      sum += sqrt(fmax(0.0, cells[i].energy / (double)cells[i].samples));
    }
  }
  return sum / CELLS * (1.0 - plane->saturated);
}

int placido_frame_score(double *score, const placido_frame *frame, placido_error *err) {
  *score = 0.0;
  if (frame->width_px < SIDE_MIN_PX || frame->height_px < SIDE_MIN_PX) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "a frame of %d × %d pixels is too small to hold mires",
                             frame->width_px, frame->height_px);
  }
  struct plane plane = {.width = frame->width_px, .height = frame->height_px};
  plane.samples =
      placido_memory_new((size_t)plane.width * (size_t)plane.height, sizeof(float), err);
  if (!plane.samples) {
    return PLACIDO_MEMORY;
  }
  const int channels = frame->format == PLACIDO_RGB8 ? 3 : 1;
  for (int channel = 0; channel < channels; channel++) {
    read_plane(&plane, frame, channel);
    *score = fmax(*score, score_plane(&plane));
  }
  placido_memory_free(plane.samples);
  return PLACIDO_OK;
}
