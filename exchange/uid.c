/* A UUID of version 4 (chance) or 8 (of a text) as one decimal number behind 2.25 (RFC 9562). */
#include "exchange/uid.h"

#include "base/random.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>

#define WORDS 4
#define DIGITS_MAX 40

/* FNV-1a, 64 bits (Fowler, Noll, Vo). */
static uint64_t hash(const char *text) {
  uint64_t sum = 0xcbf29ce484222325u;
  for (; *text; text++) {
    sum = (sum ^ (unsigned char)*text) * 0x100000001b3u;
  }
  return sum;
}

/* The number of four words, the highest first, as decimal digits; the words are used up. */
static void print_decimal(char *text, uint32_t words[WORDS]) {
  char digits[DIGITS_MAX];
  int count = 0;
  do {
    uint64_t rest = 0;
    for (int i = 0; i < WORDS; i++) {
      rest = rest << 32 | words[i];
      words[i] = (uint32_t)(rest / 10);
      rest %= 10;
    }
    digits[count++] = (char)('0' + rest);
  } while (words[0] | words[1] | words[2] | words[3]);
  while (count > 0) {
    *text++ = digits[--count];
  }
  *text = '\0';
}

int placido_uid_make(char uid[PLACIDO_UID_SIZE], const char *seed, unsigned which,
                     placido_error *err) {
  uint32_t words[WORDS];
  unsigned version = seed ? 8 : 4;
  if (seed) {
    for (unsigned i = 0; i < WORDS; i++) {
      words[i] = (uint32_t)(placido_random_bits(hash(seed), which, i) >> 32);
    }
  } else if (getrandom(words, sizeof words, 0) != (ssize_t)sizeof words) {
    return placido_error_set(err, PLACIDO_SYSTEM, "no random numbers for a unique identifier: %s",
                             strerror(errno));
  }
  words[1] = (words[1] & 0xffff0fffu) | version << 12;
  words[2] = (words[2] & 0x3fffffffu) | 0x80000000u;
  strcpy(uid, "2.25.");
  print_decimal(uid + strlen(uid), words);
  return PLACIDO_OK;
}
