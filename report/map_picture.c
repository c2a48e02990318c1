/* The round map: classes in colour with thin contours, what data do not support hatched, in a
 * frame with millimetres, meridians, circles and a legend. */
#include "report/map_picture.h"

#include "base/memory.h"
#include "report/field.h"

#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 900, HEIGHT = 760, LEFT = 84, TOP = 52, BOX = 610, LEGEND_LEFT = 728, FINE = 2 };
enum { UNSUPPORTED = INT_MIN };

static const double pi = 3.14159265358979323846;
static const double rim_room = 1.16; /* the box's side over the map's: room for the angles */
static const double text_px = 19, small_px = 16;
static const float significant = 2; /* error bars */

/* A map on its way to paper. */
typedef struct sheet {
  const placido_map_picture *picture;
  placido_canvas canvas;
  placido_map_field field;
  placido_map_field doubt; /* |value| / sigma; without values where that does not matter */
  int disc_px;   /* side of the field on the canvas */
  double x0, y0; /* the map's centre on the canvas */
  double px_per_mm, radius_mm, rim_mm;
} sheet;

static double to_x(const sheet *s, double x_mm) { return s->x0 + x_mm * s->px_per_mm; }
static double to_y(const sheet *s, double y_mm) { return s->y0 - y_mm * s->px_per_mm; }

/* The step that every sample of the field lies in; UNSUPPORTED where it has no value. */
static int find_steps(int **steps, const sheet *s, placido_error *err) {
  size_t count = (size_t)s->field.size * (size_t)s->field.size;
  *steps = placido_memory_new(count, sizeof **steps, err);
  if (*steps == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t k = 0; k < count; k++) {
    double value = s->field.values[k];
    (*steps)[k] = isfinite(value) ? placido_scale_step(&s->picture->scale, value) : UNSUPPORTED;
  }
  return PLACIDO_OK;
}

/* Whether a contour passes between a sample and one of its neighbours. */
static bool on_contour(const int *steps, int size, int i, int j) {
  const int *here = steps + (size_t)j * (size_t)size + (size_t)i;
  bool left = i > 0 && here[-1] != *here && here[-1] != UNSUPPORTED;
  bool right = i + 1 < size && here[1] != *here && here[1] != UNSUPPORTED;
  bool above = j > 0 && here[-size] != *here && here[-size] != UNSUPPORTED;
  bool below = j + 1 < size && here[size] != *here && here[size] != UNSUPPORTED;
  return left || right || above || below;
}

/* Contours are darker than light classes and lighter than dark ones. */
static placido_rgb contour_colour(placido_rgb ground) {
  double light = 0.3 * ground.r + 0.6 * ground.g + 0.1 * ground.b;
  double share = 0.45, ink = light > 0.4 ? 0 : 1;
  return (placido_rgb){ground.r + share * (ink - ground.r), ground.g + share * (ink - ground.g),
                       ground.b + share * (ink - ground.b)};
}

/* The colours of a scale's classes and of the contours that run through them. */
typedef struct inks {
  placido_rgb plain[PLACIDO_CLASSES_MAX], contour[PLACIDO_CLASSES_MAX];
  int classes;
} inks;

static inks mix_inks(const placido_scale *scale) {
  inks made = {.classes = scale->classes};
  for (int k = 0; k < scale->classes; k++) {
    made.plain[k] = placido_scale_colour(scale, k);
    made.contour[k] = contour_colour(made.plain[k]);
  }
  return made;
}

/* Whether a sample's value is less than twice its error bar. */
static bool is_doubtful(const placido_map_field *doubt, int i, int j) {
  return doubt->values[(size_t)j * (size_t)doubt->size + (size_t)i] < significant;
}

/* Hatches what is doubtful, and draws the line around it. */
static placido_rgb mark_doubt(placido_rgb colour, const placido_map_field *doubt, int i, int j) {
  bool here = is_doubtful(doubt, i, j);
  bool border = i > 0 && j > 0 &&
                (here != is_doubtful(doubt, i - 1, j) || here != is_doubtful(doubt, i, j - 1));
  if (border) {
    return (placido_rgb){0.1, 0.1, 0.1};
  }
  if (!here || (i + doubt->size - j) % (9 * FINE) >= FINE) {
    return colour;
  }
  return (placido_rgb){0.45 * colour.r, 0.45 * colour.g, 0.45 * colour.b};
}

/* The premultiplied ARGB of one pixel: the mean of its FINE × FINE samples. */
static uint32_t mix_pixel(const inks *colours, const int *steps, const placido_map_field *doubt,
                          int size, int x, int y) {
  double r = 0, g = 0, b = 0, a = 0;
  for (int k = 0; k < FINE * FINE; k++) {
    int i = x * FINE + k % FINE, j = y * FINE + k / FINE;
    int step = steps[(size_t)j * (size_t)size + (size_t)i];
    if (step == UNSUPPORTED) {
      continue;
    }
    int class_index = step < 0 ? 0 : step < colours->classes ? step : colours->classes - 1;
    placido_rgb colour =
        on_contour(steps, size, i, j) ? colours->contour[class_index] : colours->plain[class_index];
    if (doubt->values) {
      colour = mark_doubt(colour, doubt, i, j);
    }
    r += colour.r;
    g += colour.g;
    b += colour.b;
    a += 1;
  }
  double full = 255.0 / (FINE * FINE);
  return (uint32_t)(a * full + 0.5) << 24 | (uint32_t)(r * full + 0.5) << 16 |
         (uint32_t)(g * full + 0.5) << 8 | (uint32_t)(b * full + 0.5);
}

static void fill_pixels(cairo_surface_t *pixels, const sheet *s, const int *steps) {
  inks colours = mix_inks(&s->picture->scale);
  unsigned char *data = cairo_image_surface_get_data(pixels);
  int stride = cairo_image_surface_get_stride(pixels);
  for (int y = 0; y < s->disc_px; y++) {
    uint32_t *row = (uint32_t *)(void *)(data + (size_t)y * (size_t)stride);
    for (int x = 0; x < s->disc_px; x++) {
      row[x] = mix_pixel(&colours, steps, &s->doubt, s->field.size, x, y);
    }
  }
  cairo_surface_mark_dirty(pixels);
}

static void clip_to_rim(const sheet *s) {
  cairo_arc(s->canvas.cr, s->x0, s->y0, s->rim_mm * s->px_per_mm, 0, 2 * pi);
  cairo_clip(s->canvas.cr);
}

static int draw_classes(const sheet *s, placido_error *err) {
  cairo_surface_t *pixels;
  int *steps = NULL;
  int status = placido_canvas_picture(&pixels, s->disc_px, s->disc_px, err);
  if (status == PLACIDO_OK) {
    status = find_steps(&steps, s, err);
  }
  if (status == PLACIDO_OK) {
    fill_pixels(pixels, s, steps);
    cairo_t *cr = s->canvas.cr;
    cairo_save(cr);
    clip_to_rim(s);
    cairo_set_source_surface(cr, pixels, s->x0 - 0.5 * s->disc_px, s->y0 - 0.5 * s->disc_px);
    cairo_paint(cr);
    cairo_restore(cr);
  }
  placido_memory_free(steps);
  cairo_surface_destroy(pixels);
  return status;
}

static void hatch(const placido_canvas *canvas, double x0, double y0, double x1, double y1) {
  cairo_t *cr = canvas->cr;
  double height = y1 - y0;
  cairo_set_source_rgb(cr, 0.93, 0.93, 0.93);
  cairo_rectangle(cr, x0, y0, x1 - x0, height);
  cairo_fill(cr);
  cairo_save(cr);
  cairo_rectangle(cr, x0, y0, x1 - x0, height);
  cairo_clip(cr);
  cairo_set_source_rgb(cr, 0.55, 0.55, 0.55);
  cairo_set_line_width(cr, 1.2);
  for (double x = x0 - height; x < x1; x += 9) {
    cairo_move_to(cr, x, y1);
    cairo_line_to(cr, x + height, y0);
  }
  cairo_stroke(cr); /* all at once: a clip costs its price for every stroke */
  cairo_restore(cr);
}

static void draw_unsupported(const sheet *s) {
  double r = s->rim_mm * s->px_per_mm;
  cairo_save(s->canvas.cr);
  clip_to_rim(s);
  hatch(&s->canvas, s->x0 - r, s->y0 - r, s->x0 + r, s->y0 + r);
  cairo_restore(s->canvas.cr);
}

/* The field's value at a place within the rim. */
static double value_at(const sheet *s, double x_mm, double y_mm) {
  double half = 0.5 * s->field.size, per_mm = half / s->radius_mm;
  int i = (int)(half + x_mm * per_mm), j = (int)(half - y_mm * per_mm);
  return s->field.values[(size_t)j * (size_t)s->field.size + (size_t)i];
}

/* Writes the values of the contours that a semi-meridian crosses, as densely as can be read. */
static void label_meridian(const sheet *s, double meridian_deg) {
  const placido_scale *scale = &s->picture->scale;
  double c = cos(meridian_deg * pi / 180), d = sin(meridian_deg * pi / 180);
  double room_mm = 2.6 * small_px / s->px_per_mm, last_mm = 0;
  int before = 0;
  bool known = false;
  for (double r = 0.4; r < s->rim_mm - 0.45; r += 0.5 / s->px_per_mm) {
    double value = value_at(s, r * c, r * d);
    if (!isfinite(value)) {
      known = false;
      continue;
    }
    int step = placido_scale_step(scale, value);
    if (known && step != before && r - last_mm >= room_mm) {
      char text[32];
      placido_scale_write(text, sizeof text, scale, step > before ? step : before);
      cairo_set_source_rgb(s->canvas.cr, 0, 0, 0);
      placido_canvas_text(&s->canvas, to_x(s, r * c), to_y(s, r * d), small_px, PLACIDO_CENTRE,
                          true, text);
      last_mm = r;
    }
    before = step;
    known = true;
  }
}

/* Where the map is not defined, it has no colour. */
static void draw_hole(const sheet *s) {
  cairo_t *cr = s->canvas.cr;
  if (s->picture->hole_mm > 0) {
    cairo_arc(cr, s->x0, s->y0, s->picture->hole_mm * s->px_per_mm, 0, 2 * pi);
    cairo_set_source_rgb(cr, 0.82, 0.82, 0.82);
    cairo_fill_preserve(cr);
    cairo_set_source_rgb(cr, 0.3, 0.3, 0.3);
    cairo_set_line_width(cr, 1);
    cairo_stroke(cr);
  }
}

static void draw_circles(const sheet *s) {
  cairo_t *cr = s->canvas.cr;
  const double dashes[] = {5, 4};
  cairo_save(cr);
  cairo_set_line_width(cr, 1);
  for (int diameter = 3; diameter <= 9 && 0.5 * diameter < s->rim_mm - 0.1; diameter += 2) {
    double r = 0.5 * diameter * s->px_per_mm;
    cairo_set_dash(cr, dashes, 2, 0);
    cairo_arc(cr, s->x0, s->y0, r, 0, 2 * pi);
    cairo_set_source_rgb(cr, 0.25, 0.25, 0.25);
    cairo_stroke(cr);
    char text[32];
    snprintf(text, sizeof text, "%d mm", diameter);
    /* where no contour has its label */
    double angle = 255 * pi / 180;
    placido_canvas_text(&s->canvas, s->x0 + r * cos(angle), s->y0 - r * sin(angle), small_px,
                        PLACIDO_CENTRE, true, text);
  }
  cairo_set_dash(cr, NULL, 0, 0);
  cairo_set_source_rgb(cr, 0, 0, 0);
  placido_canvas_line(&s->canvas, s->x0 - 7, s->y0, s->x0 + 7, s->y0);
  placido_canvas_line(&s->canvas, s->x0, s->y0 - 7, s->x0, s->y0 + 7);
  cairo_restore(cr);
}

static void draw_rim(const sheet *s) {
  cairo_t *cr = s->canvas.cr;
  double r = s->rim_mm * s->px_per_mm;
  cairo_set_source_rgb(cr, 0.2, 0.2, 0.2);
  cairo_set_line_width(cr, 1.5);
  cairo_arc(cr, s->x0, s->y0, r, 0, 2 * pi);
  cairo_stroke(cr);
  for (int degrees = 0; degrees < 360; degrees += 30) {
    double c = cos(degrees * pi / 180), d = sin(degrees * pi / 180);
    placido_canvas_line(&s->canvas, s->x0 + (r - 7) * c, s->y0 - (r - 7) * d, s->x0 + r * c,
                        s->y0 - r * d);
    placido_canvas_print(&s->canvas, s->x0 + (r + 17) * c, s->y0 - (r + 14) * d, small_px,
                         PLACIDO_CENTRE, "%d°", degrees);
  }
}

static void draw_box(const sheet *s) {
  cairo_t *cr = s->canvas.cr;
  cairo_set_source_rgb(cr, 0, 0, 0);
  cairo_set_line_width(cr, 1.2);
  cairo_rectangle(cr, LEFT, TOP, BOX, BOX);
  cairo_stroke(cr);
  for (int mm = -(int)s->radius_mm; mm <= (int)s->radius_mm; mm++) {
    double x = to_x(s, mm), y = to_y(s, mm);
    placido_canvas_line(&s->canvas, x, TOP + BOX, x, TOP + BOX + 6);
    placido_canvas_line(&s->canvas, LEFT - 6, y, LEFT, y);
    const char *sign = mm < 0 ? "−" : "";
    placido_canvas_print(&s->canvas, x, TOP + BOX + 19, text_px, PLACIDO_CENTRE, "%s%d", sign,
                         abs(mm));
    placido_canvas_print(&s->canvas, LEFT - 11, y, text_px, PLACIDO_RIGHT, "%s%d", sign, abs(mm));
  }
  placido_canvas_text(&s->canvas, LEFT + 0.5 * BOX, TOP + BOX + 43, text_px, PLACIDO_CENTRE, false,
                      "x, mm");
  cairo_save(cr);
  cairo_translate(cr, 22, TOP + 0.5 * BOX);
  cairo_rotate(cr, -pi / 2);
  placido_canvas_text(&s->canvas, 0, 0, text_px, PLACIDO_CENTRE, false, "y, mm");
  cairo_restore(cr);
  cairo_set_line_width(cr, 2.5);
  placido_canvas_scale_bar(&s->canvas, LEFT + 14, TOP + BOX - 16, s->px_per_mm, small_px, "1 mm");
}

/* Hatched as what is doubtful is, across what has no data. */
static void hatch_doubt(const placido_canvas *canvas, double x, double y, double width,
                        double height) {
  cairo_t *cr = canvas->cr;
  cairo_save(cr);
  cairo_rectangle(cr, x, y, width, height);
  cairo_set_source_rgb(cr, 0.1, 0.1, 0.1);
  cairo_set_line_width(cr, 1);
  cairo_stroke_preserve(cr);
  cairo_clip(cr);
  cairo_set_source_rgb(cr, 0.45, 0.45, 0.45);
  for (double from = x - height; from < x + width; from += 9) {
    cairo_move_to(cr, from, y);
    cairo_line_to(cr, from + height, y + height);
  }
  cairo_stroke(cr);
  cairo_restore(cr);
}

/* What is no class: no data, less than two error bars, not defined. */
static void draw_marks(const sheet *s, double top) {
  const double width_px = 46, height_px = 25, gap_px = 9;
  const char *texts[3] = {"no data", "under 2 σ", "undefined"};
  const bool wanted[3] = {true, s->picture->sigmas != NULL, s->picture->hole_mm > 0};
  for (int k = 0; k < 3; k++) {
    if (!wanted[k]) {
      continue;
    }
    if (k == 0) {
      hatch(&s->canvas, LEGEND_LEFT, top, LEGEND_LEFT + width_px, top + height_px);
    } else if (k == 1) {
      hatch_doubt(&s->canvas, LEGEND_LEFT, top, width_px, height_px);
    } else {
      cairo_rectangle(s->canvas.cr, LEGEND_LEFT, top, width_px, height_px);
      cairo_set_source_rgb(s->canvas.cr, 0.82, 0.82, 0.82);
      cairo_fill(s->canvas.cr);
    }
    cairo_set_source_rgb(s->canvas.cr, 0, 0, 0);
    placido_canvas_text(&s->canvas, LEGEND_LEFT + width_px + 10, top + height_px / 2, small_px,
                        PLACIDO_LEFT, false, texts[k]);
    top += height_px + gap_px;
  }
}

/* One swatch a class with the bounds between, the highest on top. */
static void draw_legend(const sheet *s) {
  const placido_scale *scale = &s->picture->scale;
  const double swatch_px = 27, width_px = 46, bottom = TOP + BOX - 46;
  cairo_t *cr = s->canvas.cr;
  cairo_set_line_width(cr, 1);
  for (int k = 0; k < scale->classes; k++) {
    double y = bottom - (k + 1) * swatch_px;
    placido_canvas_ink(&s->canvas, placido_scale_colour(scale, k));
    cairo_rectangle(cr, LEGEND_LEFT, y, width_px, swatch_px);
    cairo_fill_preserve(cr);
    cairo_set_source_rgb(cr, 0.35, 0.35, 0.35);
    cairo_stroke(cr);
    cairo_set_source_rgb(cr, 0, 0, 0);
    if (k > 0) {
      char text[32];
      placido_scale_write(text, sizeof text, scale, k);
      placido_canvas_text(&s->canvas, LEGEND_LEFT + width_px + 10, y + swatch_px, 18, PLACIDO_LEFT,
                          false, text);
    }
  }
  placido_canvas_text(&s->canvas, LEGEND_LEFT, bottom - scale->classes * swatch_px - 18, text_px,
                      PLACIDO_LEFT, false, s->picture->unit);
  draw_marks(s, bottom + 20);
}

static int draw(sheet *s, placido_error *err) {
  draw_unsupported(s);
  int status = draw_classes(s, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  draw_hole(s);
  draw_circles(s);
  for (int k = 0; k < 4; k++) {
    label_meridian(s, 15 + 90 * k);
  }
  draw_rim(s);
  draw_box(s);
  draw_legend(s);
  placido_canvas_text(&s->canvas, LEFT, 26, 26, PLACIDO_LEFT, false, s->picture->title);
  bool two = s->picture->second_note != NULL;
  placido_canvas_text(&s->canvas, LEFT, HEIGHT - (two ? 33 : 20), small_px, PLACIDO_LEFT, false,
                      s->picture->note);
  if (two) {
    placido_canvas_text(&s->canvas, LEFT, HEIGHT - 12, small_px, PLACIDO_LEFT, false,
                        s->picture->second_note);
  }
  return PLACIDO_OK;
}

/* Values and, where they are asked for, what they are worth. */
static int find_fields(sheet *s, placido_error *err) {
  const placido_map_picture *picture = s->picture;
  const placido_maps *maps = picture->maps;
  int size = FINE * s->disc_px, status;
  status = placido_map_field_new(&s->field, maps, picture->values, size, err);
  if (status != PLACIDO_OK || picture->sigmas == NULL) {
    return status;
  }
  size_t count = (size_t)maps->size * (size_t)maps->size;
  double *ratios = placido_memory_new(count, sizeof *ratios, err);
  if (ratios == NULL) {
    return PLACIDO_MEMORY;
  }
  for (size_t k = 0; k < count; k++) {
    ratios[k] = fabs(picture->values[k]) / picture->sigmas[k];
  }
  status = placido_map_field_new(&s->doubt, maps, ratios, size, err);
  placido_memory_free(ratios);
  return status;
}

int placido_map_picture_write(const placido_map_picture *picture, const char *path,
                              placido_error *err) {
  const placido_maps *maps = picture->maps;
  sheet s = {.picture = picture, .x0 = LEFT + 0.5 * BOX, .y0 = TOP + 0.5 * BOX};
  s.radius_mm = maps->half * maps->step_mm;
  /* Half a step inside, so that the grid's stairs do not show at the rim. */
  s.rim_mm = fmin(s.radius_mm, maps->radius_mm) - 0.5 * maps->step_mm;
  s.disc_px = (int)lround(BOX / rim_room);
  s.px_per_mm = 0.5 * s.disc_px / s.radius_mm;
  int status = placido_canvas_new(&s.canvas, WIDTH, HEIGHT, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  status = find_fields(&s, err);
  if (status == PLACIDO_OK) {
    status = draw(&s, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_canvas_save(&s.canvas, path, err);
  }
  placido_map_field_free(&s.field);
  placido_map_field_free(&s.doubt);
  placido_canvas_free(&s.canvas);
  return status;
}
