/* The sections of report.html. Each writes itself whole, heading and all, or nothing where the
 * report has nothing for it; those that embed pictures may fail. */
#ifndef PLACIDO_REPORT_PAGE_H
#define PLACIDO_REPORT_PAGE_H

#include "report/report.h"

#include <stdbool.h>
#include <stdio.h>

/* The style sheet: readable on a screen, and on A4. */
extern const char placido_page_style[];

/* From the doctype to an open table in the header, titled "title: name"; and what every page ends
 * with. */
void placido_page_begin(FILE *stream, const char *title, const char *name);
void placido_page_end(FILE *stream);

void placido_page_head(FILE *stream, const placido_report *report);
void placido_page_warnings(FILE *stream, const placido_report *report);
void placido_page_accuracy(FILE *stream, const placido_report *report);
void placido_page_budget(FILE *stream, const placido_report *report);
/* The key groups of indices, or the others. */
void placido_page_indices(FILE *stream, const placido_report *report, bool key);
int placido_page_capture(FILE *stream, const placido_report *report, placido_error *err);
/* The main maps, or the others and their uncertainty. */
int placido_page_maps(FILE *stream, const placido_report *report, bool main_ones, placido_error *err);
int placido_page_wavefront(FILE *stream, const placido_report *report, placido_error *err);
int placido_page_pupils(FILE *stream, const placido_report *report, placido_error *err);

/* A name such as "simk_flat_D" in words, less its unit: "SimK flat". */
void placido_page_name(FILE *stream, const char *name, const char *unit);

void placido_page_stages(FILE *stream, const placido_report *report);

#endif
