/* Centre of a system of rings: a vote of the gradients' lines on a coarse grid, then a robust least
 * squares intersection of the lines in a shrinking window. */
#include "reconstruct/mires/centre.h"

#include "base/cv/cv.h"
#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#define INNERMOST 0.3 /* of inner_px: the last window */
#define SPOTS_FEW 30
#define VOTERS 2000
#define LOOKS 90 /* places looked at across a window, at most twice as many */
#define CELL 2    /* a ballot box is so many pixels of the coarse image wide */

/* A place with a strong gradient, and the gradient's direction, of unit length. */
typedef struct spot {
  float x, y, along_x, along_y;
} spot;

typedef struct spots {
  size_t count;
  spot *list;
} spots;

static inline float gradient(const float *p, size_t width, float *gx, float *gy) {
  *gx = p[1] - p[-1];
  *gy = p[width] - p[-(ptrdiff_t)width];
  return sqrtf(*gx * *gx + *gy * *gy);
}

/* The gradients of every `step`-th pixel within `window` of (cx, cy) that are stronger than
 * *least, or where that is 0 than 1.5 times the window's mean, which is put there. */
static int collect(spots *out, const placido_image *image, double cx, double cy, double window,
                   int step, double *least, placido_error *err) {
  int x0 = (int)fmax(1, cx - window), x1 = (int)fmin(image->width_px - 2, cx + window);
  int y0 = (int)fmax(1, cy - window), y1 = (int)fmin(image->height_px - 2, cy + window);
  size_t width = (size_t)image->width_px;
  out->count = 0;
  out->list = NULL;
  if (x1 <= x0 || y1 <= y0) {
    return placido_error_set(err, PLACIDO_QUALITY, "the image is too small to hold mires");
  }
  size_t most = (size_t)((x1 - x0) / step + 1) * (size_t)((y1 - y0) / step + 1);
  out->list = placido_memory_new(most, sizeof *out->list, err);
  if (!out->list) {
    return PLACIDO_MEMORY;
  }
  float gx, gy;
  if (!(*least > 0)) {
    double sum = 0;
    for (int y = y0; y <= y1; y += step) {
      const float *row = image->data + (size_t)y * width;
      for (int x = x0; x <= x1; x += step) {
        sum += (double)gradient(row + x, width, &gx, &gy);
      }
    }
    *least = 1.5 * sum / (double)most;
  }
  float limit = (float)*least;
  for (int y = y0; y <= y1; y += step) {
    const float *row = image->data + (size_t)y * width;
    for (int x = x0; x <= x1; x += step) {
      float size = gradient(row + x, width, &gx, &gy);
      if (size > limit) {
        out->list[out->count++] = (spot){(float)x, (float)y, gx / size, gy / size};
      }
    }
  }
  return PLACIDO_OK;
}

/* The middle of the ballot boxes with the most votes in their 3×3 neighbourhood. */
static void winner(double centre[2], const unsigned *votes, int w, int h) {
  unsigned best = 0;
  for (int y = 1; y < h - 1; y++) {
    for (int x = 1; x < w - 1; x++) {
      unsigned sum = 0;
      for (int j = -1; j <= 1; j++) {
        const unsigned *row = votes + (size_t)(y + j) * (size_t)w + (size_t)x;
        sum += row[-1] + row[0] + row[1];
      }
      if (sum > best) {
        best = sum;
        centre[0] = (x + 0.5) * CELL - 0.5;
        centre[1] = (y + 0.5) * CELL - 0.5;
      }
    }
  }
}

/* Every spot votes for the cells along its line, both ways, as far as `reach`. A spot's vote at
 * distance d stands for a ring of that radius, of which 2πd pixels are seen: dividing by nothing
 * lets outer rings count more, which is what is wanted. */
static int vote(double centre[2], const placido_image *coarse, double reach, placido_error *err) {
  int w = coarse->width_px / CELL + 1, h = coarse->height_px / CELL + 1;
  double side = fmax(coarse->width_px, coarse->height_px);
  spots all;
  unsigned *votes = NULL;
  double least = 0;
  int status = collect(&all, coarse, coarse->width_px / 2.0, coarse->height_px / 2.0, side,
                       side > 4 * LOOKS ? (int)(side / (2 * LOOKS)) : 1, &least, err);
  if (!status && all.count < 50) {
    status = placido_error_set(err, PLACIDO_QUALITY, "no mires: the image has no edges");
  }
  if (!status) {
    votes = placido_memory_new((size_t)w * (size_t)h, sizeof *votes, err);
    status = votes ? PLACIDO_OK : PLACIDO_MEMORY;
  }
  if (!status) {
    size_t stride = all.count / VOTERS + 1;
    for (size_t i = 0; i < all.count; i += stride) {
      spot s = all.list[i];
      for (int d = -(int)reach; d <= (int)reach; d += CELL) {
        float x = s.x + (float)d * s.along_x, y = s.y + (float)d * s.along_y;
        int column = (int)(x + 0.5F) / CELL, line = (int)(y + 0.5F) / CELL;
        if (abs(d) > 2 && x >= 0 && column < w && y >= 0 && line < h) {
          votes[(size_t)line * (size_t)w + (size_t)column]++;
        }
      }
    }
    winner(centre, votes, w, h);
  }
  placido_memory_free(all.list);
  placido_memory_free(votes);
  return status;
}

/* One pass of the robust intersection: the point nearest to the lines, each weighted by
 * 1/(1+(d/scale)²) of its present distance d. */
static void intersect(double centre[2], const spots *all, double scale) {
  double a = 0, b = 0, c = 0, u = 0, v = 0;
  float x = (float)centre[0], y = (float)centre[1], inverse = (float)(1 / (scale * scale));
  for (size_t i = 0; i < all->count; i++) {
    spot s = all->list[i];
    float nx = -s.along_y, ny = s.along_x;
    float d = nx * (s.x - x) + ny * (s.y - y);
    float weight = 1 / (1 + d * d * inverse);
    a += (double)(weight * nx * nx);
    b += (double)(weight * nx * ny);
    c += (double)(weight * ny * ny);
    u += (double)(weight * nx * d);
    v += (double)(weight * ny * d);
  }
  double determinant = a * c - b * b;
  if (determinant > 1e-9 * (a + c) * (a + c)) {
    centre[0] += (c * u - b * v) / determinant;
    centre[1] += (a * v - b * u) / determinant;
  }
}

int placido_mires_centre(double centre_px[2], const placido_image *plane, double radius_px,
                         double inner_px, double narrow_px, placido_error *err) {
  placido_image coarse = {0};
  int factor = (int)fmax(1, floor(narrow_px / 3));
  int status =
      placido_image_new(&coarse, plane->width_px / factor, plane->height_px / factor, 1, err);
  if (!status) {
    status = placido_cv_resize(&coarse, plane, PLACIDO_CV_AREA, err);
  }
  if (!status) {
    status = vote(centre_px, &coarse, radius_px / factor, err);
  }
  placido_image_free(&coarse);
  if (status) {
    return status;
  }
  for (int i = 0; i < 2; i++) {
    centre_px[i] = (centre_px[i] + 0.5) * factor - 0.5;
  }
  double least = 0;
  for (double window = radius_px / 2; window > INNERMOST * inner_px; window /= 1.5) {
    /* The innermost mires of a keratoconic eye run about another point than the outer ones. The
     * last windows end at the dark disc within them, where nothing is as strong as a mire. */
    bool last = window < inner_px;
    least = last ? least : 0;
    spots all;
    status = collect(&all, plane, centre_px[0], centre_px[1], window,
                     window > LOOKS ? (int)(window / LOOKS) + 1 : 1, &least, err);
    if (status) {
      return status;
    }
    bool dark = last && all.count < SPOTS_FEW;
    for (int pass = 0; pass < 4 && !dark; pass++) {
      intersect(centre_px, &all, fmax(1.5, window / (last ? 5 : 20)));
    }
    placido_memory_free(all.list);
    if (dark) {
      break;
    }
  }
  return PLACIDO_OK;
}
