/* What a person may set about a recording. */
#ifndef PLACIDO_CLI_TAKE_SETTINGS_H
#define PLACIDO_CLI_TAKE_SETTINGS_H

#include <placido/session.h>
#include <stdbool.h>

struct take_settings {
  const char *subject, *pedal, *light;
  bool codec_given;
  enum placido_session_codec codec;
  unsigned triggers;   /* PLACIDO_TRIGGER_... */
  int frames;          /* 0: no end */
  int burst, bursts;   /* 0: the default; no end */
  int queue_mb;        /* 0: the default */
  bool guide;
};

#endif
