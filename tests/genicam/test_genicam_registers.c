/* Bytes become numbers and numbers bytes, of any length, order, sign and place. */
#include "tests/genicam/memory_port.h"

#include <float.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#define ADDRESS 64

struct form {
  const char *kind, *elements;
  int size;
  bool is_big_endian, is_signed;
};

static void open_form(struct memory *memory, const struct form *form) {
  char nodes[1024];
  snprintf(nodes, sizeof nodes,
           "<%s Name=\"R\"><Address>%d</Address><Length>%d</Length><AccessMode>RW</AccessMode>"
           "%s%s%s</%s>",
           form->kind, ADDRESS, form->size, form->elements,
           form->is_signed ? "<Sign>Signed</Sign>" : "",
           form->is_big_endian ? "<Endianess>BigEndian</Endianess>" : "", form->kind);
  memory_open_nodes(memory, nodes);
}

static void integers_of_every_length_come_and_go(void **state) {
  (void)state;
  for (int size = 1; size <= 8; size++) {
    for (int flags = 0; flags < 4; flags++) {
      const struct form form = {"IntReg", "", size, flags & 1, flags & 2};
      struct memory memory;
      open_form(&memory, &form);
      const uint64_t pattern = 0xF1E2D3C4B5A69788u >> (64 - 8 * size);
      memory_put(&memory, ADDRESS, (size_t)size, form.is_big_endian, pattern);
      const bool is_negative = form.is_signed && size < 8;
      const int64_t value =
          (int64_t)(is_negative ? pattern - ((uint64_t)1 << 8 * size) : pattern);
      assert_true(integer_of(&memory, "R") == value);
      /* The same value written leaves the same bytes, and those around them alone. */
      memset(memory.bytes, 0x55, sizeof memory.bytes);
      assert_int_equal(
          placido_genicam_set_integer(memory.features, "R", value, &memory.err), PLACIDO_OK);
      assert_true(memory_take(&memory, ADDRESS, (size_t)size, form.is_big_endian) == pattern);
      assert_int_equal(memory.bytes[ADDRESS - 1], 0x55);
      assert_int_equal(memory.bytes[ADDRESS + size], 0x55);
      memory_close(&memory);
    }
  }
}

static void what_the_bits_cannot_hold_is_refused(void **state) {
  (void)state;
  for (int size = 1; size < 8; size++) {
    for (int is_signed = 0; is_signed < 2; is_signed++) {
      const struct form form = {"IntReg", "", size, false, is_signed};
      struct memory memory;
      open_form(&memory, &form);
      const int64_t max = ((int64_t)1 << (8 * size - is_signed)) - 1;
      const int64_t min = is_signed ? -max - 1 : 0;
      const placido_feature feature = description_of(&memory, "R");
      assert_true(feature.min == (double)min && feature.max == (double)max);
      assert_int_equal(placido_genicam_set_integer(memory.features, "R", max, NULL), PLACIDO_OK);
      assert_int_equal(placido_genicam_set_integer(memory.features, "R", min, NULL), PLACIDO_OK);
      assert_int_equal(placido_genicam_set_integer(memory.features, "R", max + 1, &memory.err),
                       PLACIDO_INPUT);
      assert_says(&memory, "is not from");
      assert_int_equal(placido_genicam_set_integer(memory.features, "R", min - 1, NULL),
                       PLACIDO_INPUT);
      assert_int_equal(memory.writes, 2);
      memory_close(&memory);
    }
  }
}

/* Bit 0 is the lowest of a little-endian register, and the highest of a big-endian one. */
static void masks_count_from_the_end_that_the_order_says(void **state) {
  (void)state;
  static const struct {
    struct form form;
    uint64_t bits;   /* in the register */
    int64_t value;
  } cases[] = {
      {{"MaskedIntReg", "<LSB>4</LSB><MSB>11</MSB>", 4, false, false}, 0x00000AB0, 0xAB},
      {{"MaskedIntReg", "<LSB>11</LSB><MSB>4</MSB>", 4, false, false}, 0x00000AB0, 0xAB},
      {{"MaskedIntReg", "<LSB>4</LSB><MSB>11</MSB>", 4, false, true}, 0x00000AB0, 0xAB - 256},
      {{"MaskedIntReg", "<LSB>27</LSB><MSB>20</MSB>", 4, true, false}, 0x00000AB0, 0xAB},
      {{"MaskedIntReg", "<LSB>20</LSB><MSB>27</MSB>", 4, true, true}, 0x00000AB0, 0xAB - 256},
      {{"MaskedIntReg", "<Bit>0</Bit>", 4, false, false}, 0x00000001, 1},
      {{"MaskedIntReg", "<Bit>0</Bit>", 4, true, false}, 0x80000000, 1},
      {{"MaskedIntReg", "<Bit>31</Bit>", 4, true, false}, 0x00000001, 1},
      {{"MaskedIntReg", "<Bit>3</Bit>", 1, false, true}, 0x08, -1},
      {{"MaskedIntReg", "<LSB>0</LSB><MSB>63</MSB>", 8, false, true}, UINT64_MAX, -1},
      {{"MaskedIntReg", "<LSB>32</LSB><MSB>63</MSB>", 8, false, false}, 0xDEADBEEF00000000u,
       0xDEADBEEF},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const struct form *form = &cases[i].form;
    const size_t size = (size_t)form->size;
    const uint64_t all = size == 8 ? UINT64_MAX : ((uint64_t)1 << 8 * size) - 1;
    struct memory memory;
    open_form(&memory, form);
    memory_put(&memory, ADDRESS, size, form->is_big_endian, cases[i].bits);
    assert_true(integer_of(&memory, "R") == cases[i].value);
    /* Zero clears these bits, and no others. */
    memory_put(&memory, ADDRESS, size, form->is_big_endian, all);
    placido_genicam_forget(memory.features);
    assert_int_equal(placido_genicam_set_integer(memory.features, "R", 0, NULL), PLACIDO_OK);
    const uint64_t left = memory_take(&memory, ADDRESS, size, form->is_big_endian);
    assert_int_equal(left & cases[i].bits, 0);
    assert_int_equal(placido_genicam_set_integer(memory.features, "R", cases[i].value, NULL),
                     PLACIDO_OK);
    assert_true(memory_take(&memory, ADDRESS, size, form->is_big_endian) ==
                (left | cases[i].bits));
    memory_close(&memory);
  }
}

static void floats_have_four_bytes_or_eight(void **state) {
  (void)state;
  for (int flags = 0; flags < 4; flags++) {
    const bool is_narrow = flags & 2;
    const struct form form = {"FloatReg", "", is_narrow ? 4 : 8, flags & 1, false};
    const size_t size = is_narrow ? 4 : 8;
    const uint64_t bits = is_narrow ? 0xC0490000u : 0xC009200000000000u; /* -3.140625 */
    struct memory memory;
    open_form(&memory, &form);
    memory_put(&memory, ADDRESS, size, form.is_big_endian, bits);
    assert_true(float_of(&memory, "R") == -3.140625);
    memory_put(&memory, ADDRESS, size, form.is_big_endian, 0);
    assert_int_equal(placido_genicam_set_float(memory.features, "R", -3.140625, NULL),
                     PLACIDO_OK);
    assert_true(memory_take(&memory, ADDRESS, size, form.is_big_endian) == bits);
    const int status = placido_genicam_set_float(memory.features, "R", 2. * FLT_MAX, NULL);
    assert_int_equal(status, is_narrow ? PLACIDO_INPUT : PLACIDO_OK);
    memory_close(&memory);
  }
}

static void strings_end_and_are_filled(void **state) {
  (void)state;
  const struct form form = {"StringReg", "", 8, false, false};
  struct memory memory;
  open_form(&memory, &form);
  char text[32];
  memcpy(memory.bytes + ADDRESS, "a\nb\0cdefXY", 10);
  assert_int_equal(placido_genicam_get_text(memory.features, "R", text, sizeof text, NULL),
                   PLACIDO_OK);
  assert_string_equal(text, "a b");
  memcpy(memory.bytes + ADDRESS, "12345678XY", 10); /* not ended: it ends with the register */
  placido_genicam_forget(memory.features);
  assert_int_equal(placido_genicam_get_text(memory.features, "R", text, sizeof text, NULL),
                   PLACIDO_OK);
  assert_string_equal(text, "12345678");
  assert_int_equal(placido_genicam_get_text(memory.features, "R", text, 4, NULL), PLACIDO_OK);
  assert_string_equal(text, "123");
  assert_int_equal(placido_genicam_set_text(memory.features, "R", "left", NULL), PLACIDO_OK);
  assert_memory_equal(memory.bytes + ADDRESS, "left\0\0\0\0XY", 10);
  assert_int_equal(placido_genicam_set_text(memory.features, "R", "87654321", NULL), PLACIDO_OK);
  assert_memory_equal(memory.bytes + ADDRESS, "87654321XY", 10);
  assert_int_equal(placido_genicam_set_text(memory.features, "R", "987654321", &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "at most 8 fit");
  memory_close(&memory);
}

static void addresses_are_sums(void **state) {
  (void)state;
  static const struct {
    const char *elements;
    uint64_t address;
    size_t size;
  } cases[] = {
      {"<Address>0x10</Address>", 0x10, 4},
      {"<Address>0x10</Address><Address>16</Address>", 0x20, 4},
      {"<pAddress>Five</pAddress><Address>3</Address><pAddress>Five</pAddress>", 13, 4},
      {"<Address>100</Address><pIndex>Five</pIndex>", 120, 4},
      {"<Address>100</Address><pIndex>Five</pIndex><Length>2</Length>", 110, 2},
      {"<Address>100</Address><pIndex Offset=\"0x10\">Five</pIndex>", 180, 4},
      {"<Address>100</Address><pIndex pOffset=\"Three\">Five</pIndex>", 115, 4},
      {"<pIndex Offset=\"100\">Five</pIndex><pIndex Offset=\"1\">Three</pIndex>", 503, 4},
      {"<Address>100</Address><IntSwissKnife><pVariable Name=\"A\">Five</pVariable>"
       "<Formula>A * 7</Formula></IntSwissKnife>", 135, 4},
      {"<Address>0xFFFFFFFFFFFFFFFF</Address><Address>9</Address>", 8, 4},
      {"<Address>1</Address><pLength>Three</pLength>", 1, 3},
      {"<Address>0x0</Address><Length>8</Length>", 0, 8},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    char nodes[1024];
    snprintf(nodes, sizeof nodes,
             "<IntReg Name=\"R\">%s</IntReg><Integer Name=\"Five\"><Value>5</Value></Integer>"
             "<Integer Name=\"Three\"><Value>3</Value></Integer>", cases[i].elements);
    memory_open_nodes(&memory, nodes);
    integer_of(&memory, "R");
    assert_int_equal(memory.address, cases[i].address);
    assert_int_equal(memory.size, cases[i].size);
    memory_close(&memory);
  }
}

static void registers_that_cannot_be_are_told(void **state) {
  (void)state;
  static const struct {
    const char *nodes, *said;
  } cases[] = {
      {"<IntReg Name=\"R\"><Length>4</Length></IntReg>", "no address"},
      {"<IntReg Name=\"R\"><Address>0</Address><Length>9</Length></IntReg>", "1 to 8"},
      {"<IntReg Name=\"R\"><Address>0</Address><Length>0</Length></IntReg>", "1 to 8"},
      {"<IntReg Name=\"R\"><Address>0</Address><Length>-1</Length></IntReg>", "1 to 8"},
      {"<IntReg Name=\"R\"><Address>here</Address></IntReg>", "\"here\" is no number"},
      {"<IntReg Name=\"R\"><Address>1e30</Address></IntReg>", "beyond 64 bits"},
      {"<IntReg Name=\"R\"><pAddress>Gone</pAddress></IntReg>", "Gone, which is not there"},
      {"<IntReg Name=\"R\"><pAddress>R</pAddress></IntReg>", "circle at R"},
      {"<IntReg Name=\"R\"><Address>0</Address><pIndex Offset=\"x\">R</pIndex></IntReg>",
       "circle"},
      {"<IntReg Name=\"R\"><pIndex Offset=\"x\">A</pIndex></IntReg>"
       "<Integer Name=\"A\"><Value>1</Value></Integer>", "the offset x, no number"},
      {"<IntReg Name=\"R\"><pIndex pOffset=\"Gone\">A</pIndex></IntReg>"
       "<Integer Name=\"A\"><Value>1</Value></Integer>", "Gone, which is not there"},
      {"<FloatReg Name=\"R\"><Address>0</Address><Length>2</Length></FloatReg>", "4 or 8"},
      {"<MaskedIntReg Name=\"R\"><Address>0</Address><Bit>32</Bit></MaskedIntReg>",
       "do not lie in its 32 bits"},
      {"<MaskedIntReg Name=\"R\"><Address>0</Address><LSB>-2</LSB></MaskedIntReg>",
       "do not lie in its 32 bits"},
      {"<IntReg Name=\"R\"><Address>0x1000</Address></IntReg>", "no register at 0x1000"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    double value;
    memory_open_nodes(&memory, cases[i].nodes);
    assert_int_not_equal(placido_genicam_get_float(memory.features, "R", &value, &memory.err),
                         PLACIDO_OK);
    assert_says(&memory, cases[i].said);
    memory_close(&memory);
  }
  struct memory memory;
  char text[8];
  memory_open_nodes(&memory,
                    "<StringReg Name=\"R\"><Address>0</Address><Length>65537</Length></StringReg>");
  assert_int_equal(placido_genicam_get_text(memory.features, "R", text, sizeof text, &memory.err),
                   PLACIDO_INPUT);
  assert_says(&memory, "1 to 65536");
  memory_close(&memory);
}

static unsigned reads_of_two(struct memory *memory) {
  memory->reads = 0;
  integer_of(memory, "R");
  integer_of(memory, "R");
  return memory->reads;
}

static void what_may_be_kept_is_read_once(void **state) {
  (void)state;
  static const struct {
    const char *elements;
    unsigned reads; /* of two */
  } cases[] = {
      {"", 1},
      {"<Cachable>WriteThrough</Cachable>", 1},
      {"<Cachable>WriteAround</Cachable>", 1},
      {"<Cachable>NoCache</Cachable>", 2},
      {"<PollingTime>100</PollingTime>", 2},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    struct memory memory;
    char nodes[1024];
    snprintf(nodes, sizeof nodes,
             "<IntReg Name=\"R\"><Address>8</Address><AccessMode>RW</AccessMode>"
             "<pIndex>Selector</pIndex>%s<pInvalidator>Other</pInvalidator></IntReg>"
             "<Integer Name=\"Selector\"><Value>0</Value></Integer>"
             "<IntReg Name=\"Other\"><Address>4</Address><AccessMode>RW</AccessMode></IntReg>",
             cases[i].elements);
    memory_open_nodes(&memory, nodes);
    assert_int_equal(reads_of_two(&memory), cases[i].reads);
    /* Another hand's change is seen after forgetting. */
    memory.bytes[8] = 9;
    placido_genicam_forget(memory.features);
    assert_int_equal(integer_of(&memory, "R"), 9);
    /* So is what the camera makes of a value that is written: here or to what invalidates it. */
    assert_int_equal(placido_genicam_set_integer(memory.features, "R", 5, NULL), PLACIDO_OK);
    memory.bytes[8] = 4;
    assert_int_equal(integer_of(&memory, "R"), 4);
    assert_int_equal(placido_genicam_set_integer(memory.features, "Other", 1, NULL), PLACIDO_OK);
    memory.bytes[8] = 3;
    assert_int_equal(integer_of(&memory, "R"), 3);
    /* Another selection is another register. */
    memory.bytes[12] = 77;
    assert_int_equal(placido_genicam_set_integer(memory.features, "Selector", 1, NULL),
                     PLACIDO_OK);
    assert_int_equal(integer_of(&memory, "R"), 77);
    memory_close(&memory);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(integers_of_every_length_come_and_go),
      cmocka_unit_test(what_the_bits_cannot_hold_is_refused),
      cmocka_unit_test(masks_count_from_the_end_that_the_order_says),
      cmocka_unit_test(floats_have_four_bytes_or_eight),
      cmocka_unit_test(strings_end_and_are_filled),
      cmocka_unit_test(addresses_are_sums),
      cmocka_unit_test(registers_that_cannot_be_are_told),
      cmocka_unit_test(what_may_be_kept_is_read_once),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
