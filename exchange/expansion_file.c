/* Zernike terms as a file: `placido-zernike/1`, or a CSV for spreadsheets. */
#include "base/file.h"
#include "base/json.h"

#include <placido/expansion.h>
#include <placido/zernike.h>

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define FORMAT "placido-zernike/1"

static json_t *write_term(const placido_expansion *e, int j) {
  int n, m;
  placido_zernike_name(j, &n, &m);
  json_t *term = json_object();
  if (json_object_set_new(term, "index", json_integer(j)) ||
      json_object_set_new(term, "n", json_integer(n)) ||
      json_object_set_new(term, "m", json_integer(m)) ||
      json_object_set_new(term, "coefficient_um", placido_json_real(e->coefficients_um[j])) ||
      json_object_set_new(term, "sigma_um", placido_json_real(e->sigma_um[j]))) {
    json_decref(term);
    return NULL;
  }
  return term;
}

static int fill(json_t *root, json_t *terms, const placido_expansion *e) {
  for (int j = 0; j < e->count; j++) {
    if (json_array_append_new(terms, write_term(e, j))) {
      return -1;
    }
  }
  return json_object_set_new(root, "format", json_string(FORMAT)) ||
         json_object_set_new(root, "quantity", json_string("sag")) ||
         json_object_set_new(root, "radius_mm", placido_json_real(e->radius_mm)) ||
         json_object_set_new(root, "order", json_integer(e->order)) ||
         json_object_set_new(root, "vertex_z_mm", placido_json_real(e->vertex_z_mm)) ||
         json_object_set_new(root, "covered", placido_json_real(e->covered)) ||
         json_object_set_new(root, "residual_rms_um", placido_json_real(e->rms_um)) ||
         json_object_set_new(root, "residual_worst_um", placido_json_real(e->worst_um)) ||
         json_object_set(root, "terms", terms);
}

static int save_json(const placido_expansion *e, const char *path, placido_error *err) {
  json_t *root = json_object(), *terms = json_array();
  int status = fill(root, terms, e)
                   ? placido_error_set(err, PLACIDO_MEMORY, "out of memory writing Zernike terms")
                   : placido_json_save(root, path, err);
  json_decref(terms);
  json_decref(root);
  return status;
}

static int save_csv(const placido_expansion *e, const char *path, placido_error *err) {
  placido_file file;
  int status = placido_file_create(&file, path, err);
  if (status) {
    return status;
  }
  fprintf(file.stream, "# OSA/ANSI Zernike terms of the sag, radius %.17g mm, vertex_z %.17g mm\n"
          "index,n,m,coefficient_um,sigma_um\n", e->radius_mm, e->vertex_z_mm);
  for (int j = 0; j < e->count; j++) {
    int n, m;
    placido_zernike_name(j, &n, &m);
    fprintf(file.stream, "%d,%d,%d,%.17g,", j, n, m, e->coefficients_um[j]);
    if (isfinite(e->sigma_um[j])) {
      fprintf(file.stream, "%.17g", e->sigma_um[j]);
    }
    fputc('\n', file.stream);
  }
  return placido_file_commit(&file, err);
}

int placido_expansion_save(const placido_expansion *expansion, const char *path,
                           placido_error *err) {
  size_t length = strlen(path);
  bool csv = length >= 4 && strcasecmp(path + length - 4, ".csv") == 0;
  return csv ? save_csv(expansion, path, err) : save_json(expansion, path, err);
}
