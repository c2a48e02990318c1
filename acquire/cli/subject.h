/* Who sits before which instrument: by the name of something built in, or from a file. */
#ifndef PLACIDO_CLI_SUBJECT_H
#define PLACIDO_CLI_SUBJECT_H

#include <placido/instrument.h>
#include <placido/surface.h>
#include <stdbool.h>

/* A word with a slash or ".json" is a file, any other a name of the built-in list. `*surface` is
 * the caller's, to be freed with placido_surface_free. */
int subject_eye(placido_surface **surface, const char *word, placido_notes *notes,
                placido_error *err);
int subject_instrument(placido_instrument *instrument, const char *word, placido_notes *notes,
                       placido_error *err);

/* Whether there is more than the ending. */
bool subject_has_ending(const char *word, const char *ending);

#endif
