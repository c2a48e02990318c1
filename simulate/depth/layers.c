/* Layers of a scene in depth: each pixel belongs to the two levels around its vergence, linearly;
 * behind an edge at which the distance jumps a layer goes on as the nearest pixel that shows.
 *
 * B. A. Barsky, "Vision-realistic rendering: simulation of the scanned foveal image from wavefront
 * data of human subjects" (2004), has layers uniform in dioptres and their occlusion. */
#include "simulate/depth/layers.h"

#include "base/memory.h"
#include "simulate/canvas.h"
#include "simulate/depth/levels.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double arcmin_rad = 2.908882e-4;

/* Steps in which the disc of blur grows by so much: finer ones change nothing that is seen. */
static const double finest_step_arcmin = 0.25;

/* Where a pixel's levels are: the farther one, and its share in the next nearer. */
typedef struct place {
  int level;
  float nearer;
} place;

typedef struct point {
  int x, y;
} point;

/* What the layers are made of, in the size of the scene's picture. */
typedef struct workshop {
  const placido_image *image;
  const float *depth_D;
  size_t pixels;
  int colours;
  int threads;
  placido_levels levels;
  bool used[PLACIDO_LEVELS_MAX];
  place *places;   /* of every pixel */
  point *sources;  /* of every pixel: where a layer's light comes from, x -1: not found yet */
} workshop;

static void free_workshop(workshop *w) {
  placido_memory_free(w->places);
  placido_memory_free(w->sources);
}

static int open_workshop(workshop *w, const placido_view *view, double focus_D,
                         placido_error *err) {
  const placido_image *image = &view->scene->image;
  const double finest_D = finest_step_arcmin * arcmin_rad / (view->eye.pupil_mm * 1e-3);
  const double range_D = view->facts->nearest_D - view->facts->farthest_D;
  const int most = view->settings->layers < 2 ? 1 : view->settings->layers;
  const double step_D = fmax(finest_D, most > 1 ? range_D / (most - 1) : range_D);
  *w = (workshop){.image = image,
                  .depth_D = view->scene->depth_D,
                  .pixels = (size_t)image->width_px * (size_t)image->height_px,
                  .colours = image->planes < 3 ? 1 : 3,
                  .threads = view->threads};
  w->places = placido_memory_new(w->pixels, sizeof *w->places, err);
  w->sources = placido_memory_new(w->pixels, sizeof *w->sources, err);
  if (w->places == NULL || w->sources == NULL) {
    return PLACIDO_MEMORY;
  }
  placido_levels_choose(&w->levels, w->depth_D, w->pixels, focus_D, step_D,
                        most < PLACIDO_LEVELS_MAX ? most : PLACIDO_LEVELS_MAX);
  for (size_t i = 0; i < w->pixels; i++) {
    place *at = &w->places[i];
    at->level = placido_levels_find(&w->levels, (double)w->depth_D[i], &at->nearer);
    w->used[at->level] = true;
    w->used[at->level + (at->nearer > 0)] = true;
  }
  return PLACIDO_OK;
}

/* Of a pixel's light what a layer has. */
static float cover_of(const place *at, int level) {
  return level == at->level ? 1 - at->nearer : level == at->level + 1 ? at->nearer : 0;
}

/* Takes over a neighbour's source where that is nearer than the one so far. */
static void try_neighbour(point *sources, int width, int height, point at, int dx, int dy) {
  const point from = {at.x + dx, at.y + dy};
  if (from.x < 0 || from.x >= width || from.y < 0 || from.y >= height) {
    return;
  }
  point *own = &sources[(size_t)at.y * (size_t)width + (size_t)at.x];
  point other = sources[(size_t)from.y * (size_t)width + (size_t)from.x];
  if (other.x < 0) {
    return;
  }
  double ox = other.x - at.x, oy = other.y - at.y, sx = own->x - at.x, sy = own->y - at.y;
  if (own->x < 0 || ox * ox + oy * oy < sx * sx + sy * sy) {
    *own = other;
  }
}

/* The nearest pixel that shows, by distances handed on from neighbour to neighbour: P. E.
 * Danielsson, Comput. Graph. Image Process. 14 (1980) 227. Down the picture, then up. */
static void find_nearest(point *sources, int width, int height) {
  for (int way = 1; way >= -1; way -= 2) {
    for (int row = 0; row < height; row++) {
      const int y = way > 0 ? row : height - 1 - row;
      for (int x = 0; x < width; x++) {
        for (int dx = -1; dx <= 1; dx++) {
          try_neighbour(sources, width, height, (point){x, y}, dx, -way);
        }
        try_neighbour(sources, width, height, (point){x, y}, -1, 0);
      }
      for (int x = width - 1; x >= 0; x--) {
        try_neighbour(sources, width, height, (point){x, y}, 1, 0);
      }
    }
  }
}

/* Where the light of a layer is taken from: what shows when all that is nearer is gone. */
static void find_sources(workshop *w, int level) {
  const int width = w->image->width_px, height = w->image->height_px;
  bool hides = false;
  for (int y = 0, i = 0; y < height; y++) {
    for (int x = 0; x < width; x++, i++) {
      bool shows = w->places[i].level <= level;
      w->sources[i] = shows ? (point){x, y} : (point){-1, -1};
      hides = hides || !shows;
    }
  }
  if (hides) {
    find_nearest(w->sources, width, height);
  }
}

static int towards(int from, int to, int most) {
  return from + (int)lround((double)(to - from) / most);
}

/* Whether the distance jumps at the rim of what shows, where a hidden pixel's source lies: then
 * another thing hides it. A slanted surface that runs into nearer layers is the same one, and does
 * not go on behind itself. */
static bool hides_another(const workshop *w, point source, point hidden) {
  const double jump_D = 0.1; /* from pixel to pixel: less makes no difference in blur */
  const size_t width = (size_t)w->image->width_px;
  int dx = abs(hidden.x - source.x), dy = abs(hidden.y - source.y), most = dx > dy ? dx : dy;
  size_t rim = (size_t)source.y * width + (size_t)source.x;
  size_t next = (size_t)towards(source.y, hidden.y, most) * width +
                (size_t)towards(source.x, hidden.x, most);
  return (double)w->depth_D[next] - (double)w->depth_D[rim] > jump_D;
}

/* A layer's light (weighted) and cover in the size of the scene's picture. What is left by all
 * others is the farthest one's, so that goes on everywhere. */
static void paint(placido_image *light, placido_image *cover, const workshop *w, int level,
                  bool farthest) {
  const int width = w->image->width_px;
#pragma omp parallel for num_threads(w->threads)
  for (size_t i = 0; i < w->pixels; i++) {
    const point at = {(int)(i % (size_t)width), (int)(i / (size_t)width)}, source = w->sources[i];
    size_t from = (size_t)source.y * (size_t)width + (size_t)source.x;
    bool goes_on = from == i || hides_another(w, source, at);
    float share = farthest ? 1 : goes_on ? cover_of(&w->places[from], level) : 0;
    cover->data[i] = share;
    for (int plane = 0; plane < w->colours; plane++) {
      placido_image_plane(light, plane)[i] = share * placido_image_plane(w->image, plane)[from];
    }
  }
}

/* Brings `image`, of the size of the scene's picture, to that of the canvas. */
static int bring_to_canvas(placido_image *image, const placido_view *view, placido_error *err) {
  placido_scene part = *view->scene;
  placido_scene_canvas canvas;
  part.image = *image;
  part.depth_D = NULL;
  int status = placido_scene_canvas_new(&canvas, &part, view->settings->bucket_arcmin,
                                        view->bleed_px, view->threads, err);
  if (status == PLACIDO_OK && canvas.own.data != NULL) {
    placido_image_free(image);
    *image = canvas.own;
  }
  return status;
}

/* The next layer of the view. */
static int add_layer(placido_view *view, workshop *w, int level, double focus_D,
                     placido_error *err) {
  placido_layer *layer = &view->layers[view->layer_count];
  placido_image cover = {0};
  int status = placido_image_new(&layer->light, w->image->width_px, w->image->height_px,
                                 w->colours, err);
  layer->defocus_D = focus_D - w->levels.vergence_D[level];
  view->layer_count++;
  if (status == PLACIDO_OK) {
    status = placido_image_new(&cover, w->image->width_px, w->image->height_px, 1, err);
  }
  if (status == PLACIDO_OK) {
    find_sources(w, level);
    paint(&layer->light, &cover, w, level, view->layer_count == 1);
    status = bring_to_canvas(&layer->light, view, err);
  }
  if (status == PLACIDO_OK && view->layer_count > 1) {
    status = bring_to_canvas(&cover, view, err);
    layer->cover = cover.data;
    return status;
  }
  placido_image_free(&cover);
  return status;
}

/* Everything at one distance. */
static int add_canvas(placido_view *view, double defocus_D, placido_error *err) {
  placido_image *light = &view->layers[0].light;
  const placido_image *canvas = &view->canvas;
  view->layers[0].defocus_D = defocus_D;
  view->layer_count = 1;
  int colours = canvas->planes < 3 ? 1 : 3;
  int status = placido_image_new(light, canvas->width_px, canvas->height_px, colours, err);
  if (status == PLACIDO_OK) {
    memcpy(light->data, canvas->data, (size_t)canvas->width_px * (size_t)canvas->height_px *
                                        (size_t)colours * sizeof *light->data);
  }
  return status;
}

static int make_room(placido_view *view, int count, placido_error *err) {
  view->layers = placido_memory_new((size_t)count, sizeof *view->layers, err);
  return view->layers != NULL ? PLACIDO_OK : PLACIDO_MEMORY;
}

static int cut(placido_view *view, double focus_D, placido_error *err) {
  workshop w;
  int status = open_workshop(&w, view, focus_D, err);
  if (status == PLACIDO_OK) {
    status = make_room(view, w.levels.count, err);
  }
  for (int level = 0; status == PLACIDO_OK && level < w.levels.count; level++) {
    if (w.used[level]) {
      status = add_layer(view, &w, level, focus_D, err);
    }
  }
  free_workshop(&w);
  return status;
}

int placido_layers_fill(placido_view *view, double focus_D, placido_error *err) {
  double nearest_D = view->facts->nearest_D, farthest_D = view->facts->farthest_D;
  if (nearest_D > farthest_D) {
    return cut(view, focus_D, err);
  }
  if (nearest_D == focus_D) {
    return PLACIDO_OK;
  }
  int status = make_room(view, 1, err);
  return status == PLACIDO_OK ? add_canvas(view, focus_D - nearest_D, err) : status;
}
