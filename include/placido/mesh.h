/* The cornea as triangles, for printers and viewers, and as a table of heights. */
#ifndef PLACIDO_MESH_H
#define PLACIDO_MESH_H

#include <placido/surface.h>

/* Triangles are counter-clockwise seen from outside; on the cornea that is from the camera. */
typedef struct placido_mesh {
  size_t vertex_count, triangle_count;
  double (*vertices_mm)[3];
  double *axial_D;           /* of every vertex; NaN where it is no point of the cornea */
  unsigned (*triangles)[3];
} placido_mesh;

/* Meshes what data support, on a square grid of step_mm. `solid_mm` > 0 closes the mesh by walls
 * and a flat bottom so far below the lowest point: then every edge belongs to exactly two
 * triangles. Free with placido_mesh_free. Returns PLACIDO_OK, PLACIDO_INPUT (step not within 0.01
 * to 1 mm), PLACIDO_QUALITY (nothing supported is a step wide), PLACIDO_MEMORY. */
int placido_mesh_new(placido_mesh *mesh, const placido_surface *surface, double step_mm,
                     double solid_mm, placido_error *err);
void placido_mesh_free(placido_mesh *mesh);

/* Binary STL, mm. By way of a temporary name, as all files here. */
int placido_mesh_save_stl(const placido_mesh *mesh, const char *path, placido_error *err);

/* Binary PLY, mm: vertices with axial power as a number (axial_D) and as a colour, from blue (30 D
 * and less) over green (45 D) to red (60 D and more), grey where there is none. */
int placido_mesh_save_ply(const placido_mesh *mesh, const char *path, placido_error *err);

/* A CSV of x_mm,y_mm,z_mm on a square grid within the surface's radius, y outer and upwards; z is
 * empty where data do not support it. PLACIDO_INPUT where step_mm is not within 0.01 to 1. */
int placido_surface_save_grid(const placido_surface *surface, double step_mm, const char *path,
                              placido_error *err);

#endif
