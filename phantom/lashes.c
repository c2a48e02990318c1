/* Eyelashes: dark curved strokes that taper, hanging from the upper border into the picture. */
#include "base/random.h"
#include "phantom/scene.h"
#include "phantom/streams.h"

#include <math.h>

static const float lash_grey = 14;

/* A quadratic Bézier curve with a width at its root. */
typedef struct lash {
  double root[2], bend[2], tip[2];
  double width_px;
} lash;

/* Sizes are shares of the picture's sides, so that lashes look alike at every resolution. */
static lash make_lash(const placido_image *picture, int number, uint64_t seed) {
  double width = picture->width_px, height = picture->height_px, draw[6];
  for (int i = 0; i < 6; i++) {
    draw[i] =
        placido_random_uniform(seed, PLACIDO_PHANTOM_LASHES, (uint64_t)(number * 8 + i), 0, 1);
  }
  double root = width * (0.18 + 0.64 * draw[0]);
  double length = height * (0.17 + 0.09 * draw[1]);
  double lean = width * 0.16 * (draw[2] - 0.5);
  return (lash){
      .root = {root, -0.01 * height},
      .bend = {root + lean * 0.2 * draw[3], length * (0.4 + 0.3 * draw[4])},
      .tip = {root + lean, length},
      .width_px = height * (0.0045 + 0.0025 * draw[5]),
  };
}

/* Darkens the pixels within radius_px of a point, with a soft rim a pixel wide. */
static void dab(placido_image *picture, const double at[2], double radius_px) {
  float *grey = placido_image_plane(picture, 0);
  int reach = (int)ceil(radius_px + 1);
  int column = (int)lround(at[0]), line = (int)lround(at[1]);
  for (int y = line - reach; y <= line + reach; y++) {
    for (int x = column - reach; x <= column + reach; x++) {
      if (x < 0 || y < 0 || x >= picture->width_px || y >= picture->height_px) {
        continue;
      }
      double cover = radius_px + 0.5 - hypot(x - at[0], y - at[1]);
      cover = cover < 0 ? 0 : cover > 1 ? 1 : cover;
      float *pixel = grey + (size_t)y * (size_t)picture->width_px + x;
      if (*pixel > lash_grey) {
        *pixel += (float)cover * (lash_grey - *pixel);
      }
    }
  }
}

static void draw_lash(placido_image *picture, const lash *stroke) {
  double length = hypot(stroke->tip[0] - stroke->root[0], stroke->tip[1] - stroke->root[1]);
  int dabs = (int)ceil(length) + 1; /* one a pixel */
  for (int i = 0; i <= dabs; i++) {
    double t = (double)i / dabs, at[2];
    for (int k = 0; k < 2; k++) {
      at[k] = (1 - t) * (1 - t) * stroke->root[k] + 2 * t * (1 - t) * stroke->bend[k] +
              t * t * stroke->tip[k];
    }
    dab(picture, at, 0.5 * stroke->width_px * (1 - 0.4 * t));
  }
}

void placido_phantom_lashes_draw(placido_image *picture, int count, uint64_t seed) {
  for (int i = 0; i < count; i++) {
    lash stroke = make_lash(picture, i, seed);
    draw_lash(picture, &stroke);
  }
}
