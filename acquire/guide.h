/* What a person at the instrument needs to know of the frame just taken: is the eye there, where,
 * how sharp, what to do. Cheap enough for every frame. */
#ifndef PLACIDO_ACQUIRE_GUIDE_H
#define PLACIDO_ACQUIRE_GUIDE_H

#include <placido/frame.h>
#include <placido/instrument.h>
#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum placido_guide_state {
  PLACIDO_GUIDE_NO_EYE,
  PLACIDO_GUIDE_BLINK,  /* an eye was there a moment ago, and lids hide it now */
  PLACIDO_GUIDE_ALIGN,  /* seen, but off centre, out of focus, moving, too bright or hidden */
  PLACIDO_GUIDE_READY,  /* worth measuring */
};

/* NaN where it cannot be told.
 *
 * Directions. x_mm and y_mm say where the eye is. An instruction says which way the instrument has
 * to be moved, as a person behind it sees its picture and the patient: "right" is towards the
 * picture's right side, "up" towards its upper one, "closer" towards the eye. The patient would
 * have to move the opposite way. */
typedef struct placido_guidance {
  enum placido_guide_state state;
  double x_mm, y_mm;      /* of the eye against the instrument's axis, from the innermost mires'
                           * centre: moving the instrument by (x, y) centres them; +x right, +y up
                           * in the image */
  double focus_mm;        /* how far the cornea is behind (+, farther from the camera) or before its
                           * nominal place, where the instrument's mires stand at so different
                           * heights that their sizes together show it beside the cornea's radius
                           * and asphericity; NaN where only the amount of blur can be told */
  double blur_px;         /* standard deviation of the innermost mires' blur, less the pixel's
                           * width */
  double motion_px;       /* length of the motion blur, or the shift since the last frame if that is
                           * all that can be told */
  double coverage;        /* share of the disc on which mires are expected, about their centre,
                           * where they are seen, 0..1; beyond the picture none are */
  double clipped;         /* share of that disc's samples in the picture at the ends of the range */
  double break_up;        /* share of the covered mires that waver as a broken tear film does */
  double score;           /* 0..1, comparable between frames of one instrument; 0 without an eye */
  char instruction[64];   /* "left 0.3 mm", "closer", "blink, then hold", "hold" */
  double u_px, v_px;      /* the mires' centre in the image */
} placido_guidance;

/* Where a mire's edge was seen, to be drawn. */
typedef struct placido_guide_point {
  float u_px, v_px;
} placido_guide_point;

typedef struct placido_guide placido_guide;

/* Prepares for an instrument (copied). Free with placido_guide_free. Returns PLACIDO_OK,
 * PLACIDO_INPUT (an ordinary cornea shows too few of its mires, or too fine ones), PLACIDO_MEMORY.
 */
int placido_guide_new(placido_guide **guide, const placido_instrument *instrument,
                      placido_error *err);
void placido_guide_free(placido_guide *guide);

/* Judges one frame of the instrument's size; of a colour frame the plane with the strongest fine
 * contrast. The guide remembers the frames before: blink and motion need them, by the frames' own
 * time where they have one, else as if they came 30 times a second. One thread; no allocation.
 * Returns PLACIDO_OK, PLACIDO_INPUT (frame of another size). */
int placido_guide_look(placido_guide *guide, const placido_frame *frame,
                       placido_guidance *guidance, placido_error *err);

/* The mires' edges seen in the last frame, `*count` points; borrowed until the next look. */
const placido_guide_point *placido_guide_points(const placido_guide *guide, size_t *count);

#endif
