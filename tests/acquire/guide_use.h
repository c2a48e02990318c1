/* Frames of the phantom, and what the guide says of them. */
#ifndef PLACIDO_TEST_GUIDE_USE_H
#define PLACIDO_TEST_GUIDE_USE_H

#include "acquire/guide.h"

#include <placido/phantom.h>

/* An eye before an instrument with a guide. */
struct guide_use {
  placido_instrument instrument;
  placido_surface *surface;
  placido_guide *guide;
  placido_frame frame;
};

/* `instrument`: one of the phantom's, or "half cone24" with half of the pixels along each side. */
void guide_use_open(struct guide_use *use, const char *instrument, const char *eye);
void guide_use_close(struct guide_use *use);
void guide_use_render(struct guide_use *use, placido_disturbance how);
placido_guidance guide_use_look(struct guide_use *use);
/* Both. */
placido_guidance guide_use_see(struct guide_use *use, placido_disturbance how);
/* With a guide that has seen nothing before. */
placido_guidance guide_use_once(const char *instrument, const char *eye, placido_disturbance how);

#endif
