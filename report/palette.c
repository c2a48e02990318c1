/* The two colour ramps of the figures, interpolated in CIELAB (CIE 15:2004, D65) between anchors
 * of evenly falling lightness: the form of ColorBrewer's diverging schemes, but with a larger
 * lightness range. */
#include "report/palette.h"

#include <math.h>
#include <stddef.h>

typedef struct lab {
  double l, a, b;
} lab;

/* One anchor every quarter of the ramp; index 0 stands next to the neutral middle. */
static const lab cool[] = {
    {94, -7, -4}, {77, -12, -20}, {60, -8, -36}, {43, 8, -48}, {24, 24, -46}};
static const lab warm[] = {{95, -4, 24}, {79, 14, 58}, {62, 44, 56}, {44, 58, 42}, {23, 38, 22}};
static const lab even[] = {
    {97, -4, 14}, {80, -22, 20}, {61, -26, -4}, {41, -4, -34}, {20, 18, -38}};
static const lab neutral = {97, 0, 2};

/* The widest step from the neutral middle to the first anchor: a tenth of a side, one class of
 * ten. */
static const double tint = 0.1;

static lab blend(lab from, lab to, double share) {
  return (lab){from.l + share * (to.l - from.l), from.a + share * (to.a - from.a),
               from.b + share * (to.b - from.b)};
}

static lab along(const lab anchors[5], double position) {
  double quarters = 4 * fmin(fmax(position, 0), 1);
  int index = quarters >= 4 ? 3 : (int)quarters;
  return blend(anchors[index], anchors[index + 1], quarters - index);
}

/* The inverse of CIELAB's cube root with its linear foot. */
static double unroot(double f) {
  return f > 6.0 / 29 ? f * f * f : 3 * (6.0 / 29) * (6.0 / 29) * (f - 4.0 / 29);
}

/* IEC 61966-2-1, clipped to the gamut. */
static double encode(double linear) {
  double clipped = fmin(fmax(linear, 0), 1);
  return clipped <= 0.0031308 ? 12.92 * clipped : 1.055 * pow(clipped, 1 / 2.4) - 0.055;
}

static placido_rgb to_srgb(lab colour) {
  double f = (colour.l + 16) / 116;
  double x = 0.95047 * unroot(f + colour.a / 500);
  double y = unroot(f);
  double z = 1.08883 * unroot(f - colour.b / 200);
  return (placido_rgb){encode(3.2404542 * x - 1.5371385 * y - 0.4985314 * z),
                       encode(-0.9692660 * x + 1.8760108 * y + 0.0415560 * z),
                       encode(0.0556434 * x - 0.2040259 * y + 1.0572252 * z)};
}

placido_rgb placido_palette_diverging(double position) {
  const lab *side = position < 0 ? cool : warm;
  double distance = fabs(position);
  if (distance < tint) {
    return to_srgb(blend(neutral, side[0], distance / tint));
  }
  return to_srgb(along(side, (distance - tint) / (1 - tint)));
}

placido_rgb placido_palette_sequential(double position) { return to_srgb(along(even, position)); }
