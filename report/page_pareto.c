/* accuracy.html: what accuracy costs in time, stage by stage, on one page. */
#include "report/pareto.h"

#include "base/file.h"
#include "report/html.h"
#include "report/number.h"
#include "report/page.h"

#include <stdio.h>

static void write_number(FILE *stream, double value) {
  char text[PLACIDO_NUMBER_SIZE];
  placido_number_significant(text, sizeof text, value, 2);
  fputs("<td class=\"number\">", stream);
  placido_html_text(stream, text);
  fputs("</td>", stream);
}

static void write_front(FILE *stream, const placido_pareto *pareto) {
  size_t front[PLACIDO_PARETO_POINTS_MAX], count = placido_pareto_front(front, pareto);
  fputs("<table>\n<thead><tr><th scope=\"col\">Efficient setting</th><th scope=\"col\" "
        "class=\"number\">ms</th><th scope=\"col\" class=\"number\">", stream);
  placido_html_text(stream, pareto->error_name);
  fputs("</th></tr></thead>\n<tbody>\n", stream);
  for (size_t i = 0; i < count; i++) {
    const placido_pareto_point *point = &pareto->points[front[i]];
    fputs("<tr><th scope=\"row\">", stream);
    placido_html_text(stream, point->setting);
    fputs("</th>", stream);
    write_number(stream, point->ms);
    write_number(stream, point->error);
    fputs("</tr>\n", stream);
  }
  fputs("</tbody>\n</table>\n", stream);
}

static int write_section(FILE *stream, const placido_pareto_section *section, const char *folder,
                         placido_error *err) {
  fputs("<section>\n<h2>", stream);
  placido_html_text(stream, section->pareto.title);
  fputs("</h2>\n", stream);
  for (size_t i = 0; i < section->sentence_count; i++) {
    fputs("<p>", stream);
    placido_html_text(stream, section->sentences[i]);
    fputs("</p>\n", stream);
  }
  fputs("<figure>\n", stream);
  int status = placido_html_picture(stream, NULL, folder, section->picture, section->pareto.title,
                                    err);
  fputs("</figure>\n", stream);
  write_front(stream, &section->pareto);
  fputs("</section>\n", stream);
  return status;
}

static int write_page(FILE *stream, const placido_pareto_page *page, const char *folder,
                      placido_error *err) {
  char probe[PLACIDO_NUMBER_SIZE], line[PLACIDO_NUMBER_SIZE + 64];
  placido_page_begin(stream, "What accuracy costs in time", page->machine);
  placido_html_row(stream, "Machine", page->machine);
  placido_number_significant(probe, sizeof probe, page->probe_ms, 3);
  snprintf(line, sizeof line, "%s ms, against which other machines' times are scaled", probe);
  placido_html_row(stream, "Probe", line);
  placido_html_row(stream, "Measured", page->created);
  placido_html_row(stream, "Software", page->software);
  fputs("</tbody>\n</table>\n</header>\n<main>\n<p class=\"small\">Every point is the worst of all "
        "eyes from easy to hard, in error and in time. A stage's error is against the same stage "
        "at its finest; a whole examination's, against the true eye.</p>\n", stream);
  int status = PLACIDO_OK;
  for (size_t i = 0; i < page->count && status == PLACIDO_OK; i++) {
    status = write_section(stream, &page->sections[i], folder, err);
  }
  placido_page_end(stream);
  return status;
}

int placido_report_pareto_write(const placido_pareto_page *page, const char *folder,
                                placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file = {0};
  int status = placido_path_join(path, folder, "accuracy.html", err);
  if (status == PLACIDO_OK) {
    status = placido_file_create(&file, path, err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = write_page(file.stream, page, folder, err);
  if (status != PLACIDO_OK) {
    placido_file_discard(&file);
    return status;
  }
  return placido_file_commit(&file, err);
}
