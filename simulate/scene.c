/* Scenes: a generated chart within its bleed, or what a scene file says. */
#include "base/memory.h"
#include "simulate/charts/chart.h"
#include "simulate/depth/map.h"
#include "simulate/scene_file.h"

#include <placido/scene.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double usual_arcmin_per_px = 0.5;
static const double chart_bleed_arcmin = 64; /* 128 buckets of half a minute to a side */

/* Copies `alone` into the middle of `whole` and continues its rim outwards. */
static void extend(placido_image *whole, const placido_image *alone, int bleed) {
  size_t width = (size_t)alone->width_px, wide = (size_t)whole->width_px;
  for (int plane = 0; plane < alone->planes; plane++) {
    const float *source = placido_image_plane(alone, plane);
    float *row = placido_image_plane(whole, plane);
    for (int y = 0; y < whole->height_px; y++, row += wide) {
      int from = y < bleed ? 0 : y - bleed < alone->height_px ? y - bleed : alone->height_px - 1;
      const float *samples = &source[(size_t)from * width];
      memcpy(&row[bleed], samples, width * sizeof *row);
      for (int x = 0; x < bleed; x++) {
        row[x] = samples[0];
        row[wide - 1 - (size_t)x] = samples[width - 1];
      }
    }
  }
}

static int draw(placido_scene *scene, const placido_chart *chart, const placido_chart_lines *lines,
                double arcmin_per_px, placido_error *err) {
  placido_image alone;
  int status = placido_chart_new(&alone, chart, lines, arcmin_per_px, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  int bleed = (int)ceil(chart_bleed_arcmin / arcmin_per_px);
  status = placido_image_new(&scene->image, alone.width_px + 2 * bleed,
                             alone.height_px + 2 * bleed, alone.planes, err);
  if (status == PLACIDO_OK) {
    extend(&scene->image, &alone, bleed);
    snprintf(scene->name, sizeof scene->name, "%s", chart->name);
    scene->arcmin_per_px = arcmin_per_px;
    scene->bleed_px = bleed;
    scene->bits = 8;
    scene->conditions = placido_conditions_of(chart);
  }
  if (status == PLACIDO_OK && chart->vergence_D != NULL) {
    status = placido_depth_draw(scene, chart->vergence_D, err);
  }
  placido_image_free(&alone);
  return status;
}

/* Neither a chart nor a file: both may have been meant. */
static int refuse_name(const char *name, placido_error *err) {
  size_t count;
  const placido_chart *charts = placido_chart_table(&count);
  char list[512] = "";
  for (size_t i = 0; i < count; i++) {
    size_t used = strlen(list);
    snprintf(list + used, sizeof list - used, "%s%s", i > 0 ? ", " : "", charts[i].name);
  }
  return placido_error_set(err, PLACIDO_INPUT,
                           "there is no chart called %s and no such scene file; charts: %s", name,
                           list);
}

static double usual_scale(double chart_arcmin_per_px) {
  return chart_arcmin_per_px > 0 ? chart_arcmin_per_px : usual_arcmin_per_px;
}

int placido_scene_draw(placido_scene *scene, const char *name, const placido_chart_lines *lines,
                       double arcmin_per_px, placido_error *err) {
  *scene = (placido_scene){0};
  const placido_chart *chart = placido_chart_find(name);
  int status = chart != NULL ? draw(scene, chart, lines, usual_scale(arcmin_per_px), err)
                             : refuse_name(name, err);
  if (status != PLACIDO_OK) {
    placido_scene_free(scene);
  }
  return status;
}

/* Whether a name that no file has looks like a chart's. */
static bool looks_like_chart(const char *name) {
  FILE *file = strpbrk(name, "./") == NULL ? fopen(name, "rb") : NULL;
  if (file != NULL) {
    fclose(file);
    return false;
  }
  return strpbrk(name, "./") == NULL;
}

int placido_scene_load(placido_scene *scene, const char *name_or_path, double chart_arcmin_per_px,
                       placido_notes *notes, placido_error *err) {
  *scene = (placido_scene){0};
  double scale = usual_scale(chart_arcmin_per_px);
  if (placido_chart_find(name_or_path) != NULL || looks_like_chart(name_or_path)) {
    return placido_scene_draw(scene, name_or_path, NULL, scale, err);
  }
  int status = placido_scene_read(scene, name_or_path, scale, notes, err);
  if (status != PLACIDO_OK) {
    placido_scene_free(scene);
  }
  return status;
}

void placido_scene_free(placido_scene *scene) {
  if (scene != NULL) {
    placido_image_free(&scene->image);
    placido_memory_free(scene->depth_D);
    *scene = (placido_scene){0};
  }
}
