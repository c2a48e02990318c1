/* What a camera tells of itself is read whatever its registers hold, and every failure on the way
 * is survived or told. */
#include "base/memory.h"
#include "drivers/u3v/bootstrap.h"
#include "drivers/u3v/wire/registers.h"
#include "tests/drivers/u3v_registers.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <string.h>
#include <zip.h>

/* Values of a manifest's schema: version 1.1 and 1.0, XML and zip. */
#define XML_1_1 0x01010000u
#define XML_1_0 0x01000000u
#define ZIP_1_1 0x01010400u

static const char xml_text[] = "<a>eye eye eye eye eye eye eye eye eye eye </a>";

/* readme.txt ("no", stored) and eye.XML (the text above, deflated), as Python's zipfile writes
 * them. */
static const uint8_t zip_bytes[] = {
    0x50, 0x4b, 0x03, 0x04, 0x14, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x21, 0x00, 0x1f, 0x28,
    0xaa, 0x67, 0x02, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x0a, 0x00, 0x00, 0x00, 0x72, 0x65,
    0x61, 0x64, 0x6d, 0x65, 0x2e, 0x74, 0x78, 0x74, 0x6e, 0x6f, 0x50, 0x4b, 0x03, 0x04, 0x14, 0x00,
    0x00, 0x00, 0x08, 0x00, 0x00, 0x00, 0x21, 0x00, 0x09, 0x30, 0x34, 0x2f, 0x0f, 0x00, 0x00, 0x00,
    0x2f, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x65, 0x79, 0x65, 0x2e, 0x58, 0x4d, 0x4c, 0xb3,
    0x49, 0xb4, 0x4b, 0xad, 0x4c, 0x55, 0x20, 0x06, 0xdb, 0xe8, 0x27, 0xda, 0x01, 0x00, 0x50, 0x4b,
    0x01, 0x02, 0x14, 0x03, 0x14, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x21, 0x00, 0x1f, 0x28,
    0xaa, 0x67, 0x02, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x0a, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x01, 0x00, 0x00, 0x00, 0x00, 0x72, 0x65, 0x61, 0x64,
    0x6d, 0x65, 0x2e, 0x74, 0x78, 0x74, 0x50, 0x4b, 0x01, 0x02, 0x14, 0x03, 0x14, 0x00, 0x00, 0x00,
    0x08, 0x00, 0x00, 0x00, 0x21, 0x00, 0x09, 0x30, 0x34, 0x2f, 0x0f, 0x00, 0x00, 0x00, 0x2f, 0x00,
    0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x80, 0x01,
    0x2a, 0x00, 0x00, 0x00, 0x65, 0x79, 0x65, 0x2e, 0x58, 0x4d, 0x4c, 0x50, 0x4b, 0x05, 0x06, 0x00,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x02, 0x00, 0x6d, 0x00, 0x00, 0x00, 0x5e, 0x00, 0x00, 0x00, 0x00,
    0x00};

/* Where the archive keeps the length of its XML file, twice, and its checksum. */
enum { ZIP_SIZE_LOCAL = 64, ZIP_CHECKSUM = 166, ZIP_SIZE_CENTRAL = 174 };

static placido_u3v_channel channel;

static int set_up(void **state) {
  (void)state;
  registers_reset();
  return 0;
}

static int tear_down(void **state) {
  (void)state;
  placido_u3v_channel_close(&channel);
  registers_free();
  return 0;
}

static int open_channel(placido_error *err) {
  placido_u3v_channel_close(&channel);
  return placido_u3v_channel_open(&channel, &u3v_registers_calls, NULL, 512, err);
}

/* A camera with the XML file in its zip. */
static void describe_zipped(void) {
  registers_describe(0, 0x01000000, ZIP_1_1, REGISTERS_FILE, sizeof zip_bytes);
  registers_put(REGISTERS_FILE, zip_bytes, sizeof zip_bytes);
}

static void assert_description(const char *text) {
  char *xml;
  size_t size;
  placido_error err = {0};
  assert_int_equal(open_channel(NULL), PLACIDO_OK);
  if (placido_u3v_description_read(&xml, &size, &channel, &err)) {
    fail_msg("%s", err.text);
  }
  assert_int_equal(size, strlen(text));
  assert_string_equal(xml, text);
  placido_memory_free(xml);
}

static void assert_no_description(int status, const char *said) {
  char *xml = (char *)&xml;
  size_t size = 1;
  placido_error err = {0};
  assert_int_equal(open_channel(NULL), PLACIDO_OK);
  assert_int_equal(placido_u3v_description_read(&xml, &size, &channel, &err), status);
  assert_null(xml);
  assert_int_equal(size, 0);
  if (!strstr(err.text, said)) {
    fail_msg("\"%s\" does not say \"%s\"", err.text, said);
  }
}

static void the_camera_tells_who_it_is(void **state) {
  (void)state;
  placido_u3v_bootstrap bootstrap;
  assert_int_equal(open_channel(NULL), PLACIDO_OK);
  assert_int_equal(placido_u3v_bootstrap_read(&bootstrap, &channel, NULL), PLACIDO_OK);
  assert_string_equal(bootstrap.vendor, "Maker");
  assert_string_equal(bootstrap.model, "Eye 5");
  assert_string_equal(bootstrap.version, "1.2");
  assert_string_equal(bootstrap.serial, "SN0001");
  assert_string_equal(bootstrap.user_name, "left");
  assert_int_equal(bootstrap.sbrm_address, REGISTERS_SBRM);
  assert_int_equal(bootstrap.sirm_address, REGISTERS_SIRM);
  assert_int_equal(bootstrap.timestamp_increment_ns, 8);
}

static void its_strings_fit_a_line(void **state) {
  (void)state;
  uint8_t bytes[64];
  memset(bytes, 'x', sizeof bytes);
  bytes[1] = '\n';
  bytes[2] = 0xff;
  bytes[3] = 0x1b;
  registers_put(PLACIDO_ABRM_MODEL, bytes, sizeof bytes);
  registers_put(PLACIDO_ABRM_SERIAL, "7  \0junk", 8);
  placido_u3v_bootstrap bootstrap;
  assert_int_equal(open_channel(NULL), PLACIDO_OK);
  assert_int_equal(placido_u3v_bootstrap_read(&bootstrap, &channel, NULL), PLACIDO_OK);
  assert_int_equal(strlen(bootstrap.model), 63);
  assert_memory_equal(bootstrap.model, "x???x", 5);
  assert_string_equal(bootstrap.serial, "7");
}

static void registers_that_old_cameras_lack_are_done_without(void **state) {
  (void)state;
  registers.refused_from = PLACIDO_ABRM_USER_NAME;
  registers.refused_up_to = PLACIDO_ABRM_CAPABILITY;
  placido_u3v_bootstrap bootstrap;
  assert_int_equal(open_channel(NULL), PLACIDO_OK);
  assert_int_equal(placido_u3v_bootstrap_read(&bootstrap, &channel, NULL), PLACIDO_OK);
  assert_string_equal(bootstrap.user_name, "");
  registers.refused_from = PLACIDO_ABRM_TIMESTAMP_INCREMENT;
  registers.refused_up_to = PLACIDO_ABRM_ACCESS_PRIVILEGE;
  assert_int_equal(placido_u3v_bootstrap_read(&bootstrap, &channel, NULL), PLACIDO_OK);
  assert_string_equal(bootstrap.user_name, "left");
  assert_int_equal(bootstrap.timestamp_increment_ns, 0);
}

static void a_camera_without_a_stream_is_refused(void **state) {
  (void)state;
  static const struct {
    uint32_t channels;
    uint64_t sirm;
  } cases[] = {{0, REGISTERS_SIRM}, {1, 0}, {1, UINT64_MAX}, {1, UINT64_MAX - 16}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    registers_put_u32(REGISTERS_SBRM + PLACIDO_SBRM_STREAM_CHANNELS, cases[i].channels);
    registers_put_u64(REGISTERS_SBRM + PLACIDO_SBRM_SIRM_ADDRESS, cases[i].sirm);
    placido_u3v_bootstrap bootstrap;
    placido_error err = {0};
    assert_int_equal(open_channel(NULL), PLACIDO_OK);
    assert_int_equal(placido_u3v_bootstrap_read(&bootstrap, &channel, &err), PLACIDO_INPUT);
    assert_non_null(strstr(err.text, "Maker Eye 5 has no stream"));
  }
}

static void a_description_is_read_plain_or_zipped(void **state) {
  (void)state;
  describe_zipped();
  assert_description(xml_text);
  registers_describe(0, 0, XML_1_1, REGISTERS_FILE, sizeof zip_bytes); /* which it is not */
  assert_description(xml_text);
  registers_describe(0, 0, XML_1_1, REGISTERS_FILE, 100); /* filled up with zeros */
  uint8_t filled[100] = {0};
  memcpy(filled, xml_text, strlen(xml_text));
  registers_put(REGISTERS_FILE, filled, sizeof filled);
  assert_description(xml_text);
  registers_describe(0, 0, ZIP_1_1, REGISTERS_FILE, strlen(xml_text)); /* which it is not */
  assert_description(xml_text);
}

/* Puts a file in the manifest; its text tells which one was read. */
static void add(int i, uint32_t version, uint32_t schema, const char *text) {
  const uint64_t address = REGISTERS_FILE + 0x1000u * (unsigned)i;
  registers_describe(i, version, schema, address, strlen(text));
  registers_put(address, text, strlen(text));
}

static void the_best_of_the_manifest_is_taken(void **state) {
  (void)state;
  add(0, 0x09000000, XML_1_0, "<old schema>");
  add(1, 0x01000000, XML_1_1, "<old file>");
  add(2, 0x02000000, XML_1_1, "<best>");
  add(3, 0x03000000, XML_1_1 | 1, "<of a buffer>");
  add(4, 0x04000000, 0x02000000 | 5 << 10, "<another kind>");
  assert_description("<best>");
  registers_put(REGISTERS_FILE + 0x2000, "what?!", 6); /* not to be read: the next is taken */
  assert_description("<old file>");
  registers_put_u64(REGISTERS_MANIFEST + 8 + 64 + PLACIDO_MANIFEST_ADDRESS, REGISTERS_BYTES);
  assert_description("<old schema>");
  registers_put_u64(REGISTERS_MANIFEST + 8 + PLACIDO_MANIFEST_SIZE, 0);
  assert_description("<of a buffer>");
  registers_put_u64(REGISTERS_MANIFEST + 8 + 3 * 64 + PLACIDO_MANIFEST_SIZE, UINT64_MAX);
  assert_description("<another kind>");
}

static void a_manifest_that_lies_is_refused(void **state) {
  (void)state;
  assert_no_description(PLACIDO_INPUT, "no description");
  add(0, 0, XML_1_1, "<endless>");
  for (int i = 1; i < 20; i++) {
    registers_describe(i, 0, 0, 0, 0);
  }
  registers_put_u64(REGISTERS_MANIFEST, UINT64_MAX);
  assert_description("<endless>");
  static const uint64_t sizes[] = {0, PLACIDO_U3V_XML_BYTES_MAX + 1, UINT64_MAX, 1ull << 32};
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    registers_reset();
    registers_describe(0, 0, XML_1_1, REGISTERS_FILE, sizes[i]);
    assert_no_description(PLACIDO_INPUT, "1 to 16777216 are possible");
  }
  registers_describe(0, 0, XML_1_1, UINT64_MAX - 5, 10);
  assert_no_description(PLACIDO_INPUT, "cannot be at 0xfffffffffffffffa");
  registers_describe(0, 0, XML_1_1, REGISTERS_BYTES, 10);
  assert_no_description(PLACIDO_UNSUPPORTED, "no such address");
  registers_put_u64(PLACIDO_ABRM_MANIFEST_ADDRESS, 0);
  assert_no_description(PLACIDO_INPUT, "cannot be at 0x0");
  registers_put_u64(PLACIDO_ABRM_MANIFEST_ADDRESS, UINT64_MAX - 100);
  assert_no_description(PLACIDO_INPUT, "cannot be at");
}

static void a_damaged_zip_is_refused(void **state) {
  (void)state;
  uint8_t bytes[sizeof zip_bytes];
  static const struct {
    size_t place;
    uint8_t value;
    const char *said;
  } cases[] = {
      {ZIP_CHECKSUM, 0, "damaged"},
      {80, 0xff, "damaged"},                  /* within the deflated bytes */
      {sizeof zip_bytes - 20, 0, "damaged"},  /* the end's magic */
      {ZIP_SIZE_CENTRAL, 0x2e, "damaged"},    /* one byte less than there is */
      {ZIP_SIZE_CENTRAL, 0x30, "damaged"},    /* one more */
      {ZIP_SIZE_CENTRAL + 3, 0x7f, "1 to 16777216"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    describe_zipped();
    memcpy(bytes, zip_bytes, sizeof bytes);
    bytes[cases[i].place] = cases[i].value;
    if (cases[i].place == ZIP_SIZE_CENTRAL) {
      bytes[ZIP_SIZE_LOCAL] = cases[i].value;
    }
    registers_put(REGISTERS_FILE, bytes, sizeof bytes);
    assert_no_description(PLACIDO_INPUT, cases[i].said);
  }
  registers_describe(0, 0, ZIP_1_1, REGISTERS_FILE, 100); /* cut short */
  registers_put(REGISTERS_FILE, zip_bytes, sizeof zip_bytes);
  assert_no_description(PLACIDO_INPUT, "damaged");
  static const uint8_t empty[22] = {'P', 'K', 5, 6};
  uint8_t emptied[26] = {'P', 'K', 3, 4};
  memcpy(emptied + 4, empty, sizeof empty);
  registers_describe(0, 0, ZIP_1_1, REGISTERS_FILE, sizeof emptied);
  registers_put(REGISTERS_FILE, emptied, sizeof emptied);
  assert_no_description(PLACIDO_INPUT, "zipped description is");
}

/* A zip of `size` zeros called NAME; returns how many bytes it has. */
static size_t make_bomb(size_t size) {
  zip_source_t *whole = zip_source_buffer_create(NULL, 0, 0, NULL);
  assert_non_null(whole);
  zip_source_keep(whole);
  zip_t *archive = zip_open_from_source(whole, ZIP_CREATE | ZIP_TRUNCATE, NULL);
  char *zeros = placido_memory_new(size, 1, NULL);
  assert_true(archive && zeros);
  zip_source_t *member = zip_source_buffer(archive, zeros, size, 0);
  assert_true(zip_file_add(archive, "a.xml", member, 0) >= 0);
  assert_int_equal(zip_close(archive), 0);
  placido_memory_free(zeros);
  assert_int_equal(zip_source_open(whole), 0);
  const zip_int64_t bytes = zip_source_read(whole, registers.bytes + REGISTERS_FILE,
                                            REGISTERS_BYTES - REGISTERS_FILE);
  assert_true(bytes > 0);
  zip_source_close(whole);
  zip_source_free(whole);
  return (size_t)bytes;
}

static void a_zip_that_swells_is_refused(void **state) {
  (void)state;
  const size_t size = make_bomb(PLACIDO_U3V_XML_BYTES_MAX + 1);
  registers_describe(0, 0, ZIP_1_1, REGISTERS_FILE, size);
  assert_no_description(PLACIDO_INPUT, "unzipped description has 16777217 bytes");
}

/* All that is asked of a camera before it streams. */
static int read_all(placido_error *err) {
  placido_u3v_bootstrap bootstrap;
  char *xml;
  size_t size;
  int status = open_channel(err);
  if (!status) {
    status = placido_u3v_bootstrap_read(&bootstrap, &channel, err);
  }
  if (!status) {
    status = placido_u3v_description_read(&xml, &size, &channel, err);
    placido_memory_free(xml);
  }
  return status;
}

/* What comes of every call failing in its turn, once or from then on. */
static void every_call_may_fail(void **state) {
  (void)state;
  static const struct {
    enum placido_u3v_end end;
    int once, for_ever;
  } cases[] = {
      {PLACIDO_U3V_TIMED_OUT, PLACIDO_OK, PLACIDO_TIMEOUT},
      {PLACIDO_U3V_STALLED, PLACIDO_OK, PLACIDO_SYSTEM},
      {PLACIDO_U3V_OVERFLOW, PLACIDO_OK, PLACIDO_SYSTEM},
      {PLACIDO_U3V_CANCELLED, PLACIDO_OK, PLACIDO_SYSTEM},
      {PLACIDO_U3V_FAILED, PLACIDO_OK, PLACIDO_SYSTEM},
      {PLACIDO_U3V_GONE, PLACIDO_GONE, PLACIDO_GONE},
  };
  describe_zipped();
  assert_int_equal(read_all(NULL), PLACIDO_OK);
  const int calls = registers.call_count;
  assert_true(calls > 30);
  for (int i = 0; i < 2 * calls * (int)(sizeof cases / sizeof *cases); i++) {
    placido_error err = {0};
    const int n = i / 2 % calls + 1, which = i / 2 / calls;
    set_up(NULL);
    describe_zipped();
    registers.fail_at = n;
    registers.fail_end = cases[which].end;
    registers.fails_for_ever = i % 2;
    const int status = read_all(&err);
    const bool is_opening = n <= 8; /* the channel's own four questions */
    const int expected = !registers.fails_for_ever ? cases[which].once
                         : is_opening && cases[which].for_ever == PLACIDO_TIMEOUT
                             ? PLACIDO_SYSTEM
                             : cases[which].for_ever;
    assert_int_equal(status, expected);
    assert_int_equal(err.status == PLACIDO_OK, status == PLACIDO_OK);
  }
}

static void every_allocation_may_fail(void **state) {
  (void)state;
  describe_zipped();
  int status = PLACIDO_MEMORY, failures = 0;
  for (unsigned long n = 1; status == PLACIDO_MEMORY; n++) {
    placido_memory_fail_at(n);
    status = read_all(NULL);
    placido_memory_fail_at(0);
    failures += status == PLACIDO_MEMORY;
  }
  assert_int_equal(status, PLACIDO_OK);
  assert_int_equal(failures, 3); /* the channel, the file, the XML in it */
}

/* Each answer in time, and yet for ever. */
static void a_camera_that_dawdles_is_given_up(void **state) {
  (void)state;
  registers_describe(0, 0, XML_1_1, REGISTERS_FILE, 500000);
  registers.answer_ms = 190;
  assert_no_description(PLACIDO_TIMEOUT, "takes too long");
  assert_true(registers.clock_ns < INT64_C(70000000000));
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
  const struct CMUnitTest tests[] = {
      TEST(the_camera_tells_who_it_is),
      TEST(its_strings_fit_a_line),
      TEST(registers_that_old_cameras_lack_are_done_without),
      TEST(a_camera_without_a_stream_is_refused),
      TEST(a_description_is_read_plain_or_zipped),
      TEST(the_best_of_the_manifest_is_taken),
      TEST(a_manifest_that_lies_is_refused),
      TEST(a_damaged_zip_is_refused),
      TEST(a_zip_that_swells_is_refused),
      TEST(every_call_may_fail),
      TEST(every_allocation_may_fail),
      TEST(a_camera_that_dawdles_is_given_up),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
