/* A tear film that breaks up: patches are laid at random until they cover the wanted share. */
#include "phantom/film.h"

#include "base/random.h"
#include "phantom/streams.h"

#include <math.h>
#include <stdbool.h>

#define GRID 100 /* points a side by which the covered share is counted */

static const double turn = 6.283185307179586;
/* 0.25 µm at a wavelength of 0.3 mm is a slope of 5 mrad, which moves a mire by its own width. */
static const double ripple_mm = 2.5e-4;

static double draw(uint64_t seed, int patch, int which, double low, double high) {
  return placido_random_uniform(seed, PLACIDO_PHANTOM_FILM, (uint64_t)(patch * 16 + which), low,
                                 high);
}

static placido_phantom_patch make_patch(uint64_t seed, int number, double radius_mm) {
  double away = radius_mm * sqrt(draw(seed, number, 0, 0, 1));
  double angle = draw(seed, number, 1, 0, turn);
  placido_phantom_patch patch = {
      .x_mm = away * cos(angle),
      .y_mm = away * sin(angle),
      .radius_mm = draw(seed, number, 2, 0.25, 0.8),
  };
  double heading = draw(seed, number, 3, 0, turn);
  for (int i = 0; i < 2; i++) {
    double wave_number = turn / draw(seed, number, 4 + i, 0.25, 0.45);
    patch.wave[i][0] = wave_number * cos(heading + i * turn / 4);
    patch.wave[i][1] = wave_number * sin(heading + i * turn / 4);
    patch.wave[i][2] = draw(seed, number, 6 + i, 0, turn);
  }
  return patch;
}

static bool is_broken(const placido_phantom_film *film, double x_mm, double y_mm) {
  for (int i = 0; i < film->count; i++) {
    const placido_phantom_patch *patch = &film->patches[i];
    if (hypot(x_mm - patch->x_mm, y_mm - patch->y_mm) < patch->radius_mm) {
      return true;
    }
  }
  return false;
}

static double broken_share(const placido_phantom_film *film, double radius_mm) {
  int points = 0, broken = 0;
  for (int j = 0; j < GRID; j++) {
    for (int i = 0; i < GRID; i++) {
      double x_mm = radius_mm * ((2 * i + 1.0) / GRID - 1);
      double y_mm = radius_mm * ((2 * j + 1.0) / GRID - 1);
      if (hypot(x_mm, y_mm) < radius_mm) {
        points++;
        broken += is_broken(film, x_mm, y_mm);
      }
    }
  }
  return (double)broken / points;
}

void placido_phantom_film_break(placido_phantom_film *film, double broken, double radius_mm,
                                uint64_t seed) {
  film->count = 0;
  while (film->count < PLACIDO_PHANTOM_PATCHES && broken_share(film, radius_mm) < broken) {
    film->patches[film->count] = make_patch(seed, film->count, radius_mm);
    film->count++;
  }
}

/* Gradient of the height w·a·Σ sin(k·p + φ), w = (1 - ρ²)² falling to 0 with its slope at the rim.
 */
static void add_patch(const placido_phantom_patch *patch, double x_mm, double y_mm,
                      double slope[2]) {
  double dx = x_mm - patch->x_mm, dy = y_mm - patch->y_mm;
  double square = 1 / (patch->radius_mm * patch->radius_mm);
  double inside = 1 - (dx * dx + dy * dy) * square;
  if (inside <= 0) {
    return;
  }
  double height = 0, gradient[2] = {0, 0};
  for (int i = 0; i < 2; i++) {
    const double *wave = patch->wave[i];
    double phase = wave[0] * dx + wave[1] * dy + wave[2];
    height += ripple_mm * sin(phase);
    gradient[0] += ripple_mm * wave[0] * cos(phase);
    gradient[1] += ripple_mm * wave[1] * cos(phase);
  }
  double fall = -4 * inside * square * height;
  slope[0] -= inside * inside * gradient[0] + fall * dx;
  slope[1] -= inside * inside * gradient[1] + fall * dy;
}

void placido_phantom_film_add(const placido_phantom_film *film, double x_mm, double y_mm,
                              double slope[2]) {
  for (int i = 0; i < film->count; i++) {
    add_patch(&film->patches[i], x_mm, y_mm, slope);
  }
}
