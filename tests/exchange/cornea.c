#include "tests/exchange/cornea.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <setjmp.h>

#include <cmocka.h>

#define RINGS 24
#define MERIDIANS 256

placido_surface *make_cornea(double radius_mm) {
  const placido_part parts[2] = {
      {.kind = PLACIDO_PART_BICONIC,
       .as.biconic = {.r1 = 7.9, .q1 = -0.25, .r2 = 7.7, .q2 = -0.25, .axis_deg = 20}},
      {.kind = PLACIDO_PART_BUMP,
       .as.bump = {
           .height_mm = 0.005, .sigma_x_mm = 1, .sigma_y_mm = 1.2, .x_mm = 0.3, .y_mm = -1}}};
  placido_surface *surface;
  placido_error err;
  assert_int_equal(placido_surface_new(&surface, 0.1, radius_mm, parts, 2, NULL, &err), PLACIDO_OK);
  return surface;
}

static double ring_radius_mm(int ring, int meridian) {
  return 0.2 + 0.2 * ring + 0.002 * ring * sin(meridian * 6.283185307179586 / MERIDIANS);
}

static bool is_left_out(int ring, int meridian, bool gap) {
  return gap && ring > 15 && meridian >= 32 && meridian < 96;
}

/* A number with a decimal comma, as this maker writes it. */
static void put(FILE *file, double value) {
  char text[40];
  snprintf(text, sizeof text, "%.15g", value);
  char *point = strchr(text, '.');
  if (point) {
    *point = ',';
  }
  fprintf(file, "%s\r\n", text);
}

void write_cso(const char *path, const placido_surface *surface, bool gap) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  fprintf(file,
          "Paziente :\r\nEsame :\r\nOcchio : True\r\n-----\r\nSIM-k : \r\nK1 = 42,75 D @ 20\xC2\xB0"
          "\r\nK2 = 43,8 D @ 110\xC2\xB0\r\n-----\r\nDiametro Corneale = 12\r\nPotere Pupillare "
          "Medio = 7,8 D\r\nDato misurato : Elevazioni\r\nN\xC2\xB0 Anelli : %d\r\nN\xC2\xB0 "
          "Semimeridiani : %d\r\n-----\r\n",
          RINGS, MERIDIANS);
  for (int block = 0; block < 2; block++) {
    for (int i = 0; i < RINGS * MERIDIANS; i++) {
      int ring = i / MERIDIANS, meridian = i % MERIDIANS;
      double r = ring_radius_mm(ring, meridian), a = meridian * 6.283185307179586 / MERIDIANS;
      placido_jet jet;
      assert_true(placido_surface_at(surface, r * cos(a), r * sin(a), &jet));
      put(file, is_left_out(ring, meridian, gap) ? -1 : block ? -jet.sag : r);
    }
  }
  assert_int_equal(fclose(file), 0);
}

void write_text(const char *path, const char *text) {
  FILE *file = fopen(path, "w");
  assert_non_null(file);
  assert_true(fputs(text, file) >= 0);
  assert_int_equal(fclose(file), 0);
}
