/* Light spread: every plane by the spreads of its light, and layers in depth behind each other, as
 * far as the blurred covers of nearer ones leave them open (B. A. Barsky, Vision-Realistic
 * Rendering, APGV 2004). */
#include "simulate/plan/run.h"

#include "base/memory.h"
#include "simulate/depth/overlay.h"
#include "simulate/plan/bank.h"
#include "simulate/plan/mosaic.h"

#include <math.h>
#include <string.h>

enum { COLOURS = 3, PLANES_MAX = COLOURS + PLACIDO_VIEW_LIGHTS + 1 };

/* A plane, the light that it is spread by, and what becomes of it. */
typedef struct plane {
  const float *source;
  float *target;
  int light;
} plane;

/* What is spread together: a layer's colours and cover. */
typedef struct stack {
  int count;
  plane planes[PLANES_MAX];
  double defocus_D;
  bool focused; /* nearest to the focus: its spread is kept */
} stack;

/* The spread of a light at a node. */
typedef struct print {
  placido_psf psf;
  placido_transfer *transfer;
  int status;
  placido_error note;
} print;

/* Lights are spread by groups: all at once where there is one node, else one by one. */
typedef struct spreading {
  placido_view *view;
  placido_bank bank;
  placido_mosaic mosaic; /* made when the first spreads show how far they reach */
  placido_overlay overlay; /* of several layers */
  int group;
  int count;             /* of a group's prints: a light's nodes, then the next one's */
  print *prints;
  placido_transfer **transfers;
} spreading;

static int light_of(const placido_view *view, int index) {
  return index < view->light_count ? index : 0;
}

static int least(int a, int b) { return a < b ? a : b; }

static void clear_prints(spreading *s) {
  for (int i = 0; i < s->count; i++) {
    placido_psf_free(&s->prints[i].psf);
    placido_transfer_free(s->prints[i].transfer);
    s->prints[i] = (print){.transfer = NULL};
  }
}

/* The first print's message of those that failed. */
static int first_failure(const spreading *s, int count, placido_error *err) {
  for (int i = 0; i < count; i++) {
    if (s->prints[i].status != PLACIDO_OK) {
      return placido_error_set(err, s->prints[i].status, "%s", s->prints[i].note.text);
    }
  }
  return PLACIDO_OK;
}

/* Spreads of `lights` lights from number `first` on, at every node. */
static int make_psfs(spreading *s, int first, int lights, double defocus_D, placido_error *err) {
  const int count = lights * s->bank.count, outer = least(count, s->view->threads);
  const int inner = outer > 1 ? 1 : s->view->threads;
#pragma omp parallel for num_threads(outer) schedule(dynamic, 1) if (outer > 1)
  for (int i = 0; i < count; i++) {
    print *p = &s->prints[i];
    p->status = placido_bank_psf(&p->psf, &s->bank, s->view, i % s->bank.count,
                                 first + i / s->bank.count, defocus_D, inner, &p->note);
  }
  return first_failure(s, count, err);
}

/* Plans transforms that are wide enough for the spreads. */
static int plan(spreading *s, int count, placido_error *err) {
  int reach = 0;
  for (int i = 0; i < count; i++) {
    int found = placido_psf_reach(&s->prints[i].psf);
    reach = found > reach ? found : reach;
  }
  if (s->mosaic.convolver != NULL && s->mosaic.reach >= reach) {
    return PLACIDO_OK;
  }
  placido_mosaic_free(&s->mosaic);
  return placido_mosaic_new(&s->mosaic, s->view, reach, err);
}

static int make_transfers(spreading *s, int count, placido_error *err) {
#pragma omp parallel for num_threads(least(count, s->view->threads)) if (count > 1)
  for (int i = 0; i < count; i++) {
    print *p = &s->prints[i];
    p->status = placido_transfer_new(&p->transfer, s->mosaic.convolver, &p->psf, &p->note);
    s->transfers[i] = p->transfer;
  }
  return first_failure(s, count, err);
}

/* Keeps the spread in the middle, of the first light and of what is nearest to the focus. */
static void keep_psf(spreading *s) {
  const int middle = s->bank.count / 2;
  s->view->psf = s->prints[middle].psf;
  s->prints[middle].psf = (placido_psf){0};
  placido_bank_describe(&s->view->psf, &s->bank, s->view, middle, 0);
}

/* The planes of these lights. */
static int spread_group(spreading *s, const stack *what, int first, int lights,
                        placido_error *err) {
  const int count = lights * s->bank.count;
  placido_sheet sheets[PLANES_MAX];
  int sheet_count = 0;
  for (int i = 0; i < what->count; i++) {
    const plane *p = &what->planes[i];
    if (p->light >= first && p->light < first + lights) {
      sheets[sheet_count++] = (placido_sheet){
        p->source, p->target, s->transfers + (p->light - first) * s->bank.count};
    }
  }
  int status = make_psfs(s, first, lights, what->defocus_D, err);
  if (status == PLACIDO_OK) {
    status = plan(s, count, err);
  }
  if (status == PLACIDO_OK) {
    status = make_transfers(s, count, err);
  }
  if (status == PLACIDO_OK && what->focused && first == 0) {
    keep_psf(s);
  }
  if (status == PLACIDO_OK) {
    status = placido_mosaic_run(&s->mosaic, sheets, sheet_count, err);
  }
  clear_prints(s);
  return status;
}

/* Every plane of the stack; their targets are dark before. */
static int spread_stack(spreading *s, const stack *what, placido_error *err) {
  int status = PLACIDO_OK;
  for (int first = 0; first < s->view->light_count && status == PLACIDO_OK; first += s->group) {
    int lights = least(s->group, s->view->light_count - first);
    status = spread_group(s, what, first, lights, err);
  }
  return status;
}

static void add_plane(stack *what, const float *source, float *target, int light) {
  what->planes[what->count++] = (plane){source, target, light};
}

static void add_colours(stack *what, const placido_view *view, const placido_image *source,
                        const placido_image *target) {
  int colours = least(source->planes, COLOURS);
  for (int i = 0; i < colours; i++) {
    add_plane(what, placido_image_plane(source, i), placido_image_plane(target, i),
              light_of(view, i));
  }
}

/* Alpha: spread with its colours where there are holes, else it stays. */
static void add_alpha(stack *what, placido_view *view) {
  if (view->canvas.planes != COLOURS + 1) {
    return;
  }
  const float *source = placido_image_plane(&view->canvas, COLOURS);
  float *target = placido_image_plane(&view->seen, COLOURS);
  if (view->holes) {
    add_plane(what, source, target, 0);
  } else {
    memcpy(target, source,
           (size_t)view->canvas.width_px * (size_t)view->canvas.height_px * sizeof *target);
  }
}

/* A layer of several: spread apart, with its cover, and laid behind those before it. */
static int spread_behind(spreading *s, const placido_layer *layer, stack *what,
                         placido_error *err) {
  const placido_image *canvas = &s->view->canvas;
  placido_image light = {0}, covers = {0};
  int status = placido_image_new(&light, canvas->width_px, canvas->height_px, layer->light.planes,
                                 err);
  if (status == PLACIDO_OK && layer->cover != NULL) {
    status = placido_image_new(&covers, canvas->width_px, canvas->height_px,
                               s->view->light_count, err);
  }
  if (status == PLACIDO_OK) {
    add_colours(what, s->view, &layer->light, &light);
    for (int i = 0; i < covers.planes; i++) {
      add_plane(what, layer->cover, placido_image_plane(&covers, i), i);
    }
    status = spread_stack(s, what, err);
  }
  if (status == PLACIDO_OK) {
    placido_overlay_add(&s->overlay, &s->view->seen, &light, &covers);
  }
  placido_image_free(&covers);
  placido_image_free(&light);
  return status;
}

static int spread_layer(spreading *s, const placido_layer *layer, bool focused,
                        placido_error *err) {
  stack what = {.defocus_D = layer->defocus_D, .focused = focused};
  if (focused) {
    add_alpha(&what, s->view);
  }
  if (s->view->layer_count > 1) {
    return spread_behind(s, layer, &what, err);
  }
  add_colours(&what, s->view, &layer->light, &s->view->seen);
  return spread_stack(s, &what, err);
}

/* The layer nearest to the focus. */
static int focused_layer(const placido_view *view) {
  int found = 0;
  for (int i = 1; i < view->layer_count; i++) {
    if (fabs(view->layers[i].defocus_D) < fabs(view->layers[found].defocus_D)) {
      found = i;
    }
  }
  return found;
}

static int spread_all(spreading *s, placido_error *err) {
  placido_view *view = s->view;
  const int focused = focused_layer(view);
  int status = PLACIDO_OK;
  if (view->layer_count == 0) {
    stack what = {.focused = true};
    add_colours(&what, view, &view->canvas, &view->seen);
    add_alpha(&what, view);
    return spread_stack(s, &what, err);
  }
  if (view->layer_count > 1) {
    status = placido_overlay_new(&s->overlay, &view->canvas, view->light_count, view->core, err);
  }
  for (int i = view->layer_count - 1; i >= 0 && status == PLACIDO_OK; i--) { /* near to far */
    status = spread_layer(s, &view->layers[i], i == focused, err);
  }
  return status;
}

static int spreading_new(spreading *s, placido_view *view, placido_error *err) {
  const int nodes = view->nodes * view->nodes;
  *s = (spreading){.view = view, .group = nodes == 1 ? view->light_count : 1};
  s->count = nodes * s->group;
  s->prints = placido_memory_new((size_t)s->count, sizeof *s->prints, err);
  s->transfers = placido_memory_new((size_t)s->count, sizeof *s->transfers, err);
  if (s->prints == NULL || s->transfers == NULL) {
    return PLACIDO_MEMORY;
  }
  return placido_bank_new(&s->bank, view, err);
}

static void spreading_free(spreading *s) {
  placido_memory_free(s->prints);
  placido_memory_free(s->transfers);
  placido_overlay_free(&s->overlay);
  placido_mosaic_free(&s->mosaic);
  placido_bank_free(&s->bank);
}

int placido_view_spread(placido_view *view, placido_error *err) {
  const placido_image *canvas = &view->canvas;
  spreading s;
  int status = spreading_new(&s, view, err);
  if (status == PLACIDO_OK) {
    status = placido_image_new(&view->seen, canvas->width_px, canvas->height_px, canvas->planes,
                               err);
  }
  if (status == PLACIDO_OK) {
    status = spread_all(&s, err);
  }
  spreading_free(&s);
  return status;
}
