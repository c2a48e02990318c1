/* How nodes stand for each other: values, limits, access; and that circles and mazes end. */
#include "tests/genicam/memory_port.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REGISTER(name, address)                                                                    \
  "<IntReg Name=\"" name "\"><Address>" address "</Address><Length>4</Length>"                     \
  "<AccessMode>RW</AccessMode></IntReg>"
#define INTEGER(name, elements) "<Integer Name=\"" name "\">" elements "</Integer>"
#define FLOAT(name, elements) "<Float Name=\"" name "\">" elements "</Float>"

static void a_value_is_written_to_its_copies(void **state) {
  (void)state;
  struct memory memory;
  memory_open_nodes(&memory,
                    INTEGER("A", "<pValue>R</pValue><pValueCopy>S</pValueCopy>"
                                 "<pValueCopy>T</pValueCopy>")
                        REGISTER("R", "0") REGISTER("S", "4") REGISTER("T", "8"));
  assert_int_equal(placido_genicam_set_integer(memory.features, "A", 5, NULL), PLACIDO_OK);
  assert_int_equal(memory_take(&memory, 0, 4, false), 5);
  assert_int_equal(memory_take(&memory, 4, 4, false), 5);
  assert_int_equal(memory_take(&memory, 8, 4, false), 5);
  memory_close(&memory);
}

/* What is said of a feature itself counts; else what is said of what stands behind it. */
static void limits_come_from_the_nearest(void **state) {
  (void)state;
  static const struct {
    const char *nodes;
    double min, max, step;
  } cases[] = {
      {INTEGER("A", "<pValue>R</pValue>"), 0, 4294967295., 1},
      {INTEGER("A", "<pValue>B</pValue>")
           INTEGER("B", "<pValue>R</pValue><Min>2</Min><Max>8</Max><Inc>2</Inc>"),
       2, 8, 2},
      {INTEGER("A", "<pValue>B</pValue><Max>6</Max>")
           INTEGER("B", "<pValue>R</pValue><Min>2</Min><Max>8</Max><Inc>2</Inc>"),
       2, 6, 2},
      {INTEGER("A", "<Value>0</Value>"), -0x1p63, 0x1p63, 1},
      {INTEGER("A", "<Value>0</Value><Max>0xFFFFFFFFFFFFFFFF</Max>"), -0x1p63, 0x1p63, 1},
      {INTEGER("A", "<Value>0</Value><Min>-1e30</Min><Max>1e30</Max>"), -0x1p63, 0x1p63, 1},
      {INTEGER("A", "<Value>0</Value><pMin>R</pMin><pMax>F</pMax><pInc>R</pInc>")
           FLOAT("F", "<Value>7.6</Value>"),
       3, 8, 3},
      {FLOAT("A", "<Value>0</Value>"), -DBL_MAX, DBL_MAX, 0},
      {FLOAT("A", "<Value>0</Value><Min>0.5</Min><pMax>R</pMax><Inc>0.25</Inc>"), 0.5, 3, 0.25},
      {FLOAT("A", "<pValue>R</pValue>"), 0, 4294967295., 1},
      {FLOAT("A", "<pValue>B</pValue>") INTEGER("B", "<Value>1</Value>"), -DBL_MAX, DBL_MAX, 1},
      {"<Boolean Name=\"A\"><Value>true</Value></Boolean>", 0, 1, 1},
      {"<Enumeration Name=\"A\"><EnumEntry Name=\"X\"><Value>9</Value></EnumEntry>"
       "<EnumEntry Name=\"Y\"><Value>-4</Value></EnumEntry><Value>9</Value></Enumeration>",
       -4, 9, 1},
      {"<FloatReg Name=\"A\"><Address>0</Address></FloatReg>", -DBL_MAX, DBL_MAX, 0},
      /* A formula that has no value at one end limits nothing. */
      {"<IntConverter Name=\"A\"><pValue>R</pValue><FormulaFrom>1000 / TO</FormulaFrom>"
       "<FormulaTo>1000 / FROM</FormulaTo></IntConverter>",
       -0x1p63, 0x1p63, 1},
      {"<Converter Name=\"A\"><pValue>R</pValue><FormulaFrom>1000 / (TO + 1)</FormulaFrom>"
       "<FormulaTo>1000 / FROM - 1</FormulaTo></Converter>",
       1000 / 0x1p32, 1000, 0},
      {"<Converter Name=\"A\"><pValue>B</pValue><FormulaFrom>TO</FormulaFrom>"
       "<FormulaTo>FROM</FormulaTo></Converter>" INTEGER("B", "<Value>1</Value>"),
       -DBL_MAX, DBL_MAX, 0},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    char nodes[1024];
    snprintf(nodes, sizeof nodes, "%s" REGISTER("R", "0"), cases[i].nodes);
    memory_open_nodes(&memory, nodes);
    memory.bytes[0] = 3;
    const placido_feature feature = description_of(&memory, "A");
    if (feature.min != cases[i].min || feature.max != cases[i].max ||
        feature.step != cases[i].step) {
      fail_msg("%s: %.17g to %.17g by %g", cases[i].nodes, feature.min, feature.max,
               feature.step);
    }
    memory_close(&memory);
  }
}

static void access_is_what_all_allow(void **state) {
  (void)state;
  static const struct {
    const char *nodes;
    bool can_read, can_write;
  } cases[] = {
      {"<IntReg Name=\"A\"><Address>0</Address></IntReg>", true, false},
      {"<IntReg Name=\"A\"><Address>0</Address><AccessMode>RO</AccessMode></IntReg>", true, false},
      {"<IntReg Name=\"A\"><Address>0</Address><AccessMode>WO</AccessMode></IntReg>", false, true},
      {"<IntReg Name=\"A\"><Address>0</Address><AccessMode>RW</AccessMode></IntReg>", true, true},
      {"<IntReg Name=\"A\"><Address>0</Address><AccessMode>RW</AccessMode>"
       "<ImposedAccessMode>WO</ImposedAccessMode></IntReg>", false, true},
      {INTEGER("A", "<pValue>R</pValue>"), true, true},
      {INTEGER("A", "<pValue>R</pValue><ImposedAccessMode>RO</ImposedAccessMode>"), true, false},
      {INTEGER("A", "<Value>1</Value>"), true, true},
      {INTEGER("A", "<Min>1</Min>"), false, false},
      {INTEGER("A", "<Value>1</Value><pIsLocked>One</pIsLocked>"), true, false},
      {INTEGER("A", "<Value>1</Value><pIsLocked>Zero</pIsLocked>"), true, true},
      {INTEGER("A", "<Value>1</Value><pIsAvailable>Zero</pIsAvailable>"), false, false},
      {INTEGER("A", "<Value>1</Value><pIsImplemented>Zero</pIsImplemented>"), false, false},
      {INTEGER("A", "<Value>1</Value><pIsImplemented>One</pIsImplemented>"), true, true},
      {INTEGER("A", "<pValue>B</pValue>")
           INTEGER("B", "<Value>1</Value><pIsAvailable>Zero</pIsAvailable>"), false, false},
      {INTEGER("A", "<pValue>B</pValue>")
           INTEGER("B", "<Value>1</Value><pIsLocked>One</pIsLocked>"), true, false},
      {"<SwissKnife Name=\"A\"><Formula>1</Formula></SwissKnife>", true, false},
      {"<SwissKnife Name=\"A\"><pVariable Name=\"X\">B</pVariable><Formula>X</Formula>"
       "</SwissKnife>" INTEGER("B", "<Value>1</Value><pIsAvailable>Zero</pIsAvailable>"),
       false, false},
      {"<Converter Name=\"A\"><pValue>R</pValue><FormulaTo>FROM</FormulaTo>"
       "<FormulaFrom>TO</FormulaFrom></Converter>", true, true},
      {"<Converter Name=\"A\"><pVariable Name=\"X\">B</pVariable><pValue>R</pValue>"
       "<FormulaTo>FROM</FormulaTo><FormulaFrom>TO</FormulaFrom></Converter>"
       INTEGER("B", "<Value>1</Value><pIsAvailable>Zero</pIsAvailable>"), false, false},
      {"<IntReg Name=\"A\"><Address>0</Address><pPort>P</pPort></IntReg>"
       "<Port Name=\"P\"><EventID>12</EventID></Port>", false, false},
      {"<IntReg Name=\"A\"><Address>0</Address><pPort>P</pPort></IntReg><Port Name=\"P\"/>",
       true, false},
      {"<String Name=\"A\"><Value>text</Value></String>", true, false},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    char nodes[1024];
    snprintf(nodes, sizeof nodes,
             "%s" REGISTER("R", "0") INTEGER("Zero", "<Value>0</Value>")
                 "<Boolean Name=\"One\"><Value>true</Value></Boolean>",
             cases[i].nodes);
    memory_open_nodes(&memory, nodes);
    const placido_feature feature = description_of(&memory, "A");
    if (feature.can_read != cases[i].can_read || feature.can_write != cases[i].can_write) {
      fail_msg("%s: read %d write %d", cases[i].nodes, feature.can_read, feature.can_write);
    }
    memory_close(&memory);
  }
}

static void kinds_are_not_mixed_up(void **state) {
  (void)state;
  struct memory memory;
  memory_open_nodes(&memory,
                    "<String Name=\"S\"><pValue>T</pValue></String>"
                    "<String Name=\"T\"><Value> two words </Value></String>"
                    "<Register Name=\"B\"><Address>0</Address></Register>"
                    "<Category Name=\"C\"/><Port Name=\"D\"/>"
                    INTEGER("I", "<Value>5</Value>")
                    FLOAT("F", "<pValue>I</pValue>")
                    "<String Name=\"W\"><pValue>I</pValue></String>"
                    INTEGER("V", "<pValue>T</pValue>"));
  placido_genicam *features = memory.features;
  char text[16];
  assert_int_equal(placido_genicam_get_text(features, "S", text, sizeof text, NULL), PLACIDO_OK);
  assert_string_equal(text, "two words");
  assert_int_equal(placido_genicam_get_text(features, "S", text, 0, NULL), PLACIDO_OK);
  assert_int_equal(placido_genicam_get_text(features, "I", text, sizeof text, &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "I is no text");
  assert_int_equal(placido_genicam_get_text(features, "W", text, sizeof text, &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "I of the camera's description holds no text");
  assert_string_equal(text, "");
  double real = 1;
  assert_int_equal(placido_genicam_get_float(features, "S", &real, &memory.err), PLACIDO_INPUT);
  assert_true(real == 0);
  assert_int_equal(placido_genicam_get_float(features, "V", &real, &memory.err), PLACIDO_INPUT);
  assert_says(&memory, "T of the camera's description holds no number");
  assert_int_equal(placido_genicam_set_float(features, "F", 6.4, NULL), PLACIDO_OK);
  assert_int_equal(integer_of(&memory, "I"), 6);
  assert_true(float_of(&memory, "F") == 6);
  static const char *const valueless[] = {"B", "C", "D"};
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(description_of(&memory, valueless[i]).kind, PLACIDO_FEATURE_NONE);
  }
  assert_int_equal(placido_genicam_entries(features, "I", NULL, NULL, &memory.err),
                   PLACIDO_INPUT);
  assert_int_equal(placido_genicam_each(features, NULL, NULL, &memory.err), PLACIDO_INPUT);
  assert_says(&memory, "no category Root");
  memory_close(&memory);
}

/* An index chooses among values that stand in the description, and others. */
static void indexed_values_can_be_written(void **state) {
  (void)state;
  struct memory memory;
  memory_open_nodes(&memory,
                    INTEGER("Index", "<Value>0</Value>")
                    FLOAT("A", "<pIndex>Index</pIndex><ValueIndexed Index=\"0\">1.5</ValueIndexed>"
                               "<pValueIndexed Index=\"1\">R</pValueIndexed>"
                               "<ValueDefault>9</ValueDefault>") REGISTER("R", "0"));
  const double values[] = {1.5, 0, 9, 12}; /* the last two are one */
  for (int i = 0; i < 4; i++) {
    assert_int_equal(placido_genicam_set_integer(memory.features, "Index", i, NULL), PLACIDO_OK);
    assert_true(float_of(&memory, "A") == values[i]);
    assert_int_equal(placido_genicam_set_float(memory.features, "A", 10 + i, NULL), PLACIDO_OK);
    assert_true(float_of(&memory, "A") == 10 + i);
  }
  assert_int_equal(memory.bytes[0], 11);
  memory_close(&memory);
}

static void entries_that_are_one_value_are_told_apart(void **state) {
  (void)state;
  struct memory memory;
  memory_open_nodes(&memory,
                    "<Enumeration Name=\"A\">"
                    "<EnumEntry Name=\"Old\"><pIsAvailable>Zero</pIsAvailable><Value>1</Value>"
                    "</EnumEntry><EnumEntry Name=\"New\"><Value>1</Value></EnumEntry>"
                    "<Value>1</Value></Enumeration>"
                    "<Enumeration Name=\"B\"><EnumEntry Name=\"New\"><Value>2</Value></EnumEntry>"
                    "<Value>2</Value></Enumeration>" INTEGER("Zero", "<Value>0</Value>"));
  char text[16];
  assert_int_equal(placido_genicam_get_text(memory.features, "A", text, sizeof text, NULL),
                   PLACIDO_OK);
  assert_string_equal(text, "New");
  assert_int_equal(placido_genicam_set_text(memory.features, "B", "New", NULL), PLACIDO_OK);
  assert_int_equal(integer_of(&memory, "B"), 2);
  memory_close(&memory);
}

/* Every way round is told, with the name of a node on it. */
static void circles_are_told(void **state) {
  (void)state;
  static const char *const cases[] = {
      INTEGER("A", "<pValue>A</pValue>"),
      INTEGER("A", "<pValue>B</pValue>") INTEGER("B", "<pValue>A</pValue>"),
      INTEGER("A", "<pIndex>A</pIndex><ValueDefault>1</ValueDefault>"),
      INTEGER("A", "<Value>1</Value><pMax>A2</pMax>")
          "<IntSwissKnife Name=\"A2\"><pVariable Name=\"X.Max\">A</pVariable>"
          "<Formula>X.Max</Formula></IntSwissKnife>",
      INTEGER("A", "<pValue>B</pValue><pIsLocked>A3</pIsLocked>")
          INTEGER("B", "<pValue>A</pValue>") INTEGER("A3", "<Value>0</Value>"),
      "<IntReg Name=\"A\"><pAddress>A</pAddress><AccessMode>RW</AccessMode></IntReg>",
      "<IntReg Name=\"A\"><Address>0</Address><pLength>A</pLength><AccessMode>RW</AccessMode>"
      "</IntReg>",
      "<SwissKnife Name=\"A\"><pVariable Name=\"X\">A</pVariable><Formula>X</Formula></SwissKnife>",
      "<Converter Name=\"A\"><pValue>A</pValue><FormulaTo>FROM</FormulaTo>"
      "<FormulaFrom>TO</FormulaFrom></Converter>",
      INTEGER("A", "<Value>1</Value><pIsAvailable>B</pIsAvailable>")
          INTEGER("B", "<pValue>B</pValue>"),
      "<Category Name=\"Root\"><pFeature>A</pFeature></Category>"
      "<Category Name=\"A\"><pFeature>Root</pFeature></Category>",
      "<String Name=\"A\"><pValue>A</pValue></String>",
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    placido_feature feature;
    memory_open_nodes(&memory, cases[i]);
    if (strstr(cases[i], "Root")) {
      assert_int_equal(placido_genicam_each(memory.features, NULL, NULL, &memory.err),
                       PLACIDO_INPUT);
    } else if (placido_genicam_describe(memory.features, "A", &feature, &memory.err) !=
               PLACIDO_INPUT) {
      fail_msg("%s was described", cases[i]);
    }
    assert_says(&memory, "circle");
    int64_t value;
    char text[8];
    assert_int_equal(placido_genicam_get_integer(memory.features, "A", &value, NULL),
                     strstr(cases[i], "<pMax>") ? PLACIDO_OK : PLACIDO_INPUT);
    assert_int_equal(placido_genicam_set_integer(memory.features, "A", 1, NULL), PLACIDO_INPUT);
    assert_int_equal(placido_genicam_get_text(memory.features, "A", text, sizeof text, NULL),
                     PLACIDO_INPUT);
    memory_close(&memory);
  }
}

/* Forty levels of which each asks the next twice: 2^40 ways, none of them a circle. */
static void mazes_end(void **state) {
  (void)state;
  char nodes[16384];
  size_t length = 0;
  for (int i = 0; i < 40; i++) {
    length += (size_t)snprintf(nodes + length, sizeof nodes - length,
                               "<IntSwissKnife Name=\"N%d\"><pVariable Name=\"A\">N%d</pVariable>"
                               "<pVariable Name=\"B\">N%d</pVariable><Formula>A + B</Formula>"
                               "</IntSwissKnife>", i, i + 1, i + 1);
  }
  snprintf(nodes + length, sizeof nodes - length, INTEGER("N40", "<Value>1</Value>"));
  struct memory memory;
  memory_open_nodes(&memory, nodes);
  int64_t value;
  assert_int_equal(placido_genicam_get_integer(memory.features, "N0", &value, &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "endless work");
  assert_int_equal(integer_of(&memory, "N32"), 256); /* the next call begins anew */
  memory_close(&memory);
}

/* A hostile camera cannot keep us reading registers either. */
static void reading_without_end_ends(void **state) {
  (void)state;
  char *formula = malloc(1 << 16);
  assert_non_null(formula);
  char *nodes = malloc(1 << 17);
  assert_non_null(nodes);
  strcpy(formula, "R");
  for (size_t length = 1; length < 60000; length += 2) {
    strcpy(formula + length, "+R");
  }
  snprintf(nodes, 1 << 17,
           "<IntSwissKnife Name=\"A\"><pVariable Name=\"R\">R</pVariable><Formula>%s</Formula>"
           "</IntSwissKnife><IntReg Name=\"R\"><Address>0</Address><Cachable>NoCache</Cachable>"
           "</IntReg>", formula);
  struct memory memory;
  memory_open_nodes(&memory, nodes);
  int64_t value;
  assert_int_equal(placido_genicam_get_integer(memory.features, "A", &value, &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "endless work");
  assert_true(memory.reads < 10000);
  memory_close(&memory);
  free(formula);
  free(nodes);
}

static int read_within(void *user, const char *name, const char *category) {
  (void)category;
  struct memory *memory = user;
  return integer_of(memory, name) == 3 ? PLACIDO_OK : 1;
}

/* What is asked within a callback has a measure of work of its own. */
static void callbacks_may_ask(void **state) {
  (void)state;
  char *nodes = malloc(1 << 18);
  assert_non_null(nodes);
  size_t length = (size_t)sprintf(nodes, REGISTER("R", "0") INTEGER("A", "<pValue>R</pValue>")
                                  "<Category Name=\"Root\">");
  for (int i = 0; i < 8000; i++) {
    length += (size_t)sprintf(nodes + length, "<pFeature>A</pFeature>");
  }
  sprintf(nodes + length, "</Category>");
  struct memory memory;
  memory_open_nodes(&memory, nodes);
  free(nodes);
  memory.bytes[0] = 3;
  assert_int_equal(placido_genicam_each(memory.features, read_within, &memory, &memory.err),
                   PLACIDO_OK);
  assert_int_equal(memory.reads, 1);
  memory_close(&memory);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_value_is_written_to_its_copies),
      cmocka_unit_test(limits_come_from_the_nearest),
      cmocka_unit_test(access_is_what_all_allow),
      cmocka_unit_test(kinds_are_not_mixed_up),
      cmocka_unit_test(indexed_values_can_be_written),
      cmocka_unit_test(entries_that_are_one_value_are_told_apart),
      cmocka_unit_test(circles_are_told),
      cmocka_unit_test(mazes_end),
      cmocka_unit_test(reading_without_end_ends),
      cmocka_unit_test(callbacks_may_ask),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
