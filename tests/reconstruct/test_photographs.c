/* Photographs of real eyes, where they are there: they are others' and not part of the project.
 * What they show was read off the unrolled pictures without this software, and looked over by eye.
 */
#include "tests/support/near.h"

#include <placido/image.h>
#include <placido/mires.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MIRES 13
#define SECTORS 24 /* of 15 degrees */

/* What a person sees in a photograph, about a centre set by hand. */
typedef struct sight {
  const char *name;
  double centre_px[2];
  double recall;                    /* share of what is seen that must be numbered */
  double radius_px[MIRES][SECTORS]; /* of the bright mires' middle */
  double seen[MIRES][SECTORS];      /* share of its two edges that is seen */
} sight;

static void load_sight(sight *out) {
  FILE *file = fopen(PLACIDO_TEST_DATA "/photographs.csv", "r");
  assert_non_null(file);
  char line[256];
  int count = 0;
  while (fgets(line, sizeof line, file)) {
    char name[64];
    int mire, deg;
    double radius_px, seen;
    if (sscanf(line, "%63[^,],%d,%d,%lf,%lf", name, &mire, &deg, &radius_px, &seen) == 5 &&
        strcmp(name, out->name) == 0) {
      out->radius_px[mire - 1][deg * SECTORS / 360] = radius_px;
      out->seen[mire - 1][deg * SECTORS / 360] = seen;
      count++;
    }
  }
  fclose(file);
  assert_int_equal(count, MIRES * SECTORS);
}

/* The middle of a mire along a meridian, between the sectors by linear interpolation. */
static double middle_at(const sight *s, int mire, double deg) {
  double at = deg * SECTORS / 360;
  int left = (int)at % SECTORS, right = (left + 1) % SECTORS;
  double share = at - floor(at);
  return (1 - share) * s->radius_px[mire][left] + share * s->radius_px[mire][right];
}

/* How many periods from the middle of its own mire a point lies; `deg` receives its meridian. */
static double periods_off(const sight *s, const placido_mire_point *p, double *deg) {
  double x = p->u_px - s->centre_px[0], y = s->centre_px[1] - p->v_px;
  *deg = fmod(atan2(y, x) * 180 / M_PI + 360, 360);
  int mire = p->edge / 2, inner = mire > 0 ? mire - 1 : 0;
  double period = middle_at(s, inner + 1, *deg) - middle_at(s, inner, *deg);
  return fabs(hypot(x, y) - middle_at(s, mire, *deg)) / period;
}

static void check(sight *s) {
  char path[1024];
  placido_instrument instrument;
  placido_frame frame = {0};
  placido_mires mires;
  placido_error err = {0};
  load_sight(s);
  snprintf(path, sizeof path, "%s/real/smartkc/%s.instrument.json", PLACIDO_SHARED, s->name);
  assert_int_equal(placido_instrument_load(&instrument, path, NULL, &err), PLACIDO_OK);
  snprintf(path, sizeof path, "%s/real/smartkc/%s.jpg", PLACIDO_SHARED, s->name);
  assert_int_equal(placido_frame_load(&frame, path, &err), PLACIDO_OK);
  assert_int_equal(placido_mires_find(&mires, &frame, &instrument, NULL, NULL, &err), PLACIDO_OK);
  static double found[MIRES][SECTORS];
  memset(found, 0, sizeof found);
  size_t wrong = 0, unseen = 0, count = mires.count + mires.doubtful_count;
  for (size_t i = 0; i < count; i++) {
    const placido_mire_point *p =
        i < mires.count ? &mires.points[i] : &mires.doubtful[i - mires.count];
    double deg, off = periods_off(s, p, &deg);
    int sector = (int)floor(deg * SECTORS / 360 + 0.5) % SECTORS;
    found[p->edge / 2][sector] += 1.0 / (2 * 360 / SECTORS);
    bool seen = s->seen[p->edge / 2][sector] > 0;
    unseen += !seen;
    /* half a mire's width off its middle is its edge; the next mire is a whole period away */
    wrong += seen && off > 0.6;
  }
  double share = 0, possible = 0;
  for (int i = 0; i < MIRES; i++) {
    for (int k = 0; k < SECTORS; k++) {
      share += fmin(found[i][k], s->seen[i][k]);
      possible += s->seen[i][k];
    }
  }
  print_message("%s: %.1f %% of what is seen, %zu wrong, %zu where nothing is seen, %zu in all\n",
                s->name, 100 * share / possible, wrong, unseen, count);
  assert_true(share >= s->recall * possible);
  assert_int_equal(wrong, 0);
  /* a lid's shine in the place of a hidden mire cannot be told from one by its place */
  assert_true((double)unseen <= 0.02 * (double)count);
  placido_mires_free(&mires);
  placido_frame_free(&frame);
}

static void what_a_person_sees_is_numbered(void **state) {
  (void)state;
  if (access(PLACIDO_SHARED "/real/smartkc", R_OK) != 0) {
    skip();
  }
  static sight sights[] = {
      {.name = "kc_left", .centre_px = {1543, 1999}, .recall = 0.97},
      {.name = "nokc_left", .centre_px = {1536, 2027}, .recall = 0.96},
      {.name = "nokc_eye_1", .centre_px = {1531, 1924}, .recall = 0.97},
  };
  for (size_t i = 0; i < sizeof sights / sizeof sights[0]; i++) {
    check(&sights[i]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_a_person_sees_is_numbered)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
