/* JSON files whose errors name file, line and field. jansson does the parsing; this adds where a
 * value stands in the text. */
#ifndef PLACIDO_BASE_JSON_H
#define PLACIDO_BASE_JSON_H

#include <jansson.h>
#include <placido/notes.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* A parsed document with its text. Paths below look like "camera.focal_px[1]". */
typedef struct placido_json placido_json;

/* Reads a file and checks its "format" field, e.g. "placido-instrument/1": a file of another
 * format or version is refused by naming both. Free with placido_json_free. */
int placido_json_load(placido_json **json, const char *path, const char *format,
                      placido_error *err);
void placido_json_free(placido_json *json);

/* The value at a path, borrowed from the document; NULL where there is none. "" is the root. */
json_t *placido_json_find(const placido_json *json, const char *path);

/* Required values: PLACIDO_INPUT with "FILE:LINE: field PATH ..." where missing, of another type
 * or (numbers) not finite. Strings are copied, and refused where they do not fit. */
int placido_json_number(const placido_json *json, const char *path, double *value,
                        placido_error *err);
int placido_json_integer(const placido_json *json, const char *path, int min, int max, int *value,
                         placido_error *err);
int placido_json_string(const placido_json *json, const char *path, char *value, size_t size,
                        placido_error *err);
int placido_json_boolean(const placido_json *json, const char *path, bool *value,
                         placido_error *err);
/* An array of exactly `count` numbers. */
int placido_json_numbers(const placido_json *json, const char *path, double *values, size_t count,
                         placido_error *err);
/* How many elements the array (or object) at `path` has. */
int placido_json_count(const placido_json *json, const char *path, size_t *count,
                       placido_error *err);

/* Writes "FILE:LINE: field PATH: " and the formatted text into err and returns PLACIDO_INPUT: for a
 * value that is there but makes no sense. */
#if defined(__GNUC__)
__attribute__((format(printf, 4, 5)))
#endif
int placido_json_refuse(const placido_json *json, const char *path, placido_error *err,
                        const char *format, ...);

/* One warning line in `notes` that lists the keys of the object at `path` which are not among
 * `known` (NULL-terminated). */
void placido_json_warn_unknown(const placido_json *json, const char *path,
                               const char *const *known, placido_notes *notes);

/* Writes `root` (borrowed) to a file by way of a temporary name; numbers with 17 significant
 * digits. NULL is refused as what memory ran out for. NaN and infinity cannot stand in JSON: use placido_json_real, which gives null for
 * them. */
int placido_json_save(const json_t *root, const char *path, placido_error *err);
/* A JSON number, or null where the value is not finite. A new reference, NULL: out of memory. */
json_t *placido_json_real(double value);

#endif
