/* What a person may set about the eye behind the cornea: retina, what is corrected, what is worn. */
#ifndef PLACIDO_CLI_EYE_SETTINGS_H
#define PLACIDO_CLI_EYE_SETTINGS_H

#include <placido/eye.h>
#include <stdbool.h>

struct settings;

/* A lens as it is on the cornea; `vertex_mm` before it where it is worn. */
struct worn_lens {
  bool given;
  placido_correction power;
  double vertex_mm;
};

struct asked_correction {
  bool given;
  enum placido_correct what;
};

struct eye_settings {
  double axial_mm;   /* 0: not given */
  struct asked_correction correct;
  struct worn_lens lens;
  double vertex_mm;  /* of the spectacles that results are also given for; 0: the default */
};

/* Refuses what contradicts itself, with STATUS_USAGE. */
int eye_settings_check(const struct settings *settings, placido_error *err);

/* The eye that is asked for. Without --correct everything is searched; with a lens that is worn
 * only the retina, and nothing where that is given, too. PLACIDO_OK or PLACIDO_INPUT. */
int eye_settings_read(placido_eye *eye, const struct settings *settings, double pupil_mm,
                      placido_error *err);

/* A lens as it stands on a prescription. */
struct prescription {
  double vertex_mm, sphere_D, cylinder_D, axis_deg; /* NaN: none, or no axis without a cylinder */
};

/* The lens on the cornea, and as spectacles at the vertex distance that is asked for. */
struct prescription prescription_cornea(const placido_correction *correction);
struct prescription prescription_spectacles(const struct settings *settings,
                                            const placido_correction *correction);

#endif
