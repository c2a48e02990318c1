/* `placido export`: a measured cornea in the formats of others. */
#include "acquire/cli/command.h"
#include "base/file.h"
#include "base/json.h"

#include <placido/dicom.h>
#include <placido/expansion.h>
#include <placido/mesh.h>

#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define ORDER 8
#define STEP_MM 0.1
#define TEXT_MAX 128

/* What is exported, and what its examination says of it; empty texts are not known. */
struct cornea {
  const struct settings *settings;
  placido_surface *surface;
  char eye[8], created[TEXT_MAX], maker[TEXT_MAX], model[TEXT_MAX], serial[TEXT_MAX];
};

/* The records that a directory may have, and their formats. */
static const struct {
  const char *name, *format;
} records[] = {{"exam.json", "placido-exam/1"},
               {"reconstruction.json", "placido-reconstruction/1"},
               {"import.json", "placido-import/1"}};

static void take_text(char *text, size_t size, const placido_json *record, const char *path) {
  if (!placido_json_find(record, path) ||
      placido_json_string(record, path, text, size, NULL) != PLACIDO_OK) {
    text[0] = '\0';
  }
}

/* What the record of the surface's directory says; a surface may also stand alone. */
static void read_record(struct cornea *cornea, const char *directory) {
  for (size_t i = 0; i < sizeof records / sizeof records[0]; i++) {
    char path[PLACIDO_PATH_MAX];
    placido_json *record = NULL;
    if (placido_path_join(path, directory, records[i].name, NULL) == PLACIDO_OK &&
        placido_json_load(&record, path, records[i].format, NULL) == PLACIDO_OK) {
      take_text(cornea->eye, sizeof cornea->eye, record, "input.eye");
      take_text(cornea->created, TEXT_MAX, record, "created");
      take_text(cornea->maker, TEXT_MAX, record, "input.vendor");
      take_text(cornea->model, TEXT_MAX, record, "input.model");
      take_text(cornea->serial, TEXT_MAX, record, "input.serial");
    }
    placido_json_free(record);
  }
}

static int read_cornea(struct cornea *cornea, placido_notes *notes, placido_error *err) {
  const char *input = cornea->settings->input;
  char path[PLACIDO_PATH_MAX];
  struct stat found;
  if (stat(input, &found) != 0 || !S_ISDIR(found.st_mode)) {
    return placido_surface_load(&cornea->surface, input, notes, err);
  }
  read_record(cornea, input);
  const int status = placido_path_join(path, input, "surface.json", err);
  return status == PLACIDO_OK ? placido_surface_load(&cornea->surface, path, notes, err) : status;
}

static double step_mm(const struct cornea *cornea) {
  const double asked = cornea->settings->exchange.step_mm;
  return asked > 0 ? asked : STEP_MM;
}

static int export_zernike(const struct cornea *cornea, const char *path, placido_error *err) {
  const struct exchange_settings *wanted = &cornea->settings->exchange;
  placido_expansion expansion;
  int status = placido_expansion_find(&expansion, cornea->surface, NULL, wanted->radius_mm,
                                      wanted->order > 0 ? wanted->order : ORDER, err);
  if (status == PLACIDO_OK) {
    status = placido_expansion_save(&expansion, path, err);
  }
  if (status == PLACIDO_OK) {
    say(cornea->settings, "%s: %d terms on %.3g mm leave %.3f um rms, at most %.2f um", path,
        expansion.count, expansion.radius_mm, expansion.rms_um, expansion.worst_um);
  }
  return status;
}

static int export_mesh(const struct cornea *cornea, const char *path,
                       int (*save)(const placido_mesh *, const char *, placido_error *),
                       placido_error *err) {
  placido_mesh mesh;
  int status = placido_mesh_new(&mesh, cornea->surface, step_mm(cornea),
                                cornea->settings->exchange.solid_mm, err);
  if (status == PLACIDO_OK) {
    status = save(&mesh, path, err);
  }
  if (status == PLACIDO_OK) {
    say(cornea->settings, "%s: %zu triangles", path, mesh.triangle_count);
  }
  placido_mesh_free(&mesh);
  return status;
}

static int export_stl(const struct cornea *cornea, const char *path, placido_error *err) {
  return export_mesh(cornea, path, placido_mesh_save_stl, err);
}

static int export_ply(const struct cornea *cornea, const char *path, placido_error *err) {
  return export_mesh(cornea, path, placido_mesh_save_ply, err);
}

static int export_csv(const struct cornea *cornea, const char *path, placido_error *err) {
  const int status = placido_surface_save_grid(cornea->surface, step_mm(cornea), path, err);
  if (status == PLACIDO_OK) {
    say(cornea->settings, "%s: heights every %g mm", path, step_mm(cornea));
  }
  return status;
}

static const char *or_null(const char *text) {
  return text[0] ? text : NULL;
}

static int export_dicom(const struct cornea *cornea, const char *path, placido_error *err) {
  const struct exchange_settings *wanted = &cornea->settings->exchange;
  const placido_dicom_info info = {.eye = wanted->eye ? wanted->eye : or_null(cornea->eye),
                                   .patient_id = wanted->subject,
                                   .created = or_null(cornea->created),
                                   .software = PROGRAM_VERSION,
                                   .maker = or_null(cornea->maker),
                                   .model = or_null(cornea->model),
                                   .serial = or_null(cornea->serial),
                                   .uid_seed = wanted->uid_seed,
                                   .step_mm = wanted->step_mm};
  if (!info.eye) {
    return placido_error_set(err, STATUS_USAGE, "--dicom must know which eye it is: --eye OD or "
                             "--eye OS");
  }
  const int status = placido_dicom_save(cornea->surface, &info, path, err);
  if (status == PLACIDO_OK) {
    say(cornea->settings, "%s: DICOM Corneal Topography Map", path);
  }
  return status;
}

/* What can be asked for. */
static const struct product {
  const char *name;
  size_t offset; /* of the path within the settings */
  int (*save)(const struct cornea *cornea, const char *path, placido_error *err);
} products[] = {
    {"zernike", offsetof(struct exchange_settings, zernike), export_zernike},
    {"stl", offsetof(struct exchange_settings, stl), export_stl},
    {"ply", offsetof(struct exchange_settings, ply), export_ply},
    {"csv", offsetof(struct exchange_settings, csv), export_csv},
    {"dicom", offsetof(struct exchange_settings, dicom), export_dicom},
};
#define PRODUCTS (sizeof products / sizeof products[0])

static const char *path_of(const struct settings *settings, const struct product *product) {
  return *(const char *const *)((const char *)&settings->exchange + product->offset);
}

/* No file may be asked for twice; something must be. */
static int check(const struct settings *settings, placido_error *err) {
  size_t wanted = 0;
  for (size_t i = 0; i < PRODUCTS; i++) {
    const char *path = path_of(settings, &products[i]);
    wanted += path != NULL;
    for (size_t k = 0; path && k < i; k++) {
      const char *other = path_of(settings, &products[k]);
      if (other && strcmp(path, other) == 0) {
        return placido_error_set(err, STATUS_USAGE, "--%s and --%s name one file, %s",
                                 products[k].name, products[i].name, path);
      }
    }
  }
  return wanted > 0 ? PLACIDO_OK
                    : placido_error_set(err, STATUS_USAGE, "say what to write: --zernike, --stl, "
                                        "--ply, --csv or --dicom");
}

static int write_products(const struct cornea *cornea, struct outcome *outcome,
                          placido_error *err) {
  int status = PLACIDO_OK;
  json_t *files = json_object();
  for (size_t i = 0; i < PRODUCTS && status == PLACIDO_OK; i++) {
    const char *path = path_of(cornea->settings, &products[i]);
    if (path) {
      stages_next(&outcome->stages, "%s", products[i].name);
      status = products[i].save(cornea, path, err);
      json_object_set_new(files, products[i].name, json_string(path));
    }
  }
  outcome->result = json_object();
  json_object_set_new(outcome->result, "files", files);
  return status;
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct cornea cornea = {.settings = settings};
  settings_use_threads(settings);
  int status = check(settings, err);
  if (status == PLACIDO_OK) {
    stages_next(&outcome->stages, "read");
    status = read_cornea(&cornea, &outcome->notes, err);
  }
  if (status == PLACIDO_OK) {
    status = write_products(&cornea, outcome, err);
  }
  placido_surface_free(cornea.surface);
  return status;
}

static const struct option_group *const groups[] = {&options_export, &options_general, NULL};

const struct command command_export = {
    .name = "export",
    .summary = "Give a measured cornea to others: Zernike terms, meshes, grids, DICOM.",
    .usage = "DIR|SURFACE.json OPTION...",
    .examples = "  placido export exam --zernike terms.json --radius 3 --order 8\n"
                "  placido export exam --stl cornea.stl --solid 2 --ply cornea.ply\n"
                "  placido export exam/surface.json --csv heights.csv --step 0.2\n"
                "  placido export exam --dicom map.dcm --eye OD\n",
    .groups = groups,
    .needs_word = "DIR (of an exam, a reconstruction or an import) or SURFACE.json",
    .run = run,
};
