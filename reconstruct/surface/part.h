/* What every kind of part can do: one row a kind, listed in table.c. */
#ifndef PLACIDO_SURFACE_PART_H
#define PLACIDO_SURFACE_PART_H

#include "base/json.h"

#include <placido/surface.h>

/* A parameter that makes no sense: which one, and why. */
typedef struct placido_complaint {
  char field[48];
  char reason[160];
} placido_complaint;

enum placido_field_range { PLACIDO_FIELD_FINITE, PLACIDO_FIELD_NONZERO, PLACIDO_FIELD_POSITIVE };

/* A parameter that is one number. */
typedef struct placido_part_field {
  const char *name;
  size_t offset; /* of the double within placido_part */
  enum placido_field_range range;
  bool optional; /* missing in a file: `fallback`, or the value of another field */
  double fallback;
  size_t fallback_offset; /* of that other field, which stands before this one; 0: none */
} placido_part_field;

/* Points of one height: from number `first` of a sheet's columns on. */
typedef struct placido_line {
  const double *x_mm; /* of the first */
  double y_mm;
  size_t first, count;
  double *work;          /* as many numbers as the part has asked for */
  double *sag, *sx, *sy; /* what the part adds to */
} placido_line;

/* One kind of part. */
typedef struct placido_part_row {
  const char *name; /* its "kind" in files */
  const placido_part_field *fields;
  size_t field_count;
  const char *const *other_keys; /* keys in files that are not fields, NULL-terminated; or NULL */

  /* What no single field's range tells; false with the complaint filled. May be NULL. */
  bool (*check)(const placido_part *part, placido_complaint *complaint);

  /* Makes what `add` works from, a block that `release` frees. Arrays that `part` borrows are
   * copied and `part` is pointed at the copies. The part has passed the check. */
  int (*prepare)(void **state, placido_part *part, placido_error *err);
  void (*release)(void *state);

  /* Adds the part's jet at (x, y); false where the part is not defined. */
  bool (*add)(const void *state, double x_mm, double y_mm, placido_jet *jet);

  /* Adds sag and slopes along a line, NaN where the part is not defined. NULL: `add` will do. */
  void (*add_line)(const void *state, const void *columns, const placido_line *line);

  /* What add_line needs for every x of a sheet, `*columns`, one block; and how many numbers it has
   * to work in. NULL where it needs nothing. */
  int (*make_columns)(void **columns, size_t *work, const void *state, const double *x_mm,
                      size_t count, placido_error *err);

  /* What is not a field, from and to a file; both or neither. `*storage` gets the block that the
   * part's arrays point into; the caller frees it with placido_memory_free, whatever the status. */
  int (*read)(placido_part *part, void **storage, const placido_json *json, const char *path,
              placido_error *err);
  int (*write)(json_t *object, const placido_part *part);
} placido_part_row;

/* The rows in the order of placido_part_kind. */
extern const placido_part_row *const placido_part_rows[PLACIDO_PART_KINDS];

extern const placido_part_row placido_part_biconic, placido_part_bump, placido_part_ablation,
    placido_part_zernike, placido_part_ridge, placido_part_bspline;

/* Fills a complaint. Returns false, so that a check can end with it. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bool placido_part_complain(placido_complaint *complaint, const char *field, const char *format,
                           ...);

/* Whether every parameter makes sense. */
bool placido_part_check(const placido_part *part, placido_complaint *complaint);

/* Reads and checks the part at `path`; storage as in the row's read. */
int placido_part_read(placido_part *part, void **storage, const placido_json *json,
                      const char *path, placido_notes *notes, placido_error *err);

/* The part as a JSON object, a new reference; NULL when memory is out. */
json_t *placido_part_write(const placido_part *part);

/* An array of numbers, a new reference; NULL when memory is out. */
json_t *placido_part_numbers(const double *values, size_t count);

#endif
