/* What a simulated camera looks at: an eye of the phantom that moves and blinks, or a session that
 * is played again and again. */
#ifndef PLACIDO_CLI_SIM_VIEW_H
#define PLACIDO_CLI_SIM_VIEW_H

#include "acquire/cli/command.h"
#include "gadget/picture.h"

#include <placido/session.h>

/* Zero before opened. */
struct sim_view {
  placido_gadget_view view; /* for the camera; borrowed until closed */
  placido_frame *frames;    /* of the eye: `awake` while it moves, then `blinking` */
  size_t count, awake, blinking;
  placido_session_reader *reader; /* of a session that is too large for memory */
  placido_frame current;          /* its last picture */
  int64_t period_ns, started_ns, shown;
};

/* Renders or decodes the pictures. Returns PLACIDO_OK, STATUS_USAGE (a session and an eye), or what
 * the libraries do. */
int sim_view_open(struct sim_view *view, const struct settings *settings, struct outcome *outcome,
                  placido_error *err);
void sim_view_close(struct sim_view *view);

#endif
