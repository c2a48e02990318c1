/* Numbers have sensible digits, and what is missing is a dash. */
#include "report/number.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>
#include <float.h>

static void assert_measure(double value, double sigma, const char *expected) {
  char text[PLACIDO_NUMBER_SIZE];
  placido_number_measure(text, sizeof text, value, sigma);
  assert_string_equal(text, expected);
}

static void the_standard_deviation_sets_the_digits(void **state) {
  (void)state;
  assert_measure(43.27123, 0.0213, "43.271 ± 0.021");
  assert_measure(-0.2213, 0.013, "−0.221 ± 0.013");
  assert_measure(172.31, 12, "172 ± 12");
  assert_measure(0.0164366, 0.00012, "0.01644 ± 0.00012");
  assert_measure(0.0636251, 0.000043, "0.06363 ± 0.00004");
  assert_measure(99.9999967, 6.4e-7, "100.00000 ± <0.00001");
}

static void without_one_a_value_has_four_digits(void **state) {
  (void)state;
  assert_measure(43.27123, NAN, "43.27");
  assert_measure(7.8, 0, "7.800");
  assert_measure(12345.6, NAN, "12346");
  assert_measure(0, NAN, "0.000");
}

static void the_missing_is_a_dash(void **state) {
  (void)state;
  assert_measure(NAN, 0.1, "–");
  assert_measure(INFINITY, NAN, "–");
}

static void nothing_is_not_negative(void **state) {
  (void)state;
  char text[PLACIDO_NUMBER_SIZE];
  placido_number_write(text, sizeof text, -0.001, 2);
  assert_string_equal(text, "0.00");
  placido_number_write(text, sizeof text, -0.006, 2);
  assert_string_equal(text, "−0.01");
}

static void a_huge_number_is_cut_not_overrun(void **state) {
  (void)state;
  char text[8];
  placido_number_write(text, sizeof text, DBL_MAX, 9);
  assert_int_equal(text[7], '\0');
}

static void units_are_written_for_people(void **state) {
  (void)state;
  assert_string_equal(placido_unit_text("um"), "µm");
  assert_string_equal(placido_unit_text("deg"), "°");
  assert_string_equal(placido_unit_text("D"), "D");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_standard_deviation_sets_the_digits),
      cmocka_unit_test(without_one_a_value_has_four_digits),
      cmocka_unit_test(the_missing_is_a_dash),
      cmocka_unit_test(nothing_is_not_negative),
      cmocka_unit_test(a_huge_number_is_cut_not_overrun),
      cmocka_unit_test(units_are_written_for_people),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
