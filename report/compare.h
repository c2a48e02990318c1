/* Two exams of one eye, or of both eyes, on one page. */
#ifndef PLACIDO_REPORT_COMPARE_H
#define PLACIDO_REPORT_COMPARE_H

#include <placido/difference.h>

/* An index of both exams. NaN: not known. */
typedef struct placido_report_change {
  const char *name, *unit;
  double first, second, difference, sigma;
} placido_report_change;

/* What the page shows; borrowed. */
typedef struct placido_report_comparison {
  const char *names[2], *eyes[2], *created[2]; /* of the exams; eyes and dates may be empty */
  bool mirrored;
  const char *software, *today;
  const placido_alignment *alignment;
  const placido_difference *difference;
  const placido_report_change *changes;
  size_t change_count;
  const placido_notes *notes;
} placido_report_comparison;

/* Writes folder/compare.html with the pictures folder/maps/NAME.png embedded. */
int placido_report_comparison_write(const placido_report_comparison *report, const char *folder,
                                    placido_error *err);

#endif
