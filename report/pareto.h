/* Error against time: settings as points, the efficient ones joined, as figures and a page. */
#ifndef PLACIDO_REPORT_PARETO_H
#define PLACIDO_REPORT_PARETO_H

#include <placido/status.h>
#include <stddef.h>

#define PLACIDO_PARETO_POINTS_MAX 128

typedef struct placido_pareto_point {
  double ms, error;    /* both above 0 are drawn; an error of 0 stands at the lower rim */
  const char *setting; /* borrowed, as people read it */
} placido_pareto_point;

typedef struct placido_pareto {
  const char *title;      /* borrowed */
  const char *error_name; /* with its unit */
  double floor;           /* error that is left whatever the settings; NaN: not drawn */
  size_t count;           /* up to PLACIDO_PARETO_POINTS_MAX */
  const placido_pareto_point *points;
} placido_pareto;

/* The points that no other one beats in both time and error, by rising time, into `front` (room for
 * PLACIDO_PARETO_POINTS_MAX). Returns how many. */
size_t placido_pareto_front(size_t *front, const placido_pareto *pareto);

/* Draws it on logarithmic axes, as PNG or, where the path ends in .svg, as SVG. PLACIDO_OK,
 * PLACIDO_INPUT (nothing to draw), PLACIDO_MEMORY, PLACIDO_SYSTEM. */
int placido_figure_pareto(const placido_pareto *pareto, const char *path, placido_error *err);

#define PLACIDO_PARETO_SENTENCES_MAX 8

/* A section of the page: a figure, what it says, and the efficient settings as a table. */
typedef struct placido_pareto_section {
  placido_pareto pareto;
  const char *picture; /* PNG in the page's folder */
  size_t sentence_count;
  const char *sentences[PLACIDO_PARETO_SENTENCES_MAX];
} placido_pareto_section;

typedef struct placido_pareto_page {
  const char *machine, *created, *software; /* borrowed */
  double probe_ms;
  const placido_pareto_section *sections;
  size_t count;
} placido_pareto_page;

/* Writes folder/accuracy.html with the pictures embedded. */
int placido_report_pareto_write(const placido_pareto_page *page, const char *folder,
                                placido_error *err);

#endif
