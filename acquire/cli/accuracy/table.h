/* What accuracy costs in time: settings of every stage, the error that each leaves in each of some
 * eyes, and the time that it takes. Measured by `placido bench accuracy`, read by `placido exam`. */
#ifndef PLACIDO_CLI_ACCURACY_TABLE_H
#define PLACIDO_CLI_ACCURACY_TABLE_H

#include <placido/status.h>
#include <stddef.h>

enum accuracy_stage {
  ACCURACY_MIRES,       /* knobs meridians, filter_px */
  ACCURACY_FIT,         /* knot_mm, degree, tolerance */
  ACCURACY_TRACE,       /* samples (rays), pattern */
  ACCURACY_PSF,         /* bucket_arcmin, buckets, wavelengths */
  ACCURACY_CONVOLUTION, /* doubles, memory_MB, size_px */
  ACCURACY_ACUITY,      /* trials */
  ACCURACY_REST,        /* what no knob changes: maps, indices, wavefront; without errors */
  ACCURACY_FLOOR,       /* everything at its finest against the truth: what measuring itself costs */
  ACCURACY_EXAM,        /* whole examinations */
  ACCURACY_STAGES
};

/* The stage's name in files: mires, fit, trace ... */
extern const char *const accuracy_stage_names[ACCURACY_STAGES];

enum accuracy_error {
  ACCURACY_ELEVATION_UM, /* rms over the central 6 mm, the mean height removed */
  ACCURACY_AXIAL_D,      /* rms over the central 6 mm without the inner 0.5 mm, 337.5 D */
  ACCURACY_PSF_OTF,      /* largest difference of the optical transfer function up to 60 cycles a
                            degree, 4 mm pupil: what `--max-error-psf` promises */
  ACCURACY_IMAGE,        /* largest difference of the seen chart, linear light relative to white */
  ACCURACY_LOGMAR,
  ACCURACY_ERRORS
};

extern const char *const accuracy_error_names[ACCURACY_ERRORS]; /* columns: elevation_um ... */

/* One setting of one stage on one eye. Every knob that `setting` does not name is at its finest
 * (that of ACCURACY_EXAM: at its default). An error is against the same stage with every knob at its
 * finest, but for FLOOR and EXAM, whose errors are against the true eye; NaN: this stage has no such
 * error, or none was measured. */
struct accuracy_row {
  enum accuracy_stage stage;
  char setting[96]; /* "knob=value" pairs with one space between, in the order of the knobs */
  char eye[32];
  double error[ACCURACY_ERRORS];
  double ms;        /* least processor time of all threads of some repetitions; `exam` puts it in
                       relation to the probe */
};

struct accuracy_table {
  struct accuracy_row *rows;
  size_t count;
  double probe_ms; /* of accuracy_probe_ms when the rows were measured: how fast the machine was */
  char created[32], machine[96]; /* machine: processor and cores, for a person */
};

/* Appends a copy. */
int accuracy_table_add(struct accuracy_table *table, const struct accuracy_row *row,
                       placido_error *err);

/* `placido-accuracy/1` (docs/formats.md), a CSV with its facts in the head's comment lines; by way
 * of a temporary name. Load refuses what it does not understand with file and line. */
int accuracy_table_save(const struct accuracy_table *table, const char *path, placido_error *err);
int accuracy_table_load(struct accuracy_table *table, const char *path, placido_error *err);

/* The table that the program brings along. */
int accuracy_table_built_in(struct accuracy_table *table, placido_error *err);

/* The user's own, where `bench accuracy` keeps what it measured on this machine; `path` has room for
 * `size` bytes. PLACIDO_SYSTEM where the environment names no such place. */
int accuracy_table_path(char *path, size_t size, placido_error *err);

void accuracy_table_free(struct accuracy_table *table);

/* Least processor time of a few laps of a fixed piece of work like the program's own (a small fit's
 * arithmetic and a transform), some milliseconds in all: times of two machines, or of one under
 * different loads, compare as their ratios to it. */
double accuracy_probe_ms(void);

#endif
