/* `placido phantom`: renders what a topographer would photograph of an analytic eye. */
#include "acquire/cli/command.h"
#include "acquire/cli/record.h"
#include "base/file.h"

#include <placido/phantom.h>

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define RATE_HZ 30.0 /* of a session's frames */

/* Who sits before which instrument, and what disturbs the picture. */
struct subject {
  placido_surface *surface;
  placido_instrument instrument;
  placido_disturbance disturbance;
};

static bool has_ending(const char *text, const char *ending) {
  const size_t length = strlen(text), tail = strlen(ending);
  return length > tail && strcmp(text + length - tail, ending) == 0;
}

/* A word with a slash or ".json" is a file, any other a name of the built-in list. */
static bool is_file(const char *name) {
  return strchr(name, '/') || has_ending(name, ".json");
}

static int load_subject(struct subject *subject, const struct settings *settings,
                        placido_notes *notes, placido_error *err) {
  if (!settings->eye || !settings->instrument) {
    return placido_error_set(err, STATUS_USAGE, "--%s is missing (placido help phantom)",
                             settings->eye ? "instrument" : "eye");
  }
  const int status =
      is_file(settings->eye)
          ? placido_surface_load(&subject->surface, settings->eye, notes, err)
          : placido_phantom_eye(&subject->surface, settings->eye, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  return is_file(settings->instrument)
             ? placido_instrument_load(&subject->instrument, settings->instrument, notes, err)
             : placido_phantom_instrument(&subject->instrument, settings->instrument, err);
}

static int read_disturbance(placido_disturbance *disturbance, const struct settings *settings,
                            placido_error *err) {
  *disturbance = settings->disturbance;
  if (settings->motion.count == 2) {
    disturbance->motion_px = settings->motion.values[0];
    disturbance->motion_deg = settings->motion.values[1];
  }
  if (disturbance->motion_px < 0.0) {
    return placido_error_set(err, STATUS_USAGE, "--motion: its length is not negative");
  }
  for (size_t i = 0; i < settings->shift_mm.count; i++) {
    disturbance->shift_mm[i] = settings->shift_mm.values[i];
  }
  return PLACIDO_OK;
}

/* "eye.png" into "eye.instrument.json". */
static int make_sidecar(char path[PLACIDO_PATH_MAX], const char *image, const char *kind,
                        placido_error *err) {
  const int stem = (int)(strlen(image) - strlen(".png"));
  const int length = snprintf(path, PLACIDO_PATH_MAX, "%.*s.%s.json", stem, image, kind);
  if (length >= PLACIDO_PATH_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: the path is too long", image);
  }
  return PLACIDO_OK;
}

static int refuse_existing(const char *path, placido_error *err) {
  if (access(path, F_OK) == 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "%s: exists already", path);
  }
  return PLACIDO_OK;
}

/* The image with its geometry and its truth beside it: three files or none. */
static int save_image(const struct subject *subject, const placido_frame *frame,
                      const char *image, placido_error *err) {
  char instrument[PLACIDO_PATH_MAX], surface[PLACIDO_PATH_MAX];
  int status = make_sidecar(instrument, image, "instrument", err);
  if (status == PLACIDO_OK) {
    status = make_sidecar(surface, image, "surface", err);
  }
  const char *const paths[] = {instrument, surface, image};
  for (int i = 0; i < 3 && status == PLACIDO_OK; i++) {
    status = refuse_existing(paths[i], err);
  }
  if (status != PLACIDO_OK) {
    return status;
  }
  status = placido_instrument_save(&subject->instrument, instrument, err);
  if (status == PLACIDO_OK) {
    status = placido_surface_save(subject->surface, surface, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_frame_save_png(frame, image, err);
  }
  for (int i = 0; i < 3 && status != PLACIDO_OK; i++) {
    unlink(paths[i]);
  }
  return status;
}

static int render_image(const struct subject *subject, const char *path, int threads,
                        placido_error *err) {
  placido_frame frame = {0};
  int status = refuse_existing(path, err);
  if (status == PLACIDO_OK) {
    status = placido_phantom_render(&frame, subject->surface, &subject->instrument,
                                    &subject->disturbance, threads, err);
  }
  if (status == PLACIDO_OK) {
    status = save_image(subject, &frame, path, err);
  }
  placido_frame_free(&frame);
  return status;
}

static int render(const struct subject *subject, const struct settings *settings,
                  struct outcome *outcome, placido_error *err) {
  const int threads = settings_use_threads(settings);
  stages_next(&outcome->stages, "render");
  if (has_ending(settings->output, ".png")) {
    return render_image(subject, settings->output, threads, err);
  }
  if (has_ending(settings->output, ".session")) {
    return placido_phantom_session(settings->output, subject->surface, &subject->instrument,
                                   settings->side ? settings->side : "OD", settings->frames,
                                   RATE_HZ, &subject->disturbance, threads, err);
  }
  return placido_error_set(err, STATUS_USAGE, "-o %s: FILE.png or NAME.session was expected",
                           settings->output);
}

/* z of the shifted cornea on the instrument's axis; false where it does not reach there. */
static bool find_axis_z(const struct subject *subject, double *axis_z_mm) {
  const double *shift = subject->disturbance.shift_mm;
  placido_jet jet;
  const bool there = placido_surface_at(subject->surface, -shift[0], -shift[1], &jet);
  *axis_z_mm = placido_surface_vertex_z_mm(subject->surface) - jet.sag + shift[2];
  return there;
}

/* What a later `placido exam` has to know. */
static void tell(const struct subject *subject, const struct settings *settings,
                 struct outcome *outcome) {
  double axis_z_mm;
  if (!find_axis_z(subject, &axis_z_mm)) {
    return;
  }
  json_t *result = json_object();
  json_object_set_new(result, "output", record_text(settings->output));
  json_object_set_new(result, "axis_z_mm", json_real(axis_z_mm));
  outcome->result = result;
  stages_end(&outcome->stages);
  say(settings, "%s (axis-z %.6g mm)", settings->output, axis_z_mm);
}

static int run(const struct settings *settings, struct outcome *outcome, placido_error *err) {
  struct subject subject = {.surface = NULL};
  int status = read_disturbance(&subject.disturbance, settings, err);
  if (status == PLACIDO_OK) {
    status = load_subject(&subject, settings, &outcome->notes, err);
  }
  if (status == PLACIDO_OK) {
    status = render(&subject, settings, outcome, err);
  }
  if (status == PLACIDO_OK) {
    tell(&subject, settings, outcome);
  }
  placido_surface_free(subject.surface);
  return status;
}

static void list_names(const char *what, const char *const *names) {
  printf("\n%s\n ", what);
  for (; *names; names++) {
    printf(" %s", *names);
  }
  putchar('\n');
}

static void list_built_in(void) {
  list_names("Built-in eyes", placido_phantom_eyes());
  list_names("Built-in instruments", placido_phantom_instruments());
}

static const struct option_group *const groups[] = {&options_phantom, &options_general, NULL};

const struct command command_phantom = {
    .name = "phantom",
    .summary = "Render the mire image, or a whole session, of an eye whose shape is known.",
    .usage = "--eye NAME|FILE --instrument NAME|FILE -o FILE.png|NAME.session [OPTION...]",
    .examples =
        "  placido phantom --eye sphere --instrument cone24 -o sphere.png\n"
        "      also writes sphere.instrument.json and sphere.surface.json, the truth\n"
        "  placido phantom --eye keratoconus --instrument cone24 --lashes 9 -o eye.session\n"
        "      one frame is out of focus, one has the lid half closed, one is blurred by a jerk\n",
    .groups = groups,
    .list = list_built_in,
    .needs_output = true,
    .run = run,
};
