/* What a person may set about maps and their comparison. */
#ifndef PLACIDO_CLI_MAP_SETTINGS_H
#define PLACIDO_CLI_MAP_SETTINGS_H

#include <stdbool.h>

struct map_settings {
  double zone_mm; /* of elevation's references; 0: the default */
  int scale;      /* enum placido_scale_mode, which only builds with figures know */
};

struct compare_settings {
  bool mirror, no_align;
};

#endif
