/* The table of effects of one picture, in report.html. */
#ifndef PLACIDO_REPORT_PAGE_PLAN_H
#define PLACIDO_REPORT_PAGE_PLAN_H

#include "report/report.h"

/* Every effect, run or left out, with its bound, cost and sentence; nothing where none was planned. */
void placido_page_plan(FILE *stream, const char *scene, const placido_report_plan *plan);

#endif
