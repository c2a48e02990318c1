/* Area coverage of a shape: along every row, each piece of an edge within one pixel adds its height
 * times what lies to its right (Green's theorem), and sums from the left are the coverage.
 *
 * A piece of an arc is its chord and the segment of the circle between, r²/2 (a - sin a). */
#include "simulate/charts/outline.h"

#include <math.h>
#include <stdbool.h>

#define CHUNK_PX 1024

/* Differences of the coverage between neighbours, for some columns of one row. */
typedef struct chunk {
  int row, first, count;
  double steps[CHUNK_PX + 1];
} chunk;

static double other_leg(double radius, double leg) {
  return sqrt(fmax(radius * radius - leg * leg, 0));
}

static double x_at(const placido_edge *edge, double y) {
  if (edge->radius > 0) {
    return edge->centre.x + edge->side_x * other_leg(edge->radius, y - edge->centre.y);
  }
  double share = (y - edge->from.y) / (edge->to.y - edge->from.y);
  return edge->from.x + share * (edge->to.x - edge->from.x);
}

static double y_at(const placido_edge *edge, double x) {
  if (edge->radius > 0) {
    return edge->centre.y + edge->side_y * other_leg(edge->radius, x - edge->centre.x);
  }
  double share = (x - edge->from.x) / (edge->to.x - edge->from.x);
  return edge->from.y + share * (edge->to.y - edge->from.y);
}

/* The area between an arc and its chord. */
static double bulge(double radius, double chord) {
  double angle = 2 * asin(fmin(chord / (2 * radius), 1));
  double excess = angle < 0.05 ? angle * angle * angle / 6 * (1 - angle * angle / 20)
                               : angle - sin(angle);
  return radius * radius / 2 * excess;
}

/* A piece within one column, from upper to lower. */
static void add_piece(chunk *work, const placido_edge *edge, placido_corner upper,
                      placido_corner lower, double sign) {
  double middle = (upper.x + lower.x) / 2, height = lower.y - upper.y;
  double at = floor(middle) - work->first;
  if (at >= work->count || height <= 0) {
    return;
  }
  if (at < 0) {
    work->steps[0] += sign * height;
    return;
  }
  double right = (work->first + at + 1 - middle) * height;
  if (edge->radius > 0) {
    right -= edge->side_x * bulge(edge->radius, hypot(lower.x - upper.x, height));
  }
  work->steps[(int)at] += sign * right;
  work->steps[(int)at + 1] += sign * (height - right);
}

/* The part of an edge within the chunk's row, column by column. */
static void add_edge(chunk *work, const placido_edge *edge) {
  bool down = edge->to.y > edge->from.y;
  placido_corner top = down ? edge->from : edge->to, bottom = down ? edge->to : edge->from;
  if (top.y >= work->row + 1 || bottom.y <= work->row) {
    return;
  }
  if (top.y < work->row) {
    top = (placido_corner){x_at(edge, work->row), work->row};
  }
  if (bottom.y > work->row + 1) {
    bottom = (placido_corner){x_at(edge, work->row + 1), work->row + 1};
  }
  double sign = down ? 1 : -1, way = bottom.x > top.x ? 1 : -1;
  double low = fmax(fmin(top.x, bottom.x), work->first - 1.0);
  double high = fmin(fmax(top.x, bottom.x), work->first + work->count + 1.0);
  double border = way > 0 ? floor(low) + 1 : ceil(high) - 1;
  for (; way > 0 ? border < high : border > low; border += way) {
    placido_corner next = {border, fmin(fmax(y_at(edge, border), top.y), bottom.y)};
    add_piece(work, edge, top, next, sign);
    top = next;
  }
  add_piece(work, edge, top, bottom, sign);
}

/* The pixels that a shape reaches within a picture. */
typedef struct extent {
  int left, top, right, bottom; /* the last two exclusive */
} extent;

static extent find_extent(const placido_outline *outline, const placido_image *image) {
  double left = INFINITY, top = INFINITY, right = -INFINITY, bottom = -INFINITY;
  for (int i = 0; i < outline->count; i++) {
    const placido_corner ends[2] = {outline->edges[i].from, outline->edges[i].to};
    for (int k = 0; k < 2; k++) {
      left = fmin(left, ends[k].x);
      right = fmax(right, ends[k].x);
      top = fmin(top, ends[k].y);
      bottom = fmax(bottom, ends[k].y);
    }
  }
  return (extent){.left = (int)fmin(fmax(floor(left), 0), image->width_px),
                  .top = (int)fmin(fmax(floor(top), 0), image->height_px),
                  .right = (int)fmax(fmin(ceil(right), image->width_px), 0),
                  .bottom = (int)fmax(fmin(ceil(bottom), image->height_px), 0)};
}

/* Lays `colour` over the pixels of a chunk, NULL: takes the coverage away. */
static void paint(placido_image *image, const chunk *work, const float *colour) {
  size_t start = (size_t)work->row * (size_t)image->width_px + (size_t)work->first;
  int planes = image->planes < 4 ? image->planes : 3;
  double sum = 0;
  for (int i = 0; i < work->count; i++) {
    sum += work->steps[i];
    float share = (float)fmin(fabs(sum), 1);
    for (int plane = 0; plane < planes; plane++) {
      float *pixel = placido_image_plane(image, plane) + start + i;
      *pixel = colour != NULL ? *pixel + share * (colour[plane] - *pixel)
                              : fmaxf(*pixel - share, 0);
    }
  }
}

static void cover(placido_image *image, const placido_outline *outline, const float *colour) {
  extent reach = find_extent(outline, image);
  for (int row = reach.top; row < reach.bottom; row++) {
    for (int first = reach.left; first < reach.right; first += CHUNK_PX) {
      chunk work = {.row = row, .first = first, .count = reach.right - first};
      work.count = work.count < CHUNK_PX ? work.count : CHUNK_PX;
      for (int i = 0; i < outline->count; i++) {
        add_edge(&work, &outline->edges[i]);
      }
      paint(image, &work, colour);
    }
  }
}

void placido_outline_blacken(placido_image *image, const placido_outline *outline) {
  cover(image, outline, NULL);
}

void placido_outline_fill(placido_image *image, const placido_outline *outline,
                          const float *colour) {
  cover(image, outline, colour);
}
