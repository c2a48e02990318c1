/* Mosaic: a piece of the canvas has light of the four nodes in its corners, whose spreads are added
 * up before they are transformed back. So the whole canvas costs five transforms instead of two,
 * however many nodes there are, and what the pieces overlap. */
#include "simulate/plan/mosaic.h"

#include "base/memory.h"
#include "simulate/plan/nodes.h"

#include <math.h>
#include <string.h>

enum { CORNERS = 4, SHEETS_MAX = 8 };

/* Samples of a side from `first` on. */
typedef struct stretch {
  int first, count;
} stretch;

/* The pieces a side. */
static int pieces(const placido_mosaic *m) { return m->nodes > 1 ? m->nodes - 1 : 1; }

/* The node before a sample: that of the piece that the sample is in. */
static int piece_of(const placido_mosaic *m, float place) {
  int before = (int)place;
  return before < pieces(m) ? before : pieces(m) - 1;
}

static stretch piece_along(const placido_mosaic *m, const float *places, int size, int piece) {
  stretch found = {0, 0};
  for (int i = 0; i < size; i++) {
    if (piece_of(m, places[i]) == piece) {
      found.first = found.count == 0 ? i : found.first;
      found.count++;
    }
  }
  return found;
}

/* The longest piece of a side and as far as it is spread. */
static int longest(const placido_mosaic *m, const float *places, int size) {
  int most = 1;
  for (int piece = 0; piece < pieces(m); piece++) {
    int length = piece_along(m, places, size, piece).count + 2 * m->reach;
    most = length > most ? length : most;
  }
  return most < size ? most : size;
}

static void find_places(float *places, int size, const placido_view *view) {
  for (int i = 0; i < size; i++) {
    places[i] = (float)placido_node_place(i, size, view->bleed_px, view->nodes);
  }
}

int placido_mosaic_new(placido_mosaic *mosaic, const placido_view *view, int reach,
                       placido_error *err) {
  const int width = view->canvas.width_px, height = view->canvas.height_px;
  *mosaic = (placido_mosaic){.reach = reach,
                             .width_px = width,
                             .height_px = height,
                             .piece_width_px = width,
                             .piece_height_px = height,
                             .nodes = view->nodes,
                             .threads = view->threads};
  mosaic->across = placido_memory_new((size_t)(width + height), sizeof *mosaic->across, err);
  if (mosaic->across == NULL) {
    return PLACIDO_MEMORY;
  }
  mosaic->down = mosaic->across + width;
  find_places(mosaic->across, width, view);
  find_places(mosaic->down, height, view);
  if (view->nodes > 1) {
    mosaic->piece_width_px = longest(mosaic, mosaic->across, width);
    mosaic->piece_height_px = longest(mosaic, mosaic->down, height);
  }
  const placido_convolution how = {.doubles = view->settings->doubles,
                                   .threads = view->nodes > 1 ? 1 : view->threads};
  int status = placido_convolver_new(&mosaic->convolver, mosaic->piece_width_px,
                                     mosaic->piece_height_px, reach, &how, NULL, err);
  if (status != PLACIDO_OK) {
    placido_mosaic_free(mosaic);
  }
  return status;
}

void placido_mosaic_free(placido_mosaic *mosaic) {
  if (mosaic != NULL) {
    placido_convolver_free(mosaic->convolver);
    placido_memory_free(mosaic->across);
    *mosaic = (placido_mosaic){0};
  }
}

/* One node: the planes as they are. */
static int run_whole(const placido_mosaic *m, const placido_sheet *sheets, int count,
                     placido_error *err) {
  placido_convolution_term terms[SHEETS_MAX];
  placido_superposition planes[SHEETS_MAX];
  for (int i = 0; i < count; i++) {
    terms[i] = (placido_convolution_term){sheets[i].source, sheets[i].transfers[0]};
    planes[i] = (placido_superposition){sheets[i].target, &terms[i], 1};
  }
  return placido_convolver_run(m->convolver, planes, (size_t)count, err);
}

/* A piece of a sheet: light of its corners' nodes, and what becomes of it. */
typedef struct work {
  const placido_sheet *sheet;
  int column, row;        /* of the piece */
  stretch across, down;   /* without what it is spread over */
  int left, top;          /* of what it is spread over */
  float *sources, *target;
  int status;
} work;

/* Where a piece's part of the canvas begins: as far before it as it is spread. */
static int part_start(int first, int reach, int size, int most) {
  int from = first - reach > 0 ? first - reach : 0;
  return from < size - most ? from : size - most;
}

static void aim(work *w, const placido_mosaic *m, const placido_sheet *sheets, int job) {
  int piece = job % (pieces(m) * pieces(m));
  w->sheet = &sheets[job / (pieces(m) * pieces(m))];
  w->column = piece % pieces(m);
  w->row = piece / pieces(m);
  w->across = piece_along(m, m->across, m->width_px, w->column);
  w->down = piece_along(m, m->down, m->height_px, w->row);
  w->left = part_start(w->across.first, m->reach, m->width_px, m->piece_width_px);
  w->top = part_start(w->down.first, m->reach, m->height_px, m->piece_height_px);
}

/* Fills a corner's source with the share of its node, dark around the piece. */
static void cut_out(float *to, const work *w, const placido_mosaic *m, int corner) {
  const size_t stride = (size_t)m->piece_width_px;
  const float column = (float)(w->column + corner % 2), row = (float)(w->row + corner / 2);
  memset(to, 0, stride * (size_t)m->piece_height_px * sizeof *to);
  for (int y = w->down.first; y < w->down.first + w->down.count; y++) {
    const float share = 1 - fabsf(m->down[y] - row);
    const float *from = w->sheet->source + (size_t)y * (size_t)m->width_px;
    float *line = to + (size_t)(y - w->top) * stride - w->left;
    for (int x = w->across.first; x < w->across.first + w->across.count; x++) {
      line[x] = share * (1 - fabsf(m->across[x] - column)) * from[x];
    }
  }
}

static void spread_piece(work *w, const placido_mosaic *m) {
  const size_t area = (size_t)m->piece_width_px * (size_t)m->piece_height_px;
  placido_convolution_term terms[CORNERS];
  const placido_superposition plane = {w->target, terms, CORNERS};
  for (int corner = 0; corner < CORNERS; corner++) {
    int node = (w->row + corner / 2) * m->nodes + w->column + corner % 2;
    float *source = w->sources + (size_t)corner * area;
    cut_out(source, w, m, corner);
    terms[corner] = (placido_convolution_term){source, w->sheet->transfers[node]};
  }
  w->status = placido_convolver_run(m->convolver, &plane, 1, NULL);
}

static void add_in(const work *w, const placido_mosaic *m) {
  const float *from = w->target;
  for (int y = 0; y < m->piece_height_px; y++, from += m->piece_width_px) {
    float *to = w->sheet->target + (size_t)(w->top + y) * (size_t)m->width_px + (size_t)w->left;
    for (int x = 0; x < m->piece_width_px; x++) {
      to[x] += from[x];
    }
  }
}

/* Jobs `first` to before first + count, at the same time; added up in their order. */
static int run_batch(work *works, const placido_mosaic *m, const placido_sheet *sheets, int first,
                     int count, placido_error *err) {
  int status = PLACIDO_OK;
#pragma omp parallel for num_threads(count) if (count > 1)
  for (int i = 0; i < count; i++) {
    aim(&works[i], m, sheets, first + i);
    spread_piece(&works[i], m);
  }
  for (int i = 0; i < count && status == PLACIDO_OK; i++) {
    status = works[i].status;
    if (status == PLACIDO_OK) {
      add_in(&works[i], m);
    }
  }
  return status == PLACIDO_OK
           ? PLACIDO_OK
           : placido_error_set(err, status, "out of memory while light was spread");
}

static int run_pieces(const placido_mosaic *m, const placido_sheet *sheets, int count,
                      placido_error *err) {
  const int jobs = count * pieces(m) * pieces(m), batch = jobs < m->threads ? jobs : m->threads;
  const size_t area = (size_t)m->piece_width_px * (size_t)m->piece_height_px;
  work *works = placido_memory_new((size_t)batch, sizeof *works, err);
  float *room = placido_memory_new((size_t)batch * (CORNERS + 1), area * sizeof *room, err);
  int status = works != NULL && room != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
  for (int i = 0; i < batch && status == PLACIDO_OK; i++) {
    works[i].sources = room + (size_t)i * (CORNERS + 1) * area;
    works[i].target = works[i].sources + CORNERS * area;
  }
  for (int first = 0; first < jobs && status == PLACIDO_OK; first += batch) {
    int rest = jobs - first;
    status = run_batch(works, m, sheets, first, rest < batch ? rest : batch, err);
  }
  placido_memory_free(works);
  placido_memory_free(room);
  return status;
}

int placido_mosaic_run(const placido_mosaic *mosaic, const placido_sheet *sheets, int count,
                       placido_error *err) {
  return mosaic->nodes > 1 ? run_pieces(mosaic, sheets, count, err)
                           : run_whole(mosaic, sheets, count, err);
}
