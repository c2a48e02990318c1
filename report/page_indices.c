/* The sections of report.html with figures of the whole cornea: indices by group, error budget. */
#include "report/page.h"

#include "report/html.h"
#include "report/number.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

/* A word, or a whole name, as the field spells it. */
typedef struct spelling {
  const char *plain, *spelt;
} spelling;

static const spelling words[] = {
    {"simk", "SimK"}, {"k", "K"},       {"kisa", "KISA"}, {"srax", "SRAX"}, {"clmi", "CLMI"},
    {"ppk", "PPK"},   {"sai", "SAI"},   {"sri", "SRI"},   {"dsi", "DSI"},   {"osi", "OSI"},
    {"csi", "CSI"},   {"kpi", "KPI"},   {"iai", "IAI"},   {"glpi", "GLPI"}, {"nbi", "NBI"},
    {"pi", "PI"},     {"sl", "SL"},     {"ar", "AR"},     {"q", "Q"},       {"p", "p"},
    {"e", "E"},       {"x", "x"},       {"y", "y"},       {"rms", "RMS"},   {"hoa", "higher orders"},
    {"m", "M"},       {"j0", "J0"},     {"j45", "J45"},
};

static const spelling names[] = {
    {"inferior_superior_D", "I−S"},
    {"mean_axial_0_3mm_D", "Mean axial, 0–3 mm"},
    {"mean_axial_3_6mm_D", "Mean axial, 3–6 mm"},
    {"mean_axial_6_8mm_D", "Mean axial, 6–8 mm"},
    {"asphericity_q", "Asphericity Q, 6 mm"},
    {"asphericity_q_4_5mm", "Asphericity Q, 4.5 mm"},
    {"asphericity_q_8mm", "Asphericity Q, 8 mm"},
    {"asphericity_q_flat_4_5mm", "Q, flat, 4.5 mm"},
    {"asphericity_q_flat_6mm", "Q, flat, 6 mm"},
    {"asphericity_q_flat_8mm", "Q, flat, 8 mm"},
    {"asphericity_q_steep_4_5mm", "Q, steep, 4.5 mm"},
    {"asphericity_q_steep_6mm", "Q, steep, 6 mm"},
    {"asphericity_q_steep_8mm", "Q, steep, 8 mm"},
};

#define COUNT(table) (sizeof(table) / sizeof((table)[0]))

/* NULL where the table does not have it. */
static const char *spelt(const spelling *table, size_t count, const char *plain) {
  for (size_t i = 0; i < count; i++) {
    if (strcmp(table[i].plain, plain) == 0) {
      return table[i].spelt;
    }
  }
  return NULL;
}

/* How the page orders the indices: by how their names begin. */
static const struct {
  const char *heading;
  bool key; /* stands before the maps */
  const char *beginnings[10];
} groups[] = {
    {"Keratometry", true, {"simk_", "min_k", "max_k", "central_k", "mean_axial"}},
    {"Keratoconus", true, {"inferior", "srax", "kisa", "clmi", "ppk", "dsi", "osi", "csi", "kpi"}},
    {"Shape", false, {"asphericity", "apical", "shape_factor", "eccentricity", "best_fit",
                      "vertex", "max_tangential"}},
    {"Regularity", false, {"sai", "sri", "iai", "analysed"}},
    {"Placido mires", false, {"placido"}},
    {"Others", false, {""}},
};

/* The first group whose beginnings fit. */
static size_t group_of(const char *name) {
  size_t group = 0;
  for (; group < COUNT(groups) - 1; group++) {
    for (int i = 0; i < 10 && groups[group].beginnings[i] != NULL; i++) {
      if (strncmp(name, groups[group].beginnings[i], strlen(groups[group].beginnings[i])) == 0) {
        return group;
      }
    }
  }
  return group;
}

/* A word of `length` bytes as it is spelt. */
static void write_word(FILE *stream, const char *word, size_t length, bool first) {
  char text[64];
  snprintf(text, sizeof text, "%.*s", (int)(length < 63 ? length : 63), word);
  const char *known = spelt(words, COUNT(words), text);
  if (known != NULL) {
    fputs(known, stream);
    return;
  }
  text[0] = first ? (char)toupper((unsigned char)text[0]) : text[0];
  placido_html_text(stream, text);
}

void placido_page_name(FILE *stream, const char *name, const char *unit) {
  size_t length = strlen(name);
  const char *last = strrchr(name, '_'), *known = spelt(names, COUNT(names), name);
  if (known != NULL) {
    fputs(known, stream);
    return;
  }
  if (last != NULL && unit != NULL &&
      strcmp(placido_unit_text(last + 1), placido_unit_text(unit)) == 0) {
    length = (size_t)(last - name);
  }
  for (size_t start = 0; start < length;) {
    size_t end = start;
    while (end < length && name[end] != '_') {
      end++;
    }
    fputs(start > 0 ? " " : "", stream);
    write_word(stream, name + start, end - start, start == 0);
    start = end + 1;
  }
}

/* A reason's underscores become spaces. */
static void write_reason(FILE *stream, const char *reason) {
  char text[128];
  snprintf(text, sizeof text, "%s", reason);
  for (char *at = text; *at != '\0'; at++) {
    *at = *at == '_' ? ' ' : *at;
  }
  placido_html_text(stream, text);
}

static void write_index(FILE *stream, const placido_index_value *index) {
  char value[2 * PLACIDO_NUMBER_SIZE + 8];
  placido_number_measure(value, sizeof value, index->value, index->sigma);
  fputs("<tr><th scope=\"row\">", stream);
  placido_page_name(stream, index->name, index->unit);
  fputs("</th><td class=\"number\">", stream);
  placido_html_text(stream, value);
  fputs("</td><td class=\"unit\">", stream);
  placido_html_text(stream, index->unit != NULL ? placido_unit_text(index->unit) : NULL);
  fputs("</td><td class=\"small\">", stream);
  placido_html_text(stream, index->help);
  if (index->reason != NULL) {
    fputs(" <em>Not given: ", stream);
    write_reason(stream, index->reason);
    fputs(".</em>", stream);
  }
  fputs("</td></tr>\n", stream);
}

static void write_group(FILE *stream, const placido_report *report, size_t group) {
  bool begun = false;
  for (size_t k = 0; k < report->index_count; k++) {
    if (group_of(report->indices[k].name) != group) {
      continue;
    }
    if (!begun) {
      fprintf(stream, "<tr class=\"group\"><th colspan=\"4\" scope=\"rowgroup\">%s</th></tr>\n",
              groups[group].heading);
      begun = true;
    }
    write_index(stream, &report->indices[k]);
  }
}

void placido_page_indices(FILE *stream, const placido_report *report, bool key) {
  bool any = false;
  for (size_t k = 0; k < report->index_count; k++) {
    any = any || groups[group_of(report->indices[k].name)].key == key;
  }
  if (!any) {
    return;
  }
  fprintf(stream, "<section>\n<h2>%s</h2>\n", key ? "Key figures" : "Further figures");
  fputs(
      "<table class=\"figures\">\n<thead><tr><th scope=\"col\">Index</th>"
      "<th scope=\"col\" class=\"number\">Value ± 1 σ</th><th scope=\"col\">Unit</th>"
      "<th scope=\"col\">What it tells</th></tr></thead>\n<tbody>\n",
      stream);
  for (size_t group = 0; group < COUNT(groups); group++) {
    if (groups[group].key == key) {
      write_group(stream, report, group);
    }
  }
  fputs("</tbody>\n</table>\n</section>\n", stream);
}

/* A share of the budget; a dash where it is not known. */
static void write_share(FILE *stream, const char *name, double z_um, double axial_D,
                        const char *origin) {
  char height[PLACIDO_NUMBER_SIZE], power[PLACIDO_NUMBER_SIZE];
  placido_number_significant(height, sizeof height, z_um, 2);
  placido_number_significant(power, sizeof power, axial_D, 2);
  fprintf(stream, "<tr><th scope=\"row\">%s</th><td class=\"number\">", name);
  placido_html_text(stream, height);
  fputs("</td><td class=\"number\">", stream);
  placido_html_text(stream, power);
  fprintf(stream, "</td><td class=\"small\">%s</td></tr>\n", origin);
}

void placido_page_budget(FILE *stream, const placido_report *report) {
  static const struct {
    const char *name, *origin;
  } sources[PLACIDO_SIGMA_SOURCES] = {
      [PLACIDO_SIGMA_NOISE] = {"Edges", "Noise of the edge points, with the smoothing."},
      [PLACIDO_SIGMA_DISTANCE] = {"Distance", "How far the cornea stands from the instrument."},
      [PLACIDO_SIGMA_GEOMETRY] = {"Geometry", "Camera and mires, as calibrated; a dash where "
                                              "nothing is known of their uncertainty."},
  };
  if (report->budget == NULL) {
    return;
  }
  double z = 0, axial = 0;
  fputs("<section>\n<h2>Error budget</h2>\n<p class=\"small\">", stream);
  placido_html_print(stream, "One standard deviation, root mean square over the central %g mm.",
                     report->budget_zone_mm);
  fputs("</p>\n<table>\n<thead><tr><th scope=\"col\">Source</th><th scope=\"col\" "
        "class=\"number\">Elevation, µm</th><th scope=\"col\" class=\"number\">Axial power, "
        "D</th><th scope=\"col\">What it is</th></tr></thead>\n<tbody>\n", stream);
  for (int k = 0; k < PLACIDO_SIGMA_SOURCES; k++) {
    const placido_sigma *share = &report->budget[k];
    write_share(stream, sources[k].name, share->z_um, share->axial_D, sources[k].origin);
    z = hypot(z, isfinite(share->z_um) ? share->z_um : 0);
    axial = hypot(axial, isfinite(share->axial_D) ? share->axial_D : 0);
  }
  write_share(stream, "All that is known", z, axial, "Root of the sum of squares.");
  fputs("</tbody>\n</table>\n", stream);
  if (report->condition) {
    fputs("<p class=\"small\">", stream);
    placido_html_text(stream, report->condition);
    fputs("</p>\n", stream);
  }
  fputs("</section>\n", stream);
}
