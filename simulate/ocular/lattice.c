/* Lattice: the surface asked line by line, its rays led on in columns, what is between nodes. */
#include "simulate/ocular/lattice.h"

#include "base/memory.h"
#include "reconstruct/surface/sheet.h"

#include <math.h>

enum { SIDE_MAX = 9000 };

/* What the lines share. */
typedef struct tracing {
  const placido_sight *sight;
  placido_lattice *lattice;
  placido_sheet *sheet;
  double *x_mm, *room; /* of every thread: a beam, and the sheet's work */
  size_t share;        /* numbers of a thread's room */
} tracing;

static void trace_line(const tracing *t, const placido_beam *beam, double *work, int row) {
  const placido_lattice *l = t->lattice;
  placido_node *nodes = l->nodes + (size_t)row * (size_t)l->columns;
  double y_mm = l->y0_mm + row * l->step_mm;
  placido_sheet_line(t->sheet, work, y_mm, 0, beam->count, beam->depth_mm, beam->sx, beam->sy);
  for (size_t i = 0; i < beam->count; i++) {
    beam->x_mm[i] = t->x_mm[i];
    beam->y_mm[i] = y_mm;
    beam->depth_mm[i] -= t->sight->axis_sag_mm;
  }
  placido_sight_depart(t->sight, beam);
  for (size_t i = 0; i < beam->count; i++) {
    nodes[i].standing = placido_sight_stand(t->sight, beam, i);
    placido_sight_entry(t->sight, beam, i, nodes[i].entry_mm);
  }
}

/* Every `threads`-th line from `thread` on. */
static void trace_lines(const tracing *t, int thread, int threads) {
  size_t columns = (size_t)t->lattice->columns;
  double *room = t->room + (size_t)thread * t->share;
  placido_beam beam = placido_beam_of(room, columns);
  for (int row = thread; row < t->lattice->rows; row += threads) {
    trace_line(t, &beam, room + PLACIDO_BEAM_COLUMNS * columns, row);
  }
}

static int prepare(tracing *t, int threads, placido_error *err) {
  placido_lattice *l = t->lattice;
  size_t columns = (size_t)l->columns;
  t->x_mm = placido_memory_new(columns, sizeof *t->x_mm, err);
  l->nodes = placido_memory_new(columns * (size_t)l->rows, sizeof *l->nodes, err);
  if (t->x_mm == NULL || l->nodes == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < columns; i++) {
    t->x_mm[i] = l->x0_mm + (double)i * l->step_mm;
  }
  int status = placido_sheet_new(&t->sheet, t->sight->surface, t->x_mm, columns, err);
  if (status == PLACIDO_OK) {
    t->share = PLACIDO_BEAM_COLUMNS * columns + placido_sheet_work(t->sheet);
    t->room = placido_memory_new(t->share, (size_t)threads * sizeof *t->room, err);
    status = t->room == NULL ? PLACIDO_MEMORY : PLACIDO_OK;
  }
  return status;
}

int placido_lattice_new(placido_lattice *lattice, const placido_sight *sight,
                        const double low_mm[2], const double high_mm[2], double step_mm,
                        int threads, placido_error *err) {
  double columns = ceil((high_mm[0] - low_mm[0]) / step_mm) + 1;
  double rows = ceil((high_mm[1] - low_mm[1]) / step_mm) + 1;
  *lattice = (placido_lattice){.x0_mm = low_mm[0], .y0_mm = low_mm[1], .step_mm = step_mm};
  if (!(columns >= 2 && rows >= 2 && columns <= SIDE_MAX && rows <= SIDE_MAX)) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "light of a pupil of %g mm would need %g by %g places on the cornea",
                             sight->pupil_mm, columns, rows);
  }
  lattice->columns = (int)columns;
  lattice->rows = (int)rows;
  tracing t = {.sight = sight, .lattice = lattice};
  int status = prepare(&t, threads, err);
  if (status == PLACIDO_OK) {
#pragma omp parallel for num_threads(threads) if (threads > 1)
    for (int thread = 0; thread < threads; thread++) {
      trace_lines(&t, thread, threads);
    }
  } else {
    placido_lattice_free(lattice);
  }
  placido_sheet_free(t.sheet);
  placido_memory_free(t.x_mm);
  placido_memory_free(t.room);
  return status;
}

void placido_lattice_free(placido_lattice *lattice) {
  if (lattice != NULL) {
    placido_memory_free(lattice->nodes);
    *lattice = (placido_lattice){0};
  }
}

/* Four nodes around a place, and their shares. */
typedef struct cell {
  const placido_node *nodes[4];
  double share[4];
} cell;

static bool find_cell(const placido_lattice *l, double x_mm, double y_mm, cell *found) {
  double x = (x_mm - l->x0_mm) / l->step_mm, y = (y_mm - l->y0_mm) / l->step_mm;
  if (!(x >= 0 && y >= 0 && x < l->columns - 1 && y < l->rows - 1)) {
    return false;
  }
  int column = (int)x, row = (int)y;
  double a = x - column, b = y - row;
  const placido_node *first = l->nodes + (size_t)row * (size_t)l->columns + column;
  *found = (cell){{first, first + 1, first + l->columns, first + l->columns + 1},
                  {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b}};
  return true;
}

bool placido_lattice_at(const placido_lattice *lattice, double x_mm, double y_mm,
                        placido_node *node) {
  cell c;
  *node = (placido_node){.standing = {.opd_mm = NAN}};
  if (!find_cell(lattice, x_mm, y_mm, &c)) {
    return false;
  }
  double opd_mm = 0;
  for (int i = 0; i < 4; i++) {
    const placido_node *from = c.nodes[i];
    double share = c.share[i];
    opd_mm += share * from->standing.opd_mm;
    node->standing.place[0] += share * from->standing.place[0];
    node->standing.place[1] += share * from->standing.place[1];
    node->entry_mm[0] += share * from->entry_mm[0];
    node->entry_mm[1] += share * from->entry_mm[1];
  }
  node->standing.opd_mm = opd_mm;
  return isfinite(opd_mm);
}

double placido_lattice_opd_mm(const placido_lattice *lattice, double x_mm, double y_mm,
                              const double place[2]) {
  cell c;
  double mean[2] = {0, 0}, opd_mm = 0;
  if (!find_cell(lattice, x_mm, y_mm, &c)) {
    return NAN;
  }
  for (int i = 0; i < 4; i++) {
    mean[0] += c.share[i] * c.nodes[i]->standing.slope[0];
    mean[1] += c.share[i] * c.nodes[i]->standing.slope[1];
  }
  for (int i = 0; i < 4; i++) {
    const placido_standing *from = &c.nodes[i]->standing;
    opd_mm += c.share[i] * (from->opd_mm +
                            0.5 * ((from->slope[0] + mean[0]) * (place[0] - from->place[0]) +
                                   (from->slope[1] + mean[1]) * (place[1] - from->place[1])));
  }
  return opd_mm;
}
