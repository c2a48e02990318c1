/* What a fallible function returns, and the note that says why it failed.
 *
 * Every fallible function returns PLACIDO_OK or one of the negative codes below and takes a
 * last parameter `placido_error *err`, which may be NULL. Whoever detects a failure writes the
 * message; whoever passes it on only returns the status. */
#ifndef PLACIDO_STATUS_H
#define PLACIDO_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

enum placido_status {
  PLACIDO_OK = 0,
  PLACIDO_MEMORY = -1,      /* an allocation failed */
  PLACIDO_INPUT = -2,       /* a file or an argument is not what its format says */
  PLACIDO_SYSTEM = -3,      /* the operating system refused: open, write, rename ... */
  PLACIDO_QUALITY = -4,     /* measured, and not good enough to give an answer */
  PLACIDO_UNSUPPORTED = -5, /* understood, but this build or device cannot do it */
  PLACIDO_END = -6,         /* the stream has no further frame */
  PLACIDO_TIMEOUT = -7,     /* the deadline passed */
  PLACIDO_GONE = -8,        /* the device is not there any longer: unplugged */
};

/* A fixed-size note on the caller's stack. `text` is one line without a trailing newline. */
typedef struct placido_error {
  int status;
  char text[512];
} placido_error;

/* Writes the formatted text and status into `err` (nothing where err is NULL).
 * Control characters become spaces, so that a message is always one line.
 * Returns `status`, so that a failing function can end with `return placido_error_set(...)`. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int placido_error_set(placido_error *err, int status, const char *format, ...);

#ifdef __cplusplus
}
#endif
#endif
