/* The table in memory: rows that only grow in number, and where a user's own one is kept. */
#include "acquire/cli/accuracy/table.h"

#include "base/memory.h"

#include <placido/convolution.h>

#include <stdio.h>
#include <string.h>

const char *const accuracy_stage_names[ACCURACY_STAGES] = {
    [ACCURACY_MIRES] = "mires",
    [ACCURACY_FIT] = "fit",
    [ACCURACY_TRACE] = "trace",
    [ACCURACY_PSF] = "psf",
    [ACCURACY_CONVOLUTION] = "convolution",
    [ACCURACY_ACUITY] = "acuity",
    [ACCURACY_REST] = "rest",
    [ACCURACY_FLOOR] = "floor",
    [ACCURACY_EXAM] = "exam",
};

const char *const accuracy_error_names[ACCURACY_ERRORS] = {
    [ACCURACY_ELEVATION_UM] = "elevation_um", [ACCURACY_AXIAL_D] = "axial_D",
    [ACCURACY_PSF_OTF] = "psf_otf",           [ACCURACY_IMAGE] = "image",
    [ACCURACY_LOGMAR] = "logmar",
};

/* Texts stand in the file as they are, without quotes. */
static int check_text(const char *what, const char *text, size_t size, placido_error *err) {
  if (memchr(text, '\0', size) == NULL) {
    return placido_error_set(err, PLACIDO_INPUT, "an accuracy table's %s is too long", what);
  }
  for (const char *c = text; *c; c++) {
    if ((unsigned char)*c < ' ' || *c == ',' || *c == '"') {
      return placido_error_set(err, PLACIDO_INPUT,
                               "an accuracy table's %s has neither commas, quotes nor control "
                               "characters: \"%s\"", what, text);
    }
  }
  return PLACIDO_OK;
}

int accuracy_table_add(struct accuracy_table *table, const struct accuracy_row *row,
                       placido_error *err) {
  int status = check_text("setting", row->setting, sizeof row->setting, err);
  if (status == PLACIDO_OK) {
    status = check_text("eye", row->eye, sizeof row->eye, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  struct accuracy_row *rows =
      placido_memory_grow(table->rows, table->count + 1, sizeof *rows, err);
  if (!rows) {
    return PLACIDO_MEMORY;
  }
  table->rows = rows;
  table->rows[table->count++] = *row;
  return PLACIDO_OK;
}

int accuracy_table_path(char *path, size_t size, placido_error *err) {
  static const char name[] = "/accuracy.csv";
  const int status = placido_wisdom_folder(path, size, err);
  const size_t length = status == PLACIDO_OK ? strlen(path) : 0;
  if (status == PLACIDO_OK && length + sizeof name > size) {
    path[0] = '\0';
    return placido_error_set(err, PLACIDO_SYSTEM, "the cache folder's name is too long");
  }
  if (status == PLACIDO_OK) {
    memcpy(path + length, name, sizeof name);
  }
  return status;
}

void accuracy_table_free(struct accuracy_table *table) {
  placido_memory_free(table->rows);
  *table = (struct accuracy_table){0};
}
