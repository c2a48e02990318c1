/* Indices with their error bars: every row on the fitted surface and on each of its variants. */
#include "base/memory.h"
#include "reconstruct/indices/cornea.h"
#include "reconstruct/indices/errors.h"

#include <math.h>

/* The rows of all groups; the values of one surface. */
struct rows {
  size_t count;
  const placido_index_row *items[PLACIDO_INDICES_MAX];
};

static struct rows list_rows(void) {
  struct rows rows = {0};
  size_t group_count;
  const placido_index_group *const *groups = placido_index_groups(&group_count);
  for (size_t g = 0; g < group_count; g++) {
    for (size_t i = 0; i < groups[g]->count && rows.count < PLACIDO_INDICES_MAX; i++) {
      rows.items[rows.count++] = &groups[g]->rows[i];
    }
  }
  return rows;
}

static const char *why_missing(const placido_index_row *row, const placido_cornea *cornea,
                               bool covered) {
  if (isnan(cornea->vertex.x_mm) && !row->reason) {
    return PLACIDO_REASON_NO_VERTEX;
  }
  return covered && row->reason ? row->reason(cornea) : PLACIDO_REASON_NOT_COVERED;
}

static placido_index_value evaluate(const placido_index_row *row, const placido_cornea *cornea) {
  placido_index_value value = {
      .name = row->name, .unit = row->unit, .help = row->help, .value = NAN, .sigma = NAN};
  for (int source = 0; source < PLACIDO_SIGMA_SOURCES; source++) {
    value.budget[source] = NAN;
  }
  value.zone_mm = row->zone_mm;
  value.covered = row->zone_mm > 0 ? placido_layout_share(cornea->layout, 0, row->zone_mm) : NAN;
  bool covered = !(value.covered < PLACIDO_SHARE_MIN);
  if (covered) {
    value.value = row->at(cornea);
  }
  if (isnan(value.value)) {
    value.reason = why_missing(row, cornea, covered);
  }
  return value;
}

/* What every row gives on one variant. */
static int evaluate_variant(double *changed, const struct rows *rows, const placido_layout *layout,
                            const placido_fit *fit, int variant) {
  placido_surface *surface = NULL;
  placido_cornea *cornea = NULL;
  int status = placido_fit_variant(&surface, fit, variant, NULL);
  if (!status) {
    status = placido_cornea_new(&cornea, layout, surface, NULL);
  }
  for (size_t i = 0; i < rows->count && !status; i++) {
    changed[i] = rows->items[i]->at(cornea);
  }
  placido_cornea_free(cornea);
  placido_surface_free(surface);
  return status;
}

static int fill_sigmas(placido_index_value *values, const struct rows *rows,
                       const placido_layout *layout, const placido_fit *fit, placido_error *err) {
  int variants = placido_fit_variant_count(fit), failed = PLACIDO_OK;
  double *changed = placido_memory_new((size_t)variants * rows->count, sizeof *changed, err);
  if (!changed) {
    return PLACIDO_MEMORY;
  }
#pragma omp parallel for schedule(dynamic)
  for (int v = 0; v < variants; v++) {
    int status = evaluate_variant(changed + (size_t)v * rows->count, rows, layout, fit, v);
    if (status) {
#pragma omp atomic write
      failed = status;
    }
  }
  for (size_t i = 0; i < rows->count && !failed; i++) {
    placido_index_fill_sigma(&values[i], fit, changed + i, rows->count, rows->items[i]->period,
                             rows->items[i]->range);
  }
  placido_memory_free(changed);
  return failed ? placido_error_set(err, failed, "out of memory evaluating the indices' errors")
                : PLACIDO_OK;
}

int placido_indices_find(placido_index_value values[PLACIDO_INDICES_MAX], size_t *count,
                         const placido_surface *surface, const placido_fit *fit,
                         placido_error *err) {
  *count = 0;
  const struct rows rows = list_rows();
  placido_layout *layout = NULL;
  placido_cornea *cornea = NULL;
  int status = placido_layout_new(&layout, surface, err);
  if (!status) {
    status = placido_cornea_new(&cornea, layout, surface, err);
  }
  for (size_t i = 0; i < rows.count && !status; i++) {
    values[i] = evaluate(rows.items[i], cornea);
  }
  if (!status && fit) {
    status = fill_sigmas(values, &rows, layout, fit, err);
  }
  *count = status ? 0 : rows.count;
  placido_cornea_free(cornea);
  placido_layout_free(layout);
  return status;
}
