/* The accuracy test of ISO 19980 / ANSI Z80.23 as figure and page. */
#ifndef PLACIDO_REPORT_ISO_H
#define PLACIDO_REPORT_ISO_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

#define PLACIDO_ISO_ZONES 3
#define PLACIDO_ISO_CHECKS_MAX 8

/* Differences, measured less known, over a ring about the instrument's axis; area weighted. NaN
 * where nothing of it was measured. */
typedef struct placido_iso_zone {
  double inner_mm, outer_mm; /* diameters; the last zone's outer is infinite */
  long points;
  double covered;            /* share of the ring's area that was measured */
  double axial_mean_D, axial_2sd_D, elevation_mean_um, elevation_2sd_um;
} placido_iso_zone;

/* One target. The strings are constants. */
typedef struct placido_iso_check {
  const char *name, *unit;
  double value, limit;
  bool passed;
} placido_iso_check;

/* What one object gave. */
typedef struct placido_iso_result {
  const char *object, *image; /* borrowed; image is NULL or empty where the phantom rendered it */
  placido_iso_zone zones[PLACIDO_ISO_ZONES];
  double elevation_rms_6_um;
  double shift_mm[3];  /* by which the known shape was moved to where it fits best */
  char failure[512];   /* why there is no measurement; empty: there is one */
  size_t check_count;
  placido_iso_check checks[PLACIDO_ISO_CHECKS_MAX];
  bool passed;
} placido_iso_result;

/* What the page says above its tables; borrowed. */
typedef struct placido_iso_report {
  const char *instrument, *software, *created, *note;
  const placido_iso_result *results;
  size_t count;
} placido_iso_report;

/* Mean and twice the standard deviation of every object and zone, with the targets. */
int placido_figure_iso(const placido_iso_result *results, size_t count, const char *path,
                       placido_error *err);

/* Writes folder/iso-check.html with the picture folder/`picture` embedded. */
int placido_report_iso_write(const placido_iso_report *report, const char *folder,
                             const char *picture, placido_error *err);

#endif
