/* A part of a camera frame as pixels that cairo can draw. */
#ifndef PLACIDO_REPORT_FRAME_PICTURE_H
#define PLACIDO_REPORT_FRAME_PICTURE_H

#include "report/canvas.h"

#include <placido/frame.h>

/* A rectangle of whole pixels. */
typedef struct placido_crop {
  int left, top, width, height;
} placido_crop;

/* The crop, which must lie within the frame, as width_px × height_px opaque pixels: each the
 * mean over the area that it covers. `grey` turns colour into luma. Destroy with
 * cairo_surface_destroy. PLACIDO_OK, PLACIDO_MEMORY. */
int placido_frame_picture(cairo_surface_t **picture, const placido_frame *frame,
                          const placido_crop *crop, int width_px, int height_px, bool grey,
                          placido_error *err);

/* PLACIDO_INPUT where the frame holds no picture. */
int placido_frame_check(const placido_frame *frame, placido_error *err);

#endif
