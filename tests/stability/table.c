/* Keeps the rows of one test program and prints them as a table of fixed columns. */
#include "tests/stability/table.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROWS_MAX 256
#define NAME_MAX_LENGTH 64
#define REASON_MAX_LENGTH 160

struct kept {
  struct stability_row row;
  char name[NAME_MAX_LENGTH], refused[REASON_MAX_LENGTH];
};

static struct kept rows[ROWS_MAX];
static size_t count;

void stability_add(const struct stability_row *row) {
  if (count == ROWS_MAX) {
    fprintf(stderr, "more than %d cases of stability\n", ROWS_MAX);
    abort();
  }
  struct kept *kept = &rows[count++];
  kept->row = *row;
  snprintf(kept->name, sizeof kept->name, "%s", row->name);
  snprintf(kept->refused, sizeof kept->refused, "%s", row->refused ? row->refused : "");
}

static bool is_good(const struct kept *kept) {
  return kept->row.refused || kept->row.change <= kept->row.bound;
}

static void print_number(FILE *out, double value, const char *unit) {
  char text[40];
  if (isnan(value)) {
    snprintf(text, sizeof text, "-");
  } else {
    snprintf(text, sizeof text, "%.3g%s%s", value, unit ? " " : "", unit ? unit : "");
  }
  fprintf(out, " %14s", text);
}

static void print_rows(FILE *out, const char *title) {
  fprintf(out, "\n%s\n%-44s %14s %14s %14s %14s %14s  %s\n", title, "case", "condition",
          "perturbation", "change", "bound", "against exact", "verdict");
  for (size_t i = 0; i < count; i++) {
    const struct stability_row *row = &rows[i].row;
    fprintf(out, "%-44s", rows[i].name);
    print_number(out, row->condition, NULL);
    print_number(out, row->perturbation, row->in_unit);
    print_number(out, row->change, row->out_unit);
    print_number(out, row->bound, row->out_unit);
    print_number(out, row->extended, "ulp");
    if (row->refused) {
      fprintf(out, "  refuses: %s\n", rows[i].refused);
    } else {
      fprintf(out, "  %s\n", is_good(&rows[i]) ? "within" : "BEYOND");
    }
  }
}

int stability_print(const char *title) {
  size_t bad = 0;
  for (size_t i = 0; i < count; i++) {
    bad += !is_good(&rows[i]);
  }
  print_rows(stdout, title);
  const char *path = getenv("PLACIDO_STABILITY_TABLE");
  FILE *file = path ? fopen(path, "a") : NULL;
  if (file) {
    print_rows(file, title);
    fclose(file);
  }
  count = 0;
  return bad == 0 ? 0 : 1;
}
