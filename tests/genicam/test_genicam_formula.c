/* Formulas give what GenApi says, or say why not. */
#include "tests/genicam/memory_port.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What formulas of these tests may name. */
#define VARIABLES                                                                                  \
  "<pVariable Name=\"A\">Seven</pVariable><pVariable Name=\"B\">MinusTwo</pVariable>"             \
  "<pVariable Name=\"F\">Half</pVariable><pVariable Name=\"GAIN.Max\">Gain</pVariable>"           \
  "<pVariable Name=\"G\">Gain</pVariable><pVariable Name=\"P.Entry.Mono12\">Format</pVariable>"   \
  "<pVariable Name=\"P\">Format</pVariable><pVariable Name=\"GONE\">Nowhere</pVariable>"           \
  "<Constant Name=\"K\">12</Constant><Constant Name=\"E\">100</Constant>"                          \
  "<Constant Name=\"BAD\">twelve</Constant>"                                                       \
  "<Expression Name=\"X\">A + K</Expression><Expression Name=\"LOOP\">LOOP + 1</Expression>"
#define NODES                                                                                      \
  "<Integer Name=\"Seven\"><Value>7</Value></Integer>"                                             \
  "<Integer Name=\"MinusTwo\"><Value>-2</Value></Integer>"                                         \
  "<Float Name=\"Half\"><Value>0.5</Value></Float>"                                                \
  "<Integer Name=\"Gain\"><Value>10</Value><Min>-4</Min><Max>96</Max><Inc>2</Inc></Integer>"      \
  "<Enumeration Name=\"Format\"><EnumEntry Name=\"Mono8\"><Value>8</Value></EnumEntry>"           \
  "<EnumEntry Name=\"Mono12\"><Value>12</Value></EnumEntry><Value>8</Value></Enumeration>"

static void open_formula(struct memory *memory, const char *kind, const char *formula) {
  const size_t size = strlen(formula) + 8192;
  char *nodes = malloc(size);
  assert_non_null(nodes);
  snprintf(nodes, size,
           "<%s Name=\"Knife\">" VARIABLES "<Formula><![CDATA[%s]]></Formula></%s>" NODES, kind,
           formula, kind);
  memory_open_nodes(memory, nodes);
  free(nodes);
}

static void integers_are_exact(void **state) {
  (void)state;
  static const struct {
    const char *formula;
    int64_t value;
  } cases[] = {
      {"1 + 2 * 3", 7},
      {"(1 + 2) * 3", 9},
      {"10 - 4 - 3", 3},
      {"2 ** 3 ** 2", 512},
      {"(2 ** 3) ** 2", 64},
      {"7 / 2", 3},
      {"-7 / 2", -3},
      {"7 % 3", 1},
      {"-7 % 3", -1},
      {"0xFF & 0x0F | 0xF0", 0xFF},
      {"6 ^ 3", 5},
      {"~0", -1},
      {"~(A ^ 3) + 0", ~(7 ^ 3)},
      {"1 << 4 + 1", 32},
      {"-16 >> 2", -4},
      {"1 << 63", INT64_MIN},
      {"A = 7", 1},
      {"A <> 7", 0},
      {"A == 7 && B != 7", 1},
      {"3 < 4", 1},
      {"4 <= 3", 0},
      {"4 >= 4", 1},
      {"B > 0", 0},
      {"1 || 0 && 0", 1},
      {"2 && 4", 1},
      {"A = 7 ? 10 : 20", 10},
      {"A = 6 ? 10 : A = 7 ? 30 : 20", 30},
      {"A = 6 ? 10 : A = 8 ? 30 : 20", 20},
      {"1 ? 0 ? 1 : 2 : 3", 2},
      {"A = 0 ? 1 / 0 : 5", 5}, /* what is not chosen is not evaluated */
      {"A = 7 ? 5 : 1 / 0", 5},
      {"A = 6 ? GONE : 5", 5},
      {"0 && 1 / 0", 0},
      {"1 || 1 / 0", 1},
      {"9223372036854775807 + 1", INT64_MIN},
      {"0 - 9223372036854775807 - 2", INT64_MAX},
      {"4611686018427387904 * 2", INT64_MIN},
      {"(1 << 63) / -1", INT64_MIN},
      {"(1 << 63) % -1", 0},
      {"-(1 << 63)", INT64_MIN},
      {"3 ** 40", -6289078614652622815}, /* 12157665459056928801 less 2^64 */
      {"0 ** 0", 1},
      {"0xFFFFFFFFFFFFFFFF", -1},
      {"010", 10},
      {"1.0 + 1e2", 101},
      {"NEG(A) + abs(B) * Sgn(B)", -9},
      {"ROUND(A) + trunc(A) + FLOOR(A) + CEIL(A)", 28},
      {"- - -A", -7},
      {"A--B", 5},
      {"+A", 7},
      {"GAIN.Max - G.Min", 100},
      {"G.Inc + G.Value", 12},
      {"P.Entry.Mono12 + P.Entry.Mono8 + P", 28},
      {"K + X", 31},
      {"F + F", 2}, /* a half is rounded to one when an integer formula takes it */
      {"E", 100},   /* the constant of the node, before Euler's number */
      {"\n\t A\n", 7},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    open_formula(&memory, "IntSwissKnife", cases[i].formula);
    const int64_t value = integer_of(&memory, "Knife");
    if (value != cases[i].value) {
      fail_msg("%s is %lld", cases[i].formula, (long long)value);
    }
    memory_close(&memory);
  }
}

static void reals_are_doubles(void **state) {
  (void)state;
  static const struct {
    const char *formula;
    double value;
  } cases[] = {
      {"7 / 2", 3.5},
      {"1 / 4 + F", 0.75},
      {"7.5 % 2", 1.5},
      {"2 ** 0.5", 1.4142135623730951},
      {"-2 ** 2", 4}, /* a sign holds tighter than any operator */
      {"SQRT(16) + EXP(0) + LN(1) + LG(1000)", 8},
      {"TRUNC(-1.5) + ROUND(2.5) + FLOOR(-0.5) + CEIL(0.5)", 2},
      {"ROUND(2.345, 2)", 2.35},
      {"frac(1.25)", 0.25},
      {"SGN(-3) * NEG(ABS(-2))", 2},
      {"SIN(0) + COS(0) + TAN(0)", 1},
      {"ASIN(1) + ACOS(0) + 2 * ATAN(1) - 1.5 * PI", 0},
      {"LN(e()) + PI() - PI", 1},
      {"1 << 3 | 1", 9},
      {"~6", -7},
      {".5e1", 5},
      {"1e3", 1000},
      {"F ? 1 : 2", 1}, /* a half is not zero */
      {"F = 0.5 && F <> 0", 1},
      {"X / K", 19. / 12},
      {"0.1 + 0.2 > 0.3", 1},
      {"1e300 * 1e300", INFINITY},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    open_formula(&memory, "SwissKnife", cases[i].formula);
    const double value = float_of(&memory, "Knife");
    /* Functions of the C library may be off by their last bit. */
    if (value != cases[i].value && !(fabs(value - cases[i].value) < 1e-15)) {
      fail_msg("%s is %.17g", cases[i].formula, value);
    }
    memory_close(&memory);
  }
}

static void what_is_no_formula_is_told(void **state) {
  (void)state;
  static const struct {
    const char *kind, *formula, *said;
  } cases[] = {
      {"IntSwissKnife", "A / (B + 2)", "divides by zero"},
      {"IntSwissKnife", "A % 0", "divides by zero"},
      {"IntSwissKnife", "1 << 64", "shifts by"},
      {"IntSwissKnife", "1 >> B", "shifts by"},
      {"IntSwissKnife", "2 ** B", "negative power"},
      {"IntSwissKnife", "1.5", "fraction"},
      {"IntSwissKnife", "1e40", "does not fit"},
      {"IntSwissKnife", "SIN(1)", "cannot have it"},
      {"IntSwissKnife", "PI", "cannot have it"},
      {"SwissKnife", "SQRT(-1)", "no number"},
      {"SwissKnife", "1e30 & 1", "64 bits"},
      {"SwissKnife", "", "was expected"},
      {"SwissKnife", "1 +", "was expected"},
      {"SwissKnife", "1 2", "operator was expected"},
      {"SwissKnife", "(1", "not closed"},
      {"SwissKnife", "1)", "operator was expected"},
      {"SwissKnife", "1 ? 2", "':' was expected"},
      {"SwissKnife", "1 : 2", "operator was expected"},
      {"SwissKnife", "WRONG", "no such function or variable"},
      {"SwissKnife", "a", "no such function or variable"}, /* case counts */
      {"SwissKnife", "SIN()", "brackets"},
      {"SwissKnife", "SIN(1, 2)", "brackets"},
      {"SwissKnife", "SIN(1, 2, 3)", "many numbers"},
      {"SwissKnife", "SIN(1", "not closed"},
      {"SwissKnife", "FOO(1)", "no such function"},
      {"SwissKnife", "0x", "no number"},
      {"SwissKnife", "1.2.3", "no number"},
      {"SwissKnife", "$", "was expected"},
      {"SwissKnife", "GONE", "Nowhere, which is not there"},
      {"SwissKnife", "BAD", "\"twelve\" is no number"},
      {"SwissKnife", "LOOP", "too deep"},
      {"SwissKnife", "G.Visibility", ".Visibility"},
      {"SwissKnife", "P.Entry.Mono16", "no entry Mono16"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    double value;
    open_formula(&memory, cases[i].kind, cases[i].formula);
    if (placido_genicam_get_float(memory.features, "Knife", &value, &memory.err) !=
        PLACIDO_INPUT) {
      fail_msg("%s is %g", cases[i].formula, value);
    }
    assert_says(&memory, cases[i].said);
    memory_close(&memory);
  }
}

/* A table of 128 values written as conditions within conditions is a real formula. */
static void conditions_nest_as_deep_as_real_ones(void **state) {
  (void)state;
  char formula[8192];
  size_t length = 0;
  for (int i = 0; i < 128; i++) {
    length += (size_t)snprintf(formula + length, sizeof formula - length, "((A = %d) ? %d.5 : ",
                               i - 120, i);
  }
  length += (size_t)snprintf(formula + length, sizeof formula - length, "(-1.0)");
  memset(formula + length, ')', 128);
  formula[length + 128] = '\0';
  struct memory memory;
  open_formula(&memory, "SwissKnife", formula);
  assert_true(float_of(&memory, "Knife") == 127.5);
  memory_close(&memory);
}

static void brackets_signs_and_powers_end(void **state) {
  (void)state;
  static const char *const repeated[] = {"(", "-", "~", "2**", "1?", "1?1:", "ABS("};
  for (size_t i = 0; i < sizeof repeated / sizeof *repeated; i++) {
    const size_t width = strlen(repeated[i]), count = 10000;
    char *formula = malloc(width * count + 2);
    assert_non_null(formula);
    for (size_t k = 0; k < count; k++) {
      memcpy(formula + k * width, repeated[i], width);
    }
    memcpy(formula + width * count, "1", 2);
    struct memory memory;
    open_formula(&memory, "SwissKnife", formula);
    double value;
    const int status =
        placido_genicam_get_float(memory.features, "Knife", &value, &memory.err);
    if (strcmp(repeated[i], "1?1:") == 0) {
      assert_int_equal(status, PLACIDO_OK); /* a list of conditions is not deep */
      assert_true(value == 1);
    } else {
      assert_int_equal(status, PLACIDO_INPUT);
      assert_says(&memory, "too deep");
    }
    memory_close(&memory);
    free(formula);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(integers_are_exact),
      cmocka_unit_test(reals_are_doubles),
      cmocka_unit_test(what_is_no_formula_is_told),
      cmocka_unit_test(conditions_nest_as_deep_as_real_ones),
      cmocka_unit_test(brackets_signs_and_powers_end),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
