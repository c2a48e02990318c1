/* Who sits before which instrument, by name or from a file. */
#include "acquire/cli/subject.h"

#include <placido/phantom.h>
#include <string.h>

bool subject_has_ending(const char *word, const char *ending) {
  const size_t length = strlen(word), tail = strlen(ending);
  return length > tail && strcmp(word + length - tail, ending) == 0;
}

static bool is_file(const char *word) {
  return strchr(word, '/') || subject_has_ending(word, ".json");
}

int subject_eye(placido_surface **surface, const char *word, placido_notes *notes,
                placido_error *err) {
  *surface = NULL;
  return is_file(word) ? placido_surface_load(surface, word, notes, err)
                       : placido_phantom_eye(surface, word, err);
}

int subject_instrument(placido_instrument *instrument, const char *word, placido_notes *notes,
                       placido_error *err) {
  return is_file(word) ? placido_instrument_load(instrument, word, notes, err)
                       : placido_phantom_instrument(instrument, word, err);
}
