/* The accuracy test of ISO 19980 / ANSI Z80.23: known objects measured through the whole chain,
 * differences by zone. */
#ifndef PLACIDO_CLI_ISO_CHECK_H
#define PLACIDO_CLI_ISO_CHECK_H

#include "acquire/cli/settings.h"
#include "report/iso.h"

#include <jansson.h>
#include <placido/instrument.h>
#include <placido/surface.h>

#define ISO_OBJECTS_MAX 64

/* What is measured, and what it is like in truth. */
struct iso_object {
  char name[96];
  placido_surface *truth;
  char image[1024];     /* a file or session; empty: the phantom renders it */
  double axis_z_mm;     /* NaN: as the session recorded, else 0 */
  bool free_pose;       /* it stands where it stands: shifted to where it fits best */
  bool toric, aspheric; /* its axis, its asphericity is checked, too */
};

struct iso_objects {
  size_t count;
  struct iso_object items[ISO_OBJECTS_MAX];
};

/* The objects of the phantom, or those that the settings name with their images. Free with
 * iso_objects_free. */
int iso_objects_list(struct iso_objects *objects, const struct settings *settings,
                     placido_notes *notes, placido_error *err);
void iso_objects_free(struct iso_objects *objects);

/* Measures one object and compares. PLACIDO_QUALITY, with the reason in err, where it cannot be
 * measured. */
int iso_object_check(placido_iso_result *result, const struct iso_object *object,
                     const placido_instrument *instrument, const struct settings *settings,
                     unsigned seed, placido_notes *notes, placido_error *err);

/* Compares a measured surface with the object, and holds it against the targets. */
int iso_compare(placido_iso_result *result, const struct iso_object *object,
                const placido_surface *measured, placido_error *err);

/* What is said wherever the targets stand. */
extern const char iso_targets_note[];

/* Writes iso-check.csv and iso-check.json (docs/formats.md). */
int iso_save_csv(const placido_iso_result *results, size_t count, const char *path,
                 placido_error *err);
/* The same object, a new reference; NULL when memory is out. */
json_t *iso_result_json(const placido_iso_result *results, size_t count, const char *instrument,
                        const char *created);
int iso_save_json(const placido_iso_result *results, size_t count, const char *instrument,
                  const char *created, const char *path, placido_error *err);

#endif
