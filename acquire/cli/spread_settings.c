/* From the options about the convolution to what the library takes. */
#include "acquire/cli/spread_settings.h"

#include "acquire/cli/settings.h"

placido_convolution spread_settings_read(char folder[PLACIDO_PATH_MAX],
                                         const struct settings *settings, int threads,
                                         placido_notes *notes) {
  placido_convolution how = {.doubles = settings->spread.doubles,
                             .memory_MB = settings->spread.memory_MB,
                             .threads = threads};
  placido_error reason = {0};
  if (!settings->spread.wisdom) {
    return how;
  }
  if (placido_wisdom_folder(folder, PLACIDO_PATH_MAX, &reason) == PLACIDO_OK) {
    how.wisdom_folder = folder;
  } else {
    placido_notes_add(notes, "transforms are not measured: %s", reason.text);
  }
  return how;
}
