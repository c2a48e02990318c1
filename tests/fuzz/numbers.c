/* How libFuzzer changes texts: besides its own ways, a number becomes another one, so that a file
 * stays one that its reader can parse. */
#include "tests/fuzz/target.h"

#include <stdlib.h>
#include <string.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t size_max);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t size_max, unsigned seed);

static const char *const numbers[] = {
    "0",      "-0",    "1",      "-1",    "2",     "3",     "4",      "5",       "8",     "10",
    "16",     "100",   "255",    "256",   "1024",  "4096",  "65535",  "65536",   "65537", "1e5",
    "1e6",    "1e9",   "-1e9",   "1e10",  "1e15",  "1e18",  "1e19",   "1e150",   "1e300", "-1e300",
    "1e308",  "1.8e308", "1e-3", "1e-6",  "1e-9",  "1e-12", "1e-150", "1e-300",  "5e-324",
    "0.1",    "0.5",   "0.05",   "-0.5",  "1.5",   "90",    "180",    "360",     "45.5",  "7.8",
    "2147483647", "2147483648", "-2147483648", "4294967295", "4294967296",
    "9223372036854775807", "9223372036854775808", "-9223372036854775808",
    "0.30000000000000004", "null", "true", "[]", "{}", "\"\""};

static int is_digit(uint8_t c) {
  return c >= '0' && c <= '9';
}

/* Where the number-th number of the text stands; false: it has fewer. */
static int find_number(size_t *begin, size_t *end, const uint8_t *data, size_t size,
                       size_t number) {
  for (size_t i = 0; i < size; i++) {
    if (!is_digit(data[i])) {
      continue;
    }
    *begin = i > 0 && data[i - 1] == '-' ? i - 1 : i;
    while (i < size && (is_digit(data[i]) || memchr(".eE+-", data[i], 5))) {
      i++;
    }
    *end = i;
    if (number-- == 0) {
      return 1;
    }
  }
  return 0;
}

static size_t count_numbers(const uint8_t *data, size_t size) {
  size_t count = 0, begin, end = 0;
  for (size_t at = 0; find_number(&begin, &end, data + at, size - at, 0); at += end) {
    count++;
  }
  return count;
}

static size_t replace(uint8_t *data, size_t size, size_t size_max, unsigned seed) {
  size_t count = count_numbers(data, size), begin, end;
  if (count == 0 || !find_number(&begin, &end, data, size, (seed >> 8) % count)) {
    return size;
  }
  const char *number = numbers[(seed >> 2) % (sizeof numbers / sizeof *numbers)];
  size_t length = strlen(number), size_new = size - (end - begin) + length;
  if (size_new > size_max) {
    return size;
  }
  memmove(data + begin + length, data + end, size - end);
  memcpy(data + begin, number, length);
  return size_new;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t size_max, unsigned seed) {
  if (seed % 4 != 0) {
    size = LLVMFuzzerMutate(data, size, size_max);
  }
  return seed % 4 < 2 ? replace(data, size, size_max, seed ^ seed << 13) : size;
}
