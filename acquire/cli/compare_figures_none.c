/* This build cannot draw (PLACIDO_FIGURES is off): says so in the result. */
#include "acquire/cli/compare.h"

int comparison_draw(struct comparison *comparison, placido_error *err) {
  (void)err;
  placido_notes_add(&comparison->outcome->notes,
                    "this build draws no figures: maps/*.png and compare.html are left out "
                    "(PLACIDO_FIGURES)");
  return PLACIDO_OK;
}
