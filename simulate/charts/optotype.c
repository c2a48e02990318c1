/* Single optotypes: which shape, how large, turned how far.
 *
 * E (Snellen) and Landolt C (ISO 8596) are five strokes high and wide, with gaps of one stroke. */
#include "simulate/charts/optotype.h"

#include "simulate/charts/sloan.h"

static void outline_e(placido_outline *outline, int which) {
  static const placido_corner corners[] = {
    {-2.5, -2.5}, {2.5, -2.5}, {2.5, -1.5}, {-1.5, -1.5}, {-1.5, -0.5}, {2.5, -0.5},
    {2.5, 0.5},   {-1.5, 0.5}, {-1.5, 1.5}, {2.5, 1.5},   {2.5, 2.5},   {-2.5, 2.5}};
  (void)which;
  placido_outline_polygon(outline, corners, 12);
}

static void outline_landolt(placido_outline *outline, int which) {
  (void)which;
  placido_ring_outline(outline, true);
}

static const struct {
  int count, eighths; /* of a turn from one to the next */
  void (*outline)(placido_outline *outline, int which);
  const char *names[PLACIDO_SLOAN_LETTERS];
} kinds[] = {
  [PLACIDO_OPTOTYPE_E] = {4, 2, outline_e, {"right", "up", "left", "down"}},
  [PLACIDO_OPTOTYPE_LANDOLT] = {8, 1, outline_landolt,
                                {"right", "up right", "up", "up left", "left", "down left", "down",
                                 "down right"}},
  [PLACIDO_OPTOTYPE_SLOAN] = {PLACIDO_SLOAN_LETTERS, 0, placido_sloan_outline,
                              {"C", "D", "H", "K", "N", "O", "R", "S", "V", "Z"}},
};

static int wrap(enum placido_optotype kind, int which) {
  int count = kinds[kind].count;
  return (which % count + count) % count;
}

int placido_optotype_count(enum placido_optotype kind) {
  return kinds[kind].count;
}

const char *placido_optotype_name(enum placido_optotype kind, int which) {
  return kinds[kind].names[wrap(kind, which)];
}

void placido_optotype_draw(placido_image *image, enum placido_optotype kind, int which,
                           double size_arcmin, double x_arcmin, double y_arcmin,
                           double arcmin_per_px) {
  int one = wrap(kind, which);
  placido_outline outline =
    placido_outline_new(x_arcmin / arcmin_per_px, y_arcmin / arcmin_per_px,
                        size_arcmin / 5 / arcmin_per_px, one * kinds[kind].eighths);
  kinds[kind].outline(&outline, one);
  placido_outline_blacken(image, &outline);
}
