/* The table of effects of one picture: which ran, which were left out, and why. */
#include "report/page_plan.h"

#include "report/html.h"
#include "report/number.h"

#include <math.h>

static void write_seconds(FILE *stream, const char *before, double seconds) {
  char number[PLACIDO_NUMBER_SIZE];
  const bool long_time = seconds >= 1;
  if (isfinite(seconds)) {
    placido_number_significant(number, sizeof number, long_time ? seconds : 1000 * seconds, 2);
    placido_html_print(stream, "%s %s %s", before, number, long_time ? "s" : "ms");
  }
}

/* What is read when the table is closed. */
static void write_summary(FILE *stream, const char *scene, const placido_report_plan *plan) {
  char promised[PLACIDO_NUMBER_SIZE];
  size_t run = 0;
  bool forced_off = false;
  for (size_t i = 0; i < plan->count; i++) {
    run += plan->verdicts[i].runs;
    forced_off |= plan->verdicts[i].force == PLACIDO_FORCE_OFF && plan->verdicts[i].applies;
  }
  fputs("<summary>", stream);
  placido_html_text(stream, scene);
  placido_number_significant(promised, sizeof promised, fmin(plan->promised, 1), 2);
  placido_html_print(stream,
                     ": %zu of %zu effects ran; at most %s of white is wrong%s, tolerance %g", run,
                     plan->count, promised, forced_off ? " beside what was forced off" : "",
                     plan->tolerance);
  write_seconds(stream, "; planned in", plan->planning_s);
  write_seconds(stream, ", predicted to take", plan->predicted_s);
  write_seconds(stream, ", took", plan->run_s);
  fputs("</summary>\n", stream);
}

/* Two digits; an effect that has nothing to do has no number. */
static void write_number(FILE *stream, double value, double least, bool given) {
  char number[PLACIDO_NUMBER_SIZE];
  const bool tiny = given && value > 0 && value < least;
  placido_number_significant(number, sizeof number, tiny ? least : given ? value : (double)NAN,
                             tiny ? 1 : 2);
  fprintf(stream, "<td class=\"number\">%s%s</td>", tiny ? "&lt; " : "", number);
}

static const char *outcome(const placido_verdict *verdict) {
  const char *not_run = verdict->applies ? "left out" : "nothing to do";
  return verdict->runs ? "ran" : not_run;
}

static void write_verdict(FILE *stream, const placido_verdict *verdict) {
  fprintf(stream, "<tr class=\"%s\"><th scope=\"row\">", verdict->runs ? "ran" : "out");
  placido_html_text(stream, verdict->name);
  fputs("</th><td>", stream);
  placido_html_print(stream, "%s%s", outcome(verdict),
                     verdict->force == PLACIDO_FORCE_NONE ? "" : ", as asked for");
  fputs("</td>", stream);
  write_number(stream, verdict->bound, 1e-4, verdict->applies);
  write_number(stream, verdict->cost_ms, 0.1, verdict->applies);
  fputs("<td>", stream);
  placido_html_text(stream, verdict->reason);
  fputs("</td></tr>\n", stream);
}

void placido_page_plan(FILE *stream, const char *scene, const placido_report_plan *plan) {
  if (plan->count == 0) {
    return;
  }
  fputs("<details class=\"plan\" open>\n", stream);
  write_summary(stream, scene, plan);
  fputs("<table>\n<thead><tr><th scope=\"col\">Effect</th><th scope=\"col\">Verdict</th>"
        "<th scope=\"col\" class=\"number\">Error without</th>"
        "<th scope=\"col\" class=\"number\">Cost, ms</th>"
        "<th scope=\"col\">Why</th></tr></thead>\n<tbody>\n", stream);
  for (size_t i = 0; i < plan->count; i++) {
    write_verdict(stream, &plan->verdicts[i]);
  }
  fputs("</tbody>\n</table>\n</details>\n", stream);
}
