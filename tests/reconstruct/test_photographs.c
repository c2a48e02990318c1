/* Photographs of real eyes, where they are there: they are others' and not part of the project. */
#include "tests/support/near.h"

#include <placido/image.h>
#include <placido/reconstruct.h>
#include <stdio.h>
#include <unistd.h>

/* Radius at which the middle of a mire is seen straight below the centre, counted by eye on the
 * enlarged pictures: the first, the seventh and the eleventh of the 13 bright mires. */
static const struct {
  const char *name;
  double below_px[3];
} photographs[] = {
    {"kc_left", {26, 148, 262}},
    {"nokc_left", {28, 199, 328}},
    {"nokc_eye_1", {15, 94, 156}},
};
static const int counted[3] = {0, 6, 10};

static double seen_below(const placido_mires *mires, int edge) {
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *p = &mires->points[i];
    if (p->edge == edge && fabs(p->meridian_deg - 270) < 15) {
      sum += hypot(p->u_px - mires->centre_u_px, p->v_px - mires->centre_v_px);
      count++;
    }
  }
  return count ? sum / count : NAN;
}

/* Share of the lower half's meridians, seams at 3 and 9 o'clock left out, on which an edge is
 * numbered. */
static double share_below(const placido_mires *mires, int edge) {
  int count = 0, possible = 0;
  for (int m = 0; m < mires->meridian_count; m++) {
    double deg = 360.0 * m / mires->meridian_count;
    possible += deg > 195 && deg < 345;
  }
  for (size_t i = 0; i < mires->count; i++) {
    const placido_mire_point *p = &mires->points[i];
    count += p->edge == edge && p->meridian_deg > 195 && p->meridian_deg < 345;
  }
  return (double)count / possible;
}

static void real_mires_are_numbered_rightly(void **state) {
  (void)state;
  if (access(PLACIDO_SHARED "/real/smartkc", R_OK) != 0) {
    skip();
  }
  for (size_t i = 0; i < sizeof photographs / sizeof photographs[0]; i++) {
    char path[1024];
    placido_instrument instrument;
    placido_frame frame = {0};
    placido_mires mires;
    placido_error err = {0};
    snprintf(path, sizeof path, "%s/real/smartkc/%s.instrument.json", PLACIDO_SHARED,
             photographs[i].name);
    assert_int_equal(placido_instrument_load(&instrument, path, NULL, &err), PLACIDO_OK);
    snprintf(path, sizeof path, "%s/real/smartkc/%s.jpg", PLACIDO_SHARED, photographs[i].name);
    assert_int_equal(placido_frame_load(&frame, path, &err), PLACIDO_OK);
    placido_mires_options options = {.threads = 2};
    assert_int_equal(placido_mires_find(&mires, &frame, &instrument, &options, NULL, &err),
                     PLACIDO_OK);
    print_message("%s: %.1f %% found, centre %.1f %.1f\n", photographs[i].name,
                  100 * mires.coverage, mires.centre_u_px, mires.centre_v_px);
    for (int k = 0; k < 3; k++) {
      double middle =
          (seen_below(&mires, 2 * counted[k]) + seen_below(&mires, 2 * counted[k] + 1)) / 2;
      /* a third of the distance to the next mire cannot be another mire */
      assert_near(middle, photographs[i].below_px[k], i == 2 ? 4 : 9);
    }
    for (int edge = 2; edge < 22; edge++) {
      assert_true(share_below(&mires, edge) > 0.5);
    }
    placido_mires_free(&mires);
    placido_frame_free(&frame);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(real_mires_are_numbered_rightly)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
