/* A mesh over the cells of a square grid all of whose corners data support, each cell two
 * triangles; closed, where asked for, by the same cells on the bottom and walls between. */
#include <placido/mesh.h>

#include "base/memory.h"
#include "reconstruct/maps/kinds.h"

#include <math.h>

#define STEP_LEAST_MM 0.01
#define STEP_MOST_MM 1.0
#define NONE ((unsigned)-1)

struct grid {
  int half, size;        /* corners a side: 2 half + 1 */
  double step_mm;
  unsigned char *cell;   /* (size - 1)²; 1 where it is meshed */
  unsigned *corner;      /* size²: number of its vertex, NONE where it has none */
};

static size_t corner_at(const struct grid *g, int i, int j) {
  return (size_t)j * (size_t)g->size + (size_t)i;
}

/* Whether the cell is there; those beyond the grid are not. */
static bool has_cell(const struct grid *g, int i, int j) {
  return i >= 0 && j >= 0 && i < g->size - 1 && j < g->size - 1 &&
         g->cell[(size_t)j * (size_t)(g->size - 1) + (size_t)i];
}

static double position(const struct grid *g, int index) {
  return (index - g->half) * g->step_mm;
}

static bool is_supported(const placido_surface *surface, double x, double y) {
  placido_jet jet;
  return placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, &jet);
}

static void mark_cells(struct grid *g, const placido_surface *surface) {
  for (int j = 0; j < g->size; j++) {
    for (int i = 0; i < g->size; i++) {
      g->corner[corner_at(g, i, j)] =
          is_supported(surface, position(g, i), position(g, j)) ? 0 : NONE;
    }
  }
  for (int j = 0; j < g->size - 1; j++) {
    for (int i = 0; i < g->size - 1; i++) {
      g->cell[(size_t)j * (size_t)(g->size - 1) + (size_t)i] =
          g->corner[corner_at(g, i, j)] != NONE && g->corner[corner_at(g, i + 1, j)] != NONE &&
          g->corner[corner_at(g, i, j + 1)] != NONE &&
          g->corner[corner_at(g, i + 1, j + 1)] != NONE;
    }
  }
}

/* Drops cells that touch others by a corner alone: there the walls of a closed mesh would meet in
 * one edge, which is no body's. */
static void drop_pinches(struct grid *g) {
  for (bool changed = true; changed;) {
    changed = false;
    for (int j = 0; j < g->size; j++) {
      for (int i = 0; i < g->size; i++) {
        bool sw = has_cell(g, i - 1, j - 1), se = has_cell(g, i, j - 1);
        bool nw = has_cell(g, i - 1, j), ne = has_cell(g, i, j);
        if (sw == ne && se == nw && sw != se) {
          int drop_row = j - 1, drop_column = sw ? i - 1 : i;
          g->cell[(size_t)drop_row * (size_t)(g->size - 1) + (size_t)drop_column] = 0;
          changed = true;
        }
      }
    }
  }
}

/* Numbers the corners of the cells that are left; returns how many cells and, in *corners, how many
 * vertices. */
static size_t number_corners(struct grid *g, unsigned *corners) {
  size_t cells = 0;
  *corners = 0;
  for (int j = 0; j < g->size; j++) {
    for (int i = 0; i < g->size; i++) {
      bool needed = has_cell(g, i, j) || has_cell(g, i - 1, j) || has_cell(g, i, j - 1) ||
                    has_cell(g, i - 1, j - 1);
      g->corner[corner_at(g, i, j)] = needed ? (*corners)++ : NONE;
      cells += has_cell(g, i, j);
    }
  }
  return cells;
}

static void place_vertices(placido_mesh *mesh, const struct grid *g,
                           const placido_surface *surface, unsigned corners, double solid_mm) {
  double lowest = INFINITY, vertex_z = placido_surface_vertex_z_mm(surface);
  for (int j = 0; j < g->size; j++) {
    for (int i = 0; i < g->size; i++) {
      unsigned at = g->corner[corner_at(g, i, j)];
      placido_map_point point = {.x_mm = position(g, i), .y_mm = position(g, j)};
      if (at == NONE) {
        continue;
      }
      placido_surface_at(surface, point.x_mm, point.y_mm, &point.jet);
      mesh->vertices_mm[at][0] = point.x_mm;
      mesh->vertices_mm[at][1] = point.y_mm;
      mesh->vertices_mm[at][2] = vertex_z - point.jet.sag;
      mesh->axial_D[at] = placido_map_axial(&point);
      lowest = fmin(lowest, vertex_z - point.jet.sag);
    }
  }
  for (unsigned at = 0; at < corners && solid_mm > 0; at++) {
    double *bottom = mesh->vertices_mm[corners + at];
    bottom[0] = mesh->vertices_mm[at][0];
    bottom[1] = mesh->vertices_mm[at][1];
    bottom[2] = lowest - solid_mm;
    mesh->axial_D[corners + at] = NAN;
  }
}

static void add_triangle(placido_mesh *mesh, unsigned a, unsigned b, unsigned c) {
  unsigned *triangle = mesh->triangles[mesh->triangle_count++];
  triangle[0] = a;
  triangle[1] = b;
  triangle[2] = c;
}

/* The wall below the edge from a to b, which has the cell on its left. */
static void add_wall(placido_mesh *mesh, unsigned a, unsigned b, unsigned down) {
  add_triangle(mesh, a, a + down, b);
  add_triangle(mesh, b, a + down, b + down);
}

static void add_cell(placido_mesh *mesh, const struct grid *g, int i, int j, unsigned down) {
  unsigned sw = g->corner[corner_at(g, i, j)], se = g->corner[corner_at(g, i + 1, j)];
  unsigned nw = g->corner[corner_at(g, i, j + 1)], ne = g->corner[corner_at(g, i + 1, j + 1)];
  add_triangle(mesh, sw, se, ne);
  add_triangle(mesh, sw, ne, nw);
  if (down == 0) {
    return;
  }
  add_triangle(mesh, sw + down, ne + down, se + down);
  add_triangle(mesh, sw + down, nw + down, ne + down);
  if (!has_cell(g, i, j - 1)) {
    add_wall(mesh, sw, se, down);
  }
  if (!has_cell(g, i + 1, j)) {
    add_wall(mesh, se, ne, down);
  }
  if (!has_cell(g, i, j + 1)) {
    add_wall(mesh, ne, nw, down);
  }
  if (!has_cell(g, i - 1, j)) {
    add_wall(mesh, nw, sw, down);
  }
}

static int build(placido_mesh *mesh, struct grid *g, const placido_surface *surface,
                 double solid_mm, placido_error *err) {
  unsigned corners;
  mark_cells(g, surface);
  drop_pinches(g);
  size_t cells = number_corners(g, &corners);
  if (cells == 0) {
    return placido_error_set(err, PLACIDO_QUALITY,
                             "nothing that data support is as wide as a step of %g mm", g->step_mm);
  }
  unsigned down = solid_mm > 0 ? corners : 0;
  mesh->vertex_count = (size_t)corners + down;
  mesh->vertices_mm = placido_memory_new(mesh->vertex_count, sizeof *mesh->vertices_mm, err);
  mesh->axial_D = placido_memory_new(mesh->vertex_count, sizeof *mesh->axial_D, err);
  mesh->triangles = placido_memory_new(cells * (down ? 12 : 2), sizeof *mesh->triangles, err);
  if (!mesh->vertices_mm || !mesh->axial_D || !mesh->triangles) {
    return PLACIDO_MEMORY;
  }
  place_vertices(mesh, g, surface, corners, solid_mm);
  for (int j = 0; j < g->size - 1; j++) {
    for (int i = 0; i < g->size - 1; i++) {
      if (has_cell(g, i, j)) {
        add_cell(mesh, g, i, j, down);
      }
    }
  }
  return PLACIDO_OK;
}

int placido_mesh_new(placido_mesh *mesh, const placido_surface *surface, double step_mm,
                     double solid_mm, placido_error *err) {
  *mesh = (placido_mesh){0};
  if (!(step_mm >= STEP_LEAST_MM && step_mm <= STEP_MOST_MM)) {
    return placido_error_set(err, PLACIDO_INPUT, "a step of %g mm: %g to %g mm is expected",
                             step_mm, STEP_LEAST_MM, STEP_MOST_MM);
  }
  struct grid g = {.step_mm = step_mm,
                   .half = (int)floor(placido_surface_radius_mm(surface) / step_mm)};
  g.size = 2 * g.half + 1;
  size_t corners = (size_t)g.size * (size_t)g.size;
  g.cell = placido_memory_new(corners, sizeof *g.cell, err);
  g.corner = placido_memory_new(corners, sizeof *g.corner, err);
  int status = g.cell && g.corner ? build(mesh, &g, surface, solid_mm, err) : PLACIDO_MEMORY;
  placido_memory_free(g.cell);
  placido_memory_free(g.corner);
  if (status) {
    placido_mesh_free(mesh);
  }
  return status;
}

void placido_mesh_free(placido_mesh *mesh) {
  placido_memory_free(mesh->vertices_mm);
  placido_memory_free(mesh->axial_D);
  placido_memory_free(mesh->triangles);
  *mesh = (placido_mesh){0};
}
