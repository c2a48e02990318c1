/* What benchmarks found: kept until the end, so that nothing is printed while time is measured. */
#include "acquire/cli/bench_report.h"

#include "base/json.h"
#include "base/memory.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define UNIT_WIDTH 9
#define TIMES_WIDTH 19

int bench_report_begin(struct bench_report *report, const char *name, const char *summary,
                       placido_error *err) {
  struct bench_section *sections = placido_memory_grow(report->sections, report->count + 1,
                                                       sizeof *sections, err);
  if (!sections) {
    return PLACIDO_MEMORY;
  }
  report->sections = sections;
  sections[report->count++] = (struct bench_section){.name = name, .summary = summary};
  return PLACIDO_OK;
}

int bench_report_add(struct bench_report *report, const struct bench_figure *figure,
                     placido_error *err) {
  struct bench_section *section = &report->sections[report->count - 1];
  struct bench_figure *figures = placido_memory_grow(section->figures, section->count + 1,
                                                     sizeof *figures, err);
  if (!figures) {
    return PLACIDO_MEMORY;
  }
  section->figures = figures;
  figures[section->count++] = *figure;
  return PLACIDO_OK;
}

int bench_report_number(struct bench_report *report, const char *what, double value,
                        const char *unit, double ratio, const char *against, placido_error *err) {
  struct bench_figure figure = {.unit = unit,
                                .value = value,
                                .worst = NAN,
                                .processor = NAN,
                                .ratio = ratio,
                                .against = against};
  snprintf(figure.what, sizeof figure.what, "%s", what);
  return bench_report_add(report, &figure, err);
}

int bench_report_laps(struct bench_report *report, const char *what, const struct bench_laps *laps,
                      const struct bench_laps *reference, const char *against,
                      placido_error *err) {
  struct bench_figure figure = {
      .unit = "ms",
      .value = 1e3 * bench_median(laps->wall_s, laps->count),
      .worst = 1e3 * bench_most(laps->wall_s, laps->count),
      .processor = 1e3 * bench_median(laps->processor_s, laps->count),
      .ratio = reference ? bench_ratio(laps, reference) : NAN,
      .against = against,
  };
  snprintf(figure.what, sizeof figure.what, "%s", what);
  return bench_report_add(report, &figure, err);
}

int bench_report_say(struct bench_report *report, placido_error *err, const char *format, ...) {
  struct bench_section *section = &report->sections[report->count - 1];
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  char **lines =
      placido_memory_grow(section->lines, section->line_count + 1, sizeof *lines, err);
  if (!lines) {
    return PLACIDO_MEMORY;
  }
  section->lines = lines;
  lines[section->line_count] = placido_memory_string(text, err);
  if (!lines[section->line_count]) {
    return PLACIDO_MEMORY;
  }
  section->line_count++;
  return PLACIDO_OK;
}

/* Empty columns go before the next one that is not, so that no line ends with spaces. */
static void print_figure(const struct bench_figure *figure) {
  const bool is_time = !isnan(figure->processor);
  printf("  %-34s %9.4g %s", figure->what, figure->value, figure->unit);
  if (is_time) {
    printf("%*s%9.4g %9.4g", UNIT_WIDTH - (int)strlen(figure->unit), "", figure->worst,
           figure->processor);
  }
  if (figure->against) {
    const int gap = UNIT_WIDTH - (int)strlen(figure->unit) + TIMES_WIDTH;
    printf("%*s%9.4g × %s", is_time ? 1 : gap + 1, "", figure->ratio, figure->against);
  }
  putchar('\n');
}

void bench_report_print(const struct bench_report *report) {
  printf("load %.2f on %ld processors\n", report->load, report->processors);
  for (size_t i = 0; i < report->count; i++) {
    const struct bench_section *section = &report->sections[i];
    printf("\n%s: %s\n", section->name, section->summary);
    if (section->count > 0) {
      printf("  %-34s %9s %*s%9s %9s %9s\n", "", "value", UNIT_WIDTH, "", "worst", "processor",
             "ratio");
    }
    for (size_t k = 0; k < section->count; k++) {
      print_figure(&section->figures[k]);
    }
    for (size_t k = 0; k < section->line_count; k++) {
      printf("  %s\n", section->lines[k]);
    }
  }
}

static json_t *figure_json(const struct bench_figure *figure) {
  json_t *object = json_object();
  json_object_set_new(object, "what", json_string(figure->what));
  json_object_set_new(object, "unit", json_string(figure->unit));
  json_object_set_new(object, "value", placido_json_real(figure->value));
  json_object_set_new(object, "worst", placido_json_real(figure->worst));
  json_object_set_new(object, "processor", placido_json_real(figure->processor));
  json_object_set_new(object, "ratio", placido_json_real(figure->ratio));
  json_object_set_new(object, "against",
                      figure->against ? json_string(figure->against) : json_null());
  return object;
}

static json_t *section_json(const struct bench_section *section) {
  json_t *object = json_object(), *figures = json_array(), *lines = json_array();
  for (size_t i = 0; i < section->count; i++) {
    json_array_append_new(figures, figure_json(&section->figures[i]));
  }
  json_object_set_new(object, "name", json_string(section->name));
  json_object_set_new(object, "summary", json_string(section->summary));
  json_object_set_new(object, "figures", figures);
  for (size_t i = 0; i < section->line_count; i++) {
    json_array_append_new(lines, json_string(section->lines[i]));
  }
  json_object_set_new(object, "lines", lines);
  return object;
}

json_t *bench_report_json(const struct bench_report *report) {
  json_t *object = json_object(), *sections = json_array();
  for (size_t i = 0; i < report->count; i++) {
    json_array_append_new(sections, section_json(&report->sections[i]));
  }
  json_object_set_new(object, "load", placido_json_real(report->load));
  json_object_set_new(object, "processors", json_integer(report->processors));
  json_object_set_new(object, "benchmarks", sections);
  return object;
}

void bench_report_free(struct bench_report *report) {
  for (size_t i = 0; i < report->count; i++) {
    placido_memory_free(report->sections[i].figures);
    for (size_t k = 0; k < report->sections[i].line_count; k++) {
      placido_memory_free(report->sections[i].lines[k]);
    }
    placido_memory_free(report->sections[i].lines);
  }
  placido_memory_free(report->sections);
  *report = (struct bench_report){0};
}
