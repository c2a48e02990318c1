/* What goes wrong when in a replay: a script of one fault a line, such as "at frame 12 drop 3"
 * (docs/formats.md). */
#ifndef PLACIDO_DRIVERS_REPLAY_FAULTS_H
#define PLACIDO_DRIVERS_REPLAY_FAULTS_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PLACIDO_FAULTS_MAX 256

enum placido_fault_kind {
  PLACIDO_FAULT_DROP,       /* the frame does not come */
  PLACIDO_FAULT_TRUNCATE,   /* its lower half is missing */
  PLACIDO_FAULT_CORRUPT,    /* some of its rows are garbled */
  PLACIDO_FAULT_DAMAGE,     /* it cannot be decoded */
  PLACIDO_FAULT_DELAY,      /* it comes late */
  PLACIDO_FAULT_DISCONNECT, /* the device is unplugged */
  PLACIDO_FAULT_ERROR,      /* the device reports an error in its stead */
  PLACIDO_FAULT_KINDS
};

typedef struct placido_fault {
  enum placido_fault_kind kind;
  bool is_by_time;
  int64_t at;          /* number of the frame from 0, or ns since the first frame */
  int64_t frames;      /* it strikes so many in a row, at least 1 */
  int64_t duration_ns; /* of a delay or a disconnection; INT64_MAX: for ever */
} placido_fault;

typedef struct placido_faults {
  size_t count;
  placido_fault list[PLACIDO_FAULTS_MAX];
} placido_faults;

/* Reads a script of `size` bytes; `name` stands in the messages with the line's number. Returns
 * PLACIDO_OK or PLACIDO_INPUT. */
int placido_faults_parse(placido_faults *faults, const char *text, size_t size, const char *name,
                         placido_error *err);

/* Reads a script's file. PLACIDO_SYSTEM and PLACIDO_MEMORY besides. */
int placido_faults_load(placido_faults *faults, const char *path, placido_error *err);

#endif
