/* A simulated USB Video Class camera.
 *
 * UVC 1.1 with one bulk streaming endpoint, no alternate settings. Formats: Y800 (the kernel's
 * GREY) and YUY2 (Y is the sample, 0 to 255, so that nothing is lost; chroma is neutral). Sizes:
 * the view's own (an odd last column is cut off), half of it (2×2 pixels averaged), and 640×480
 * (cut out of the middle, one to one) where the view is larger. Rates: the view's and 60, 30, 20,
 * 15, 10, 5 Hz, as far as the bus carries them. Views of 9 to 16 bits are shown by their upper
 * eight.
 *
 * Controls: exposure time (the view is taken at 10 ms), gain (16 is one), brightness (grey levels
 * added), and the auto exposure mode, of which there is one: manual. As delivered they are such
 * that the view arrives bit by bit.
 *
 * Faults: those of pictures; UVC has no words for those of commands (pending, silent, refuse,
 * garble). A picture has one fault: the first, in the enum's order, that is still to come. A
 * dropped picture is a header without pixels, so that the host counts it. */
#ifndef PLACIDO_GADGET_UVC_H
#define PLACIDO_GADGET_UVC_H

#include "gadget/face.h"

#define PLACIDO_UVC_STREAM_ENDPOINT 0x81
#define PLACIDO_UVC_SIDE_MIN_PX 16
#define PLACIDO_UVC_SIDE_MAX_PX 8192

/* Opens with a view within these sides, of 0.1 to 1000 Hz, and a serial number of 1 to 63
 * characters; else PLACIDO_INPUT. */
extern const placido_gadget_face placido_uvc_face;

#endif
