/* The sheet: every part along a line, by its own way where it has one, else point by point. */
#include "reconstruct/surface/sheet.h"

#include "base/dispatch.h"
#include "base/memory.h"
#include "reconstruct/surface/surface.h"

#include <math.h>
#include <string.h>

struct placido_sheet {
  const placido_surface *surface;
  size_t count, work;
  double *x_mm;
  void **columns; /* of every term */
};

int placido_sheet_new(placido_sheet **sheet, const placido_surface *surface, const double *x_mm,
                      size_t count, placido_error *err) {
  *sheet = NULL;
  placido_sheet *made = placido_memory_new(1, sizeof *made, err);
  if (!made) {
    return PLACIDO_MEMORY;
  }
  *made = (placido_sheet){.surface = surface, .count = count};
  made->x_mm = placido_memory_new(count, sizeof *made->x_mm, err);
  made->columns = placido_memory_new(surface->term_count, sizeof *made->columns, err);
  int status = made->x_mm && made->columns ? PLACIDO_OK : PLACIDO_MEMORY;
  for (size_t i = 0; i < surface->term_count && !status; i++) {
    const placido_surface_term *term = &surface->terms[i];
    size_t work = 0;
    if (term->row->make_columns) {
      status = term->row->make_columns(&made->columns[i], &work, term->state, x_mm, count, err);
    }
    made->work = work > made->work ? work : made->work;
  }
  if (status) {
    placido_sheet_free(made);
    return status;
  }
  memcpy(made->x_mm, x_mm, count * sizeof *x_mm);
  *sheet = made;
  return PLACIDO_OK;
}

void placido_sheet_free(placido_sheet *sheet) {
  if (!sheet) {
    return;
  }
  for (size_t i = 0; sheet->columns && i < sheet->surface->term_count; i++) {
    placido_memory_free(sheet->columns[i]);
  }
  placido_memory_free(sheet->columns);
  placido_memory_free(sheet->x_mm);
  placido_memory_free(sheet);
}

size_t placido_sheet_work(const placido_sheet *sheet) { return sheet->work; }

static void add_points(const placido_surface_term *term, const placido_line *line) {
  for (size_t i = 0; i < line->count; i++) {
    placido_jet jet = {0};
    bool defined = term->row->add(term->state, line->x_mm[i], line->y_mm, &jet);
    line->sag[i] += defined ? jet.sag : NAN;
    line->sx[i] += defined ? jet.sx : NAN;
    line->sy[i] += defined ? jet.sy : NAN;
  }
}

/* Outside the radius, and where any of the three is not finite, all are NaN. */
PLACIDO_WIDE
static void clear_undefined(const placido_line *line, double radius_mm) {
  const double limit = radius_mm + PLACIDO_SURFACE_EDGE_MM, square = line->y_mm * line->y_mm;
  const double *restrict x_mm = line->x_mm;
  double *restrict sag = line->sag, *restrict sx = line->sx, *restrict sy = line->sy;
  for (size_t i = 0; i < line->count; i++) {
    double none = 0 * (sag[i] + sx[i] + sy[i]); /* 0, or NaN */
    none = x_mm[i] * x_mm[i] + square <= limit * limit ? none : NAN;
    sag[i] += none;
    sx[i] += none;
    sy[i] += none;
  }
}

void placido_sheet_line(const placido_sheet *sheet, double *work, double y_mm, size_t first,
                        size_t count, double *sag, double *sx, double *sy) {
  const placido_line line = {.x_mm = sheet->x_mm + first,
                             .y_mm = y_mm,
                             .first = first,
                             .count = count,
                             .work = work,
                             .sag = sag,
                             .sx = sx,
                             .sy = sy};
  if (count == 0) {
    return;
  }
  memset(sag, 0, count * sizeof *sag);
  memset(sx, 0, count * sizeof *sx);
  memset(sy, 0, count * sizeof *sy);
  for (size_t i = 0; i < sheet->surface->term_count; i++) {
    const placido_surface_term *term = &sheet->surface->terms[i];
    if (term->row->add_line) {
      term->row->add_line(term->state, sheet->columns[i], &line);
    } else {
      add_points(term, &line);
    }
  }
  clear_undefined(&line, sheet->surface->radius_mm);
}
