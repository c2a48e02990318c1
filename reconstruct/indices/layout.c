/* The points at which a cornea is sampled, and which of them data support. */
#include "reconstruct/indices/layout.h"

#include "base/memory.h"

#include <math.h>

#define PI 3.14159265358979323846
#define GRID_PER_MM 5
#define GRID_HALF 20   /* 4 mm */
#define MARGIN_MM 0.05 /* from the surface's rim: the vertex of a variant lies elsewhere */
#define AREA_PER_MM 10 /* of the grid on which the whole surface's support is counted */

double placido_ring_radius(int ring) {
  return (ring + 0.5) * PLACIDO_RING_STEP_MM;
}

double placido_ring_area(int ring, double from_diameter_mm, double to_diameter_mm) {
  double inner = fmax(ring * PLACIDO_RING_STEP_MM, from_diameter_mm / 2);
  double outer = fmin((ring + 1) * PLACIDO_RING_STEP_MM, to_diameter_mm / 2);
  return outer > inner ? PI * (outer * outer - inner * inner) / PLACIDO_AZIMUTHS : 0;
}

static double sum_before(const double *before, double azimuth) {
  double turns = floor(azimuth / PLACIDO_AZIMUTHS);
  double rest = azimuth - turns * PLACIDO_AZIMUTHS;
  int whole = (int)rest;
  if (whole >= PLACIDO_AZIMUTHS) { /* rounding */
    whole = PLACIDO_AZIMUTHS - 1;
  }
  return turns * before[PLACIDO_AZIMUTHS] + before[whole] +
         (rest - whole) * (before[whole + 1] - before[whole]);
}

double placido_arcs_sum(const placido_arcs *arcs, int ring, double from, double to) {
  return sum_before(arcs->before[ring], to) - sum_before(arcs->before[ring], from);
}

double placido_layout_share(const placido_layout *layout, double from_diameter_mm,
                            double to_diameter_mm) {
  double supported = 0, area = 0;
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double weight = placido_ring_area(ring, from_diameter_mm, to_diameter_mm);
    supported += weight * layout->support.before[ring][PLACIDO_AZIMUTHS];
    area += weight * PLACIDO_AZIMUTHS;
  }
  return area > 0 ? supported / area : 0;
}

/* The surface has data at the point, and still has a value when the point moves a little. */
static bool is_supported(const placido_surface *surface, double x, double y) {
  placido_jet jet;
  return hypot(x, y) <= placido_surface_radius_mm(surface) - MARGIN_MM &&
         placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, &jet);
}

static void fill_rings(placido_layout *layout, const placido_surface *surface) {
  placido_vertex centre = layout->vertex;
  if (isnan(centre.x_mm)) { /* then only the shares are of use */
    centre = (placido_vertex){0, 0};
  }
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double radius = placido_ring_radius(ring), *before = layout->support.before[ring];
    for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
      double x = centre.x_mm + radius * layout->cosine[a];
      double y = centre.y_mm + radius * layout->sine[a];
      layout->covered[ring][a] = is_supported(surface, x, y);
      before[a + 1] = before[a] + layout->covered[ring][a];
    }
  }
}

static void fill_grid(placido_layout *layout, const placido_surface *surface) {
  for (int j = -GRID_HALF; j <= GRID_HALF; j++) {
    for (int i = -GRID_HALF; i <= GRID_HALF; i++) {
      double x = i / (double)GRID_PER_MM, y = j / (double)GRID_PER_MM;
      if (i * i + j * j > GRID_HALF * GRID_HALF) {
        continue;
      }
      layout->grid_sampled++;
      if (placido_surface_covered(surface, x, y) && is_supported(surface, x, y)) {
        layout->grid[layout->grid_count][0] = x;
        layout->grid[layout->grid_count++][1] = y;
      }
    }
  }
}

static double share_of_disc(const placido_surface *surface) {
  int half = (int)(placido_surface_radius_mm(surface) * AREA_PER_MM);
  size_t supported = 0, points = 0;
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      if (i * i + j * j <= half * half) {
        points++;
        supported +=
            placido_surface_covered(surface, i / (double)AREA_PER_MM, j / (double)AREA_PER_MM);
      }
    }
  }
  return (double)supported / (double)points;
}

int placido_layout_new(placido_layout **layout, const placido_surface *surface,
                       placido_error *err) {
  const size_t side = 2 * GRID_HALF + 1;
  *layout = NULL;
  placido_layout *made = placido_memory_new(1, sizeof *made, err);
  if (!made) {
    return PLACIDO_MEMORY;
  }
  made->grid = placido_memory_new(side * side, sizeof *made->grid, err);
  if (!made->grid) {
    placido_layout_free(made);
    return PLACIDO_MEMORY;
  }
  for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
    made->cosine[a] = cos(2 * PI * a / PLACIDO_AZIMUTHS);
    made->sine[a] = sin(2 * PI * a / PLACIDO_AZIMUTHS);
  }
  made->vertex = placido_vertex_find(surface);
  fill_rings(made, surface);
  fill_grid(made, surface);
  made->analysed = share_of_disc(surface);
  *layout = made;
  return PLACIDO_OK;
}

void placido_layout_free(placido_layout *layout) {
  if (layout) {
    placido_memory_free(layout->grid);
    placido_memory_free(layout);
  }
}
