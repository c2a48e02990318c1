/* Frames of a session as picture files, every sample as it is. */
#include "base/session/archive.h"
#include "base/session/reader.h"
#include "base/session/tiff.h"
#include "base/text.h"

#include <placido/image.h>

#include <inttypes.h>
#include <stdio.h>

static const struct {
  const char *ending;
  int (*save)(const placido_frame *frame, const char *path, placido_error *err);
} types[] = {
    [PLACIDO_EXPORT_PNG] = {"png", placido_frame_save_png},
    [PLACIDO_EXPORT_TIFF] = {"tiff", placido_tiff_save},
};

static int save_frame(const placido_frame *frame, int64_t index, const char *folder,
                      enum placido_export_type type, placido_error *err) {
  char name[64], path[PLACIDO_PATH_MAX];
  snprintf(name, sizeof name, "frame-%06" PRId64 ".%s", index, types[type].ending);
  int status = placido_path_join(path, folder, name, err);
  return status ? status : types[type].save(frame, path, err);
}

/* Whether every wanted number is below `count`. */
static int check_wanted(const placido_ranges *wanted, int64_t count, const char *path,
                        placido_error *err) {
  for (size_t i = 0; i < wanted->count; i++) {
    if (wanted->items[i].last >= count) {
      return placido_error_set(err, PLACIDO_INPUT,
                               "%s has no frame %" PRId64 " (it has %" PRId64
                               ", counted from 0)",
                               placido_text_tail(path), wanted->items[i].last, count);
    }
  }
  return PLACIDO_OK;
}

int placido_session_export(int64_t *count, const char *path, const char *folder,
                           const placido_ranges *wanted, enum placido_export_type type,
                           placido_notes *notes, placido_error *err) {
  *count = 0;
  placido_session_reader *reader;
  placido_frame frame = {0};
  int64_t end = 0;
  int status = placido_session_reader_open_torn(&reader, path, notes, err);
  while (!status) {
    placido_error reason = {0};
    status = placido_session_reader_next(reader, &frame, &reason);
    const int64_t index = end;
    end += status != PLACIDO_END;
    const bool asked = wanted->count == 0 || placido_ranges_have(wanted, index);
    if (!status && asked) {
      status = save_frame(&frame, index, folder, type, err);
      *count += status == PLACIDO_OK;
    } else if (status == PLACIDO_INPUT && (!asked || wanted->count == 0)) {
      placido_notes_add(asked ? notes : NULL, "%s: left out", reason.text);
      status = PLACIDO_OK;
    } else if (status) {
      placido_error_set(err, status, "%s", reason.text);
    }
  }
  if (status == PLACIDO_END) {
    status = check_wanted(wanted, end, path, err);
  }
  placido_session_reader_close(reader);
  placido_frame_free(&frame);
  return status;
}
