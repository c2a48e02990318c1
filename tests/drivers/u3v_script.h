/* A camera's control channel played from a written dialogue, with a clock of its own. */
#ifndef PLACIDO_TESTS_DRIVERS_U3V_SCRIPT_H
#define PLACIDO_TESTS_DRIVERS_U3V_SCRIPT_H

#include "drivers/u3v/pipe.h"

/* The dialogue has one thing a line, in the order it has to happen:
 *   > 55335643 0040 ...   what is written, in hexadecimal; blanks do not count
 *   > stall               a write that ends so
 *   < 55335643 0000 ...   what is read
 *   < stall               a read that ends so; also timeout, overflow, cancelled, failed, gone
 *   < late 5533...        what is read, though the transfer only ends with its time
 *   after 300             so many ms pass before the next answer
 *   reset                 the endpoints are reset
 *   sleep 20              so many ms are slept
 * What happens otherwise fails the test; a read without a line waits in vain. */
typedef struct u3v_script {
  const char *next; /* what is still to happen */
  int64_t clock_ns;
  int delay_ms;     /* until the next answer */
  size_t packet_bytes, read_size;
} u3v_script;

extern const placido_u3v_calls u3v_script_calls; /* each, open and the stream's calls are NULL */
extern u3v_script script;

void script_play(const char *dialogue);
/* Fails the test where something of the dialogue did not happen. */
void script_assert_over(void);

#endif
