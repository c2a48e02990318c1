/* Meshes and grids as files. Binary numbers are little-endian, whatever the machine. */
#include "base/file.h"
#include "exchange/colour.h"

#include <placido/mesh.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define STL_HEADER 80
#define STEP_LEAST_MM 0.01
#define STEP_MOST_MM 1.0
#define EDGE_MM 1e-12 /* as for the surface */

static void put_integer(FILE *stream, uint32_t value) {
  const unsigned char bytes[4] = {value & 255, value >> 8 & 255, value >> 16 & 255, value >> 24};
  fwrite(bytes, 1, sizeof bytes, stream);
}

static void put_real(FILE *stream, double value) {
  float narrow = (float)value;
  uint32_t bits;
  memcpy(&bits, &narrow, sizeof bits);
  put_integer(stream, bits);
}

static void put_place(FILE *stream, const double place[3]) {
  for (int k = 0; k < 3; k++) {
    put_real(stream, place[k]);
  }
}

/* The unit normal, outwards: the corners stand counter-clockwise. */
static void find_normal(double normal[3], const placido_mesh *mesh, const unsigned *triangle) {
  const double *a = mesh->vertices_mm[triangle[0]], *b = mesh->vertices_mm[triangle[1]];
  const double *c = mesh->vertices_mm[triangle[2]];
  double u[3], v[3], length = 0;
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
  }
  for (int k = 0; k < 3; k++) {
    int l = (k + 1) % 3, m = (k + 2) % 3;
    normal[k] = u[l] * v[m] - u[m] * v[l];
    length += normal[k] * normal[k];
  }
  for (int k = 0; k < 3; k++) {
    normal[k] /= sqrt(length);
  }
}

int placido_mesh_save_stl(const placido_mesh *mesh, const char *path, placido_error *err) {
  /* a header that begins with "solid" would be taken for the text form */
  const char header[STL_HEADER] = "Placido: a cornea, mm, z towards the camera";
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  fwrite(header, 1, sizeof header, file.stream);
  put_integer(file.stream, (uint32_t)mesh->triangle_count);
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    double normal[3];
    find_normal(normal, mesh, mesh->triangles[i]);
    put_place(file.stream, normal);
    for (int k = 0; k < 3; k++) {
      put_place(file.stream, mesh->vertices_mm[mesh->triangles[i][k]]);
    }
    fwrite("\0\0", 1, 2, file.stream); /* no attributes */
  }
  return placido_file_commit(&file, err);
}

int placido_mesh_save_ply(const placido_mesh *mesh, const char *path, placido_error *err) {
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  fprintf(file.stream,
          "ply\nformat binary_little_endian 1.0\ncomment Placido: a cornea, mm, z towards the "
          "camera\nelement vertex %zu\nproperty float x\nproperty float y\nproperty float z\n"
          "property float axial_D\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
          "element face %zu\nproperty list uchar int vertex_indices\nend_header\n",
          mesh->vertex_count, mesh->triangle_count);
  for (size_t i = 0; i < mesh->vertex_count; i++) {
    double colour[3];
    placido_power_colour(colour, mesh->axial_D[i]);
    put_place(file.stream, mesh->vertices_mm[i]);
    put_real(file.stream, mesh->axial_D[i]);
    for (int k = 0; k < 3; k++) {
      fputc((int)lrint(255 * colour[k]), file.stream);
    }
  }
  for (size_t i = 0; i < mesh->triangle_count; i++) {
    fputc(3, file.stream);
    for (int k = 0; k < 3; k++) {
      put_integer(file.stream, mesh->triangles[i][k]);
    }
  }
  return placido_file_commit(&file, err);
}

static void print_row(FILE *stream, const placido_surface *surface, double x, double y) {
  placido_jet jet;
  if (hypot(x, y) > placido_surface_radius_mm(surface) + EDGE_MM) {
    return;
  }
  fprintf(stream, "%.10g,%.10g,", x, y); /* steps are decimal: 0.3, not 0.30000000000000004 */
  if (placido_surface_covered(surface, x, y) && placido_surface_at(surface, x, y, &jet)) {
    fprintf(stream, "%.17g", placido_surface_vertex_z_mm(surface) - jet.sag);
  }
  fputc('\n', stream);
}

int placido_surface_save_grid(const placido_surface *surface, double step_mm, const char *path,
                              placido_error *err) {
  if (!(step_mm >= STEP_LEAST_MM && step_mm <= STEP_MOST_MM)) {
    return placido_error_set(err, PLACIDO_INPUT, "a step of %g mm: %g to %g mm is expected",
                             step_mm, STEP_LEAST_MM, STEP_MOST_MM);
  }
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  int half = (int)floor(placido_surface_radius_mm(surface) / step_mm + EDGE_MM);
  fputs("x_mm,y_mm,z_mm\n", file.stream);
  for (int j = -half; j <= half; j++) {
    for (int i = -half; i <= half; i++) {
      print_row(file.stream, surface, i * step_mm, j * step_mm);
    }
  }
  return placido_file_commit(&file, err);
}
