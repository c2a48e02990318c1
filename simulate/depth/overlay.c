/* Layers behind each other: a pixel is shared out from near to far until it is full. */
#include "simulate/depth/overlay.h"

int placido_overlay_new(placido_overlay *overlay, const placido_image *canvas, int lights,
                        double core, placido_error *err) {
  overlay->core = (float)core;
  int status = placido_image_new(&overlay->open, canvas->width_px, canvas->height_px, lights, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  size_t samples = (size_t)canvas->width_px * (size_t)canvas->height_px * (size_t)lights;
  for (size_t i = 0; i < samples; i++) {
    overlay->open.data[i] = 1;
  }
  return PLACIDO_OK;
}

void placido_overlay_free(placido_overlay *overlay) {
  if (overlay != NULL) {
    placido_image_free(&overlay->open);
  }
}

/* By how much a light is taken that covers more than is open. */
static float share_of(float cover, float open) {
  return cover <= open ? 1 : open / cover;
}

static void add_plane(float *seen, const float *light, const float *cover, const float *open,
                      float core, size_t area) {
  for (size_t i = 0; i < area; i++) {
    seen[i] += light[i] * (cover != NULL ? share_of(cover[i] / core, open[i]) : open[i]);
  }
}

static void fill(float *open, const float *cover, float core, size_t area) {
  for (size_t i = 0; i < area; i++) {
    float left = open[i] - cover[i] / core;
    open[i] = left > 0 ? left : 0;
  }
}

void placido_overlay_add(placido_overlay *overlay, placido_image *seen, const placido_image *light,
                         const placido_image *covers) {
  const placido_image *open = &overlay->open;
  size_t area = (size_t)light->width_px * (size_t)light->height_px;
  for (int plane = 0; plane < light->planes; plane++) {
    int by = plane < open->planes ? plane : 0;
    const float *cover = covers->data != NULL ? placido_image_plane(covers, by) : NULL;
    add_plane(placido_image_plane(seen, plane), placido_image_plane(light, plane), cover,
              placido_image_plane(open, by), overlay->core, area);
  }
  for (int by = 0; by < covers->planes; by++) {
    fill(placido_image_plane(open, by), placido_image_plane(covers, by), overlay->core, area);
  }
}
