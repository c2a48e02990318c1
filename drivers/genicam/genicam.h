/* A camera's features by their standard names (GenICam SFNC), evaluated from the description that
 * the camera carries (GenApi XML). The registers behind them are reached through a port, so that
 * nothing here knows a bus. */
#ifndef PLACIDO_DRIVERS_GENICAM_GENICAM_H
#define PLACIDO_DRIVERS_GENICAM_GENICAM_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct placido_genicam placido_genicam;

/* Where registers are read and written; the status is passed on. */
typedef struct placido_genicam_port {
  int (*read)(void *user, uint64_t address, void *bytes, size_t size, placido_error *err);
  int (*write)(void *user, uint64_t address, const void *bytes, size_t size, placido_error *err);
  void *user;
} placido_genicam_port;

enum placido_feature_kind {
  PLACIDO_FEATURE_NONE, /* there is none of that name, or a node that holds no value */
  PLACIDO_FEATURE_INTEGER,
  PLACIDO_FEATURE_FLOAT,
  PLACIDO_FEATURE_BOOLEAN,
  PLACIDO_FEATURE_ENUMERATION,
  PLACIDO_FEATURE_COMMAND,
  PLACIDO_FEATURE_STRING,
};

/* A feature as it is now: limits and access may depend on other features. */
typedef struct placido_feature {
  enum placido_feature_kind kind;
  bool can_read, can_write; /* implemented, available, not locked, and of that access mode */
  double min, max, step;    /* of a number; step 0: any value */
  char unit[16];            /* as the description says; empty: none */
} placido_feature;

/* Reads a description of `size` bytes, which is not kept. Nodes whose kind is not known are passed
 * over; external entities are not. Bounded in nodes, text and depth. Free with
 * placido_genicam_free. Returns PLACIDO_OK, PLACIDO_INPUT (not XML, not a description: line and
 * reason), PLACIDO_MEMORY. */
int placido_genicam_read(placido_genicam **features, const char *xml, size_t size,
                         const placido_genicam_port *port, placido_error *err);
void placido_genicam_free(placido_genicam *features);

/* Kind, access and limits of a feature. A name that is not there gives PLACIDO_FEATURE_NONE and
 * PLACIDO_OK. Fails where the registers that it depends on cannot be read, or where nodes go
 * round in a circle (PLACIDO_INPUT). */
int placido_genicam_describe(placido_genicam *features, const char *name,
                             placido_feature *feature, placido_error *err);

/* Values. A number of an integer, float, boolean (0, 1) or enumeration (its entry's value) feature
 * can be read and written as either of both; integers are rounded to the nearest. Writing checks
 * access and limits. Returns PLACIDO_OK, PLACIDO_INPUT (no such feature, out of range, of another
 * kind, a circle, a formula that cannot be evaluated), PLACIDO_UNSUPPORTED (not readable or
 * writable now), or the port's status. */
int placido_genicam_get_integer(placido_genicam *features, const char *name, int64_t *value,
                                placido_error *err);
int placido_genicam_set_integer(placido_genicam *features, const char *name, int64_t value,
                                placido_error *err);
int placido_genicam_get_float(placido_genicam *features, const char *name, double *value,
                              placido_error *err);
int placido_genicam_set_float(placido_genicam *features, const char *name, double value,
                              placido_error *err);
/* The entry's name of an enumeration, or a string register's text; cut where it does not fit. */
int placido_genicam_get_text(placido_genicam *features, const char *name, char *text, size_t size,
                             placido_error *err);
int placido_genicam_set_text(placido_genicam *features, const char *name, const char *text,
                             placido_error *err);
/* Executes a command. */
int placido_genicam_execute(placido_genicam *features, const char *name, placido_error *err);

/* Calls `each` for the entries of an enumeration that are available now; stops with its value where
 * that is not 0. */
int placido_genicam_entries(placido_genicam *features, const char *name,
                            int (*each)(void *user, const char *entry, int64_t value), void *user,
                            placido_error *err);
/* Calls `each` for the features that the category Root holds, in the order of the description. */
int placido_genicam_each(placido_genicam *features,
                         int (*each)(void *user, const char *name, const char *category),
                         void *user, placido_error *err);

/* Forgets what was read of registers, as after another hand has changed them. */
void placido_genicam_forget(placido_genicam *features);

#endif
