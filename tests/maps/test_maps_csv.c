/* maps.csv: a row per grid point within the radius, numbers that read back bit for bit, empty
 * cells. */
#include "tests/maps/eyes.h"
#include "tests/support/near.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COLUMNS 12

static char directory[] = "/tmp/placido-maps-XXXXXX";
static char file_path[sizeof directory + 32];

static int make_directory(void **state) {
  (void)state;
  if (!mkdtemp(directory)) {
    return -1;
  }
  snprintf(file_path, sizeof file_path, "%s/maps.csv", directory);
  return 0;
}

static int remove_directory(void **state) {
  (void)state;
  unlink(file_path);
  return rmdir(directory);
}

/* The line's cells, cut in place. */
static int split(char *line, char *cells[COLUMNS + 1]) {
  int count = 0;
  line[strcspn(line, "\n")] = '\0';
  for (char *cell = line; cell && count <= COLUMNS; count++) {
    cells[count] = cell;
    cell = strchr(cell, ',');
    if (cell) {
      *cell++ = '\0';
    }
  }
  return count;
}

static FILE *save(const placido_maps *maps) {
  char header[256];
  assert_int_equal(placido_maps_save(maps, file_path, NULL), PLACIDO_OK);
  FILE *file = fopen(file_path, "r");
  assert_non_null(file);
  assert_non_null(fgets(header, sizeof header, file));
  assert_string_equal(header, "x_mm,y_mm,valid,z_mm,elevation_um,axial_D,tangential_D,mean_D,"
                              "gaussian_mm2,refractive_D,sigma_z_um,sigma_axial_D\n");
  return file;
}

static void numbers_read_back_bit_for_bit(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.7, -0.3, 0.2, 0.1);
  placido_maps maps = maps_of(surface);
  FILE *file = save(&maps);
  char line[512], *cells[COLUMNS + 1];
  int rows = 0;
  while (fgets(line, sizeof line, file)) {
    assert_int_equal(split(line, cells), COLUMNS);
    double x = strtod(cells[0], NULL), y = strtod(cells[1], NULL);
    int i = maps.half + (int)lround(x * 10), j = maps.half + (int)lround(y * 10);
    int index = j * maps.size + i;
    assert_true(strlen(cells[0]) <= 4 && strlen(cells[1]) <= 4); /* 0.3, not 0.30000000000000004 */
    assert_true(x == placido_maps_position(&maps, i) && y == placido_maps_position(&maps, j));
    assert_string_equal(cells[2], "1");
    assert_true(strtod(cells[3], NULL) == maps.z_mm[index]);
    for (int k = 0; k < 6; k++) {
      assert_true(strtod(cells[4 + k], NULL) == maps.values[k][index]);
    }
    assert_string_equal(cells[10], ""); /* no fit, no error bars */
    assert_string_equal(cells[11], "");
    rows++;
  }
  assert_int_equal(rows, 6361);
  fclose(file);
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

static void what_is_not_valid_is_empty(void **state) {
  (void)state;
  const unsigned char left[19] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
  placido_surface *surface = partly_covered_eye(7.8, left);
  placido_maps maps = maps_of(surface);
  FILE *file = save(&maps);
  char line[512], *cells[COLUMNS + 1];
  int rows = 0, empty = 0;
  while (fgets(line, sizeof line, file)) {
    assert_int_equal(split(line, cells), COLUMNS);
    bool supported = strtod(cells[0], NULL) < 0.25;
    assert_string_equal(cells[2], supported ? "1" : "0");
    for (int k = 3; k < 10; k++) {
      assert_true((cells[k][0] != '\0') == supported);
    }
    rows++;
    empty += !supported;
  }
  assert_int_equal(rows, 6361);
  assert_in_range(empty, 2900, 3100);
  fclose(file);
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

static void a_place_that_cannot_be_written_is_refused(void **state) {
  (void)state;
  placido_surface *surface = conicoid_eye(7.8, 0, 0, 0);
  placido_maps maps = maps_of(surface);
  placido_error err = {0};
  assert_int_equal(placido_maps_save(&maps, "/tmp/placido-no-such-directory/maps.csv", &err),
                   PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "maps.csv"));
  placido_maps_free(&maps);
  placido_surface_free(surface);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(numbers_read_back_bit_for_bit),
      cmocka_unit_test(what_is_not_valid_is_empty),
      cmocka_unit_test(a_place_that_cannot_be_written_is_refused),
  };
  return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
