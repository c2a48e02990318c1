/* A camera that is nothing but its registers: it answers reads and writes, and fails on command. */
#ifndef PLACIDO_TESTS_DRIVERS_U3V_REGISTERS_H
#define PLACIDO_TESTS_DRIVERS_U3V_REGISTERS_H

#include "drivers/u3v/pipe.h"

#define REGISTERS_BYTES (1u << 20)
#define REGISTERS_SBRM 0x10000u
#define REGISTERS_SIRM 0x20000u
#define REGISTERS_MANIFEST 0x30000u
#define REGISTERS_FILE 0x40000u

typedef struct u3v_registers {
  uint8_t *bytes;                       /* of addresses 0 to REGISTERS_BYTES */
  uint64_t refused_from, refused_up_to; /* where it says that there is no such address */
  int answer_ms;                        /* time that every answer takes */
  int64_t clock_ns;
  uint8_t answer[70000];
  size_t answer_size;

  /* which call ends otherwise: the fail_at-th (1 = the next), and those behind it too */
  int fail_at, call_count;
  enum placido_u3v_end fail_end;
  bool fails_for_ever;
} u3v_registers;

extern u3v_registers registers;
extern const placido_u3v_calls u3v_registers_calls;

/* A camera with a stream, without a description. */
void registers_reset(void);
void registers_free(void);
void registers_put(uint64_t address, const void *bytes, size_t size);
void registers_put_u32(uint64_t address, uint32_t value);
void registers_put_u64(uint64_t address, uint64_t value);
/* Entry `i` of the manifest, which then has so many; and the file it points to. */
void registers_describe(int i, uint32_t version, uint32_t schema, uint64_t address, uint64_t size);

#endif
