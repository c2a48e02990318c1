/* Where a value stands in the text of a JSON document. */
#ifndef PLACIDO_BASE_JSON_PLACE_H
#define PLACIDO_BASE_JSON_PLACE_H

#include <stdbool.h>
#include <stddef.h>

/* One step of a path like "camera.focal_px[1]": a key of an object or an index of an array. */
typedef struct placido_json_step {
  const char *key; /* borrowed from the path; NULL for an index */
  size_t key_length;
  size_t index;
} placido_json_step;

/* Takes the first step off `*path`; false at its end and where it is not a path. */
bool placido_json_step_next(placido_json_step *step, const char **path);

/* The line, counted from 1, of the value at `path` in `text` (valid JSON, zero-terminated); where
 * the value is missing, the line of the innermost object or array on its way that is there. */
int placido_json_line(const char *text, const char *path);

#endif
