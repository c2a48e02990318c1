/* Warnings that go with a result: a list of sentences that the program shows and stores.
 * A library never prints; what a person should know beside the answer goes here. */
#ifndef PLACIDO_NOTES_H
#define PLACIDO_NOTES_H

#include <stddef.h>

typedef struct placido_notes {
  size_t count;
  char **lines; /* owned by the list */
} placido_notes;

/* Adds one formatted line. `notes` may be NULL (the line is dropped). A line that stands in the
 * list already is not added again. When memory runs out the line is lost: a warning is never a
 * reason to fail. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void placido_notes_add(placido_notes *notes, const char *format, ...);

/* Frees the lines and leaves an empty list. */
void placido_notes_clear(placido_notes *notes);

#endif
