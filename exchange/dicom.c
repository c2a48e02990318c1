/* Writes a DICOM map: a folder with the dump, the picture and its palette, made into one file by
 * dump2dcm. DCMTK is used as a program, as its library is C++. */
#include "exchange/dicom.h"

#include "base/file.h"
#include "base/memory.h"
#include "exchange/colour.h"
#include "exchange/process.h"
#include "reconstruct/maps/kinds.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define STEP_USUAL_MM 0.25
#define STEP_LEAST_MM 0.05
#define STEP_MOST_MM 1.0
#define DUMP "map.dump"
#define RESULT "map.dcm"
#define SAID "said.txt"

const char *const placido_dicom_palettes[3] = {"red.raw", "green.raw", "blue.raw"};

static int put_words(const uint16_t *words, size_t count, const char *folder, const char *name,
                     placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file;
  int status = placido_path_join(path, folder, name, err);
  if (status || (status = placido_file_create(&file, path, err))) {
    return status;
  }
  for (size_t i = 0; i < count; i++) { /* little-endian, as dump2dcm takes them */
    fputc(words[i] & 255, file.stream);
    fputc(words[i] >> 8, file.stream);
  }
  return placido_file_commit(&file, err);
}

/* The stored value at a place: 0 where there are no data. */
static uint16_t level_at(const placido_surface *surface, double x, double y) {
  placido_map_point point = {.x_mm = x, .y_mm = y};
  if (!placido_surface_covered(surface, x, y) || !placido_surface_at(surface, x, y, &point.jet)) {
    return 0;
  }
  double level =
      round((placido_map_axial(&point) - PLACIDO_DICOM_LEAST_D) / PLACIDO_DICOM_STEP_D);
  return (uint16_t)fmin(fmax(level, 1), PLACIDO_DICOM_LEVELS - 1);
}

static int save_picture(placido_dicom_map *map, const placido_surface *surface,
                        const char *folder, placido_error *err) {
  double radius = placido_surface_radius_mm(surface);
  int half_x = (int)ceil(radius / PLACIDO_DICOM_PIXEL_X_MM);
  int half_y = (int)ceil(radius / PLACIDO_DICOM_PIXEL_Y_MM);
  map->columns = 2 * half_x + 1;
  map->rows = 2 * half_y + 1;
  map->centre_px[0] = half_x + 0.5 + map->figures.vertex_mm[0] / PLACIDO_DICOM_PIXEL_X_MM;
  map->centre_px[1] = half_y + 0.5 - map->figures.vertex_mm[1] / PLACIDO_DICOM_PIXEL_Y_MM;
  size_t columns = (size_t)map->columns, count = columns * (size_t)map->rows;
  uint16_t *pixels = placido_memory_new(count, sizeof *pixels, err);
  if (!pixels) {
    return PLACIDO_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    double x = ((double)(i % columns) - half_x) * PLACIDO_DICOM_PIXEL_X_MM;
    double y = (half_y - (double)(i / columns)) * PLACIDO_DICOM_PIXEL_Y_MM;
    pixels[i] = level_at(surface, x, y);
  }
  int status = put_words(pixels, count, folder, PLACIDO_DICOM_PIXELS, err);
  placido_memory_free(pixels);
  return status;
}

static int save_palettes(const char *folder, placido_error *err) {
  uint16_t words[PLACIDO_DICOM_LEVELS];
  int status = PLACIDO_OK;
  for (int channel = 0; channel < 3 && !status; channel++) {
    words[0] = 0; /* black where there are no data */
    for (int k = 1; k < PLACIDO_DICOM_LEVELS; k++) {
      double colour[3];
      placido_power_colour(colour, PLACIDO_DICOM_LEAST_D + k * PLACIDO_DICOM_STEP_D);
      words[k] = (uint16_t)lrint(65535 * colour[channel]);
    }
    status = put_words(words, PLACIDO_DICOM_LEVELS, folder, placido_dicom_palettes[channel], err);
  }
  return status;
}

static int save_dump(const placido_dicom_map *map, const char *folder, placido_error *err) {
  char path[PLACIDO_PATH_MAX];
  placido_file file;
  int status = placido_path_join(path, folder, DUMP, err);
  if (status || (status = placido_file_create(&file, path, err))) {
    return status;
  }
  placido_dicom_dump(file.stream, map);
  return placido_file_commit(&file, err);
}

/* Runs dump2dcm in the folder and puts its result in its place. */
static int convert(const char *folder, const char *path, placido_error *err) {
  static const char *const arguments[] = {"dump2dcm", "-ll", "error", "+te", DUMP, RESULT, NULL};
  char result[PLACIDO_PATH_MAX], *bytes;
  size_t size;
  int status = placido_process_run(arguments, folder, SAID, err);
  if (status == PLACIDO_UNSUPPORTED) {
    return placido_error_set(err, status, "no DICOM file: DCMTK's dump2dcm is not installed "
                             "(Debian's package dcmtk)");
  }
  if (status || (status = placido_path_join(result, folder, RESULT, err)) ||
      (status = placido_file_read(&bytes, &size, result, 0, err))) {
    return status;
  }
  placido_file file;
  status = placido_file_create(&file, path, err);
  if (!status) {
    fwrite(bytes, 1, size, file.stream);
    status = placido_file_commit(&file, err);
  }
  placido_memory_free(bytes);
  return status;
}

/* "2026-11-22T10:00:00Z" into DICOM's date and time; now where there is none. */
static int read_time(placido_dicom_map *map, placido_error *err) {
  const char *text = map->info->created;
  time_t now = time(NULL);
  struct tm utc;
  if (!text) {
    bool known = gmtime_r(&now, &utc) && strftime(map->date, sizeof map->date, "%Y%m%d", &utc) &&
                 strftime(map->time, sizeof map->time, "%H%M%S", &utc);
    return known ? PLACIDO_OK : placido_error_set(err, PLACIDO_SYSTEM, "the clock is not set");
  }
  int year, month, day, hour, minute, second;
  if (sscanf(text, "%4d-%2d-%2dT%2d:%2d:%2d", &year, &month, &day, &hour, &minute, &second) != 6 ||
      strlen(text) < 19) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "created \"%.40s\": a time like 2026-11-22T10:00:00Z is expected",
                             text);
  }
  snprintf(map->date, sizeof map->date, "%.4s%.2s%.2s", text, text + 5, text + 8);
  snprintf(map->time, sizeof map->time, "%.2s%.2s%.2s", text + 11, text + 14, text + 17);
  return PLACIDO_OK;
}

static int check(const placido_dicom_info *info, placido_error *err) {
  if (!info->eye || (strcmp(info->eye, "OD") != 0 && strcmp(info->eye, "OS") != 0)) {
    return placido_error_set(err, PLACIDO_INPUT, "DICOM must know which eye it is, OD or OS");
  }
  if (info->step_mm != 0 && !(info->step_mm >= STEP_LEAST_MM && info->step_mm <= STEP_MOST_MM)) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "points every %g mm: %g to %g mm are expected in DICOM",
                             info->step_mm, STEP_LEAST_MM, STEP_MOST_MM);
  }
  return PLACIDO_OK;
}

static int save_all(placido_dicom_map *map, const placido_surface *surface, const char *folder,
                    const char *path, placido_error *err) {
  int status = save_picture(map, surface, folder, err);
  if (status || (status = save_palettes(folder, err)) ||
      (status = save_dump(map, folder, err))) {
    return status;
  }
  return convert(folder, path, err);
}

int placido_dicom_save(const placido_surface *surface, const placido_dicom_info *info,
                       const char *path, placido_error *err) {
  placido_dicom_map map = {.info = info};
  placido_directory folder = {0};
  char beside[PLACIDO_PATH_MAX];
  int status = check(info, err);
  if (!status) {
    status = read_time(&map, err);
  }
  for (unsigned k = 0; k < PLACIDO_DICOM_UIDS && !status; k++) {
    status = placido_uid_make(map.uids[k], info->uid_seed, k, err);
  }
  if (!status) {
    double step_mm = info->step_mm != 0 ? info->step_mm : STEP_USUAL_MM;
    status = placido_dicom_measure(&map, surface, step_mm, err);
  }
  if (!status && snprintf(beside, sizeof beside, "%s.parts", path) >= (int)sizeof beside) {
    status = placido_error_set(err, PLACIDO_INPUT, "the name of the DICOM file is too long");
  }
  if (!status) {
    status = placido_directory_create(&folder, beside, NULL, err);
  }
  if (!status) {
    status = save_all(&map, surface, folder.temporary, path, err);
  }
  placido_directory_discard(&folder);
  placido_maps_free(&map.points);
  placido_memory_free(map.wavefront_um);
  return status;
}
