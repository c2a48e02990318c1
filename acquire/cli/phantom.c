/* `placido phantom`: renders what a topographer would photograph of an analytic eye. */
#include "acquire/cli/command.h"
#include "acquire/cli/record.h"
#include "acquire/cli/subject.h"
#include "base/file.h"

#include <placido/phantom.h>

#include <errno.h>
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

static int load_subject(struct subject *subject, const struct settings *settings,
                        placido_notes *notes, placido_error *err) {
  if (!settings->eye || !settings->instrument) {
    return placido_error_set(err, STATUS_USAGE, "--%s is missing (placido help phantom)",
                             settings->eye ? "instrument" : "eye");
  }
  const int status = subject_eye(&subject->surface, settings->eye, notes, err);
  return status == PLACIDO_OK
             ? subject_instrument(&subject->instrument, settings->instrument, notes, err)
             : status;
}

static void read_disturbance(placido_disturbance *disturbance, const struct settings *settings) {
  *disturbance = settings->disturbance;
  if (settings->motion.count == 2) {
    disturbance->motion_px = settings->motion.values[0];
    disturbance->motion_deg = settings->motion.values[1];
  }
  for (size_t i = 0; i < settings->shift_mm.count; i++) {
    disturbance->shift_mm[i] = settings->shift_mm.values[i];
  }
}

/* "FOLDER/eye.png" into "FOLDER/eye.instrument.json". */
static int make_sidecar(char path[PLACIDO_PATH_MAX], const char *image, const char *kind,
                        placido_error *err) {
  const int stem = (int)(strlen(image) - strlen(".png"));
  const int length = snprintf(path, PLACIDO_PATH_MAX, "%.*s.%s.json", stem, image, kind);
  if (length >= PLACIDO_PATH_MAX) {
    return placido_error_set(err, PLACIDO_INPUT, "%s: the path is too long", image);
  }
  return PLACIDO_OK;
}

/* An image and what goes with it: its geometry and its truth. */
struct picture {
  char paths[3][PLACIDO_PATH_MAX]; /* instrument, surface, image */
};

static int name_picture(struct picture *picture, const char *image, placido_error *err) {
  snprintf(picture->paths[2], PLACIDO_PATH_MAX, "%s", image);
  const int status = make_sidecar(picture->paths[0], image, "instrument", err);
  return status == PLACIDO_OK ? make_sidecar(picture->paths[1], image, "surface", err) : status;
}

static int refuse_existing(const struct picture *picture, placido_error *err) {
  for (int i = 2; i >= 0; i--) {
    if (access(picture->paths[i], F_OK) == 0) {
      return placido_error_set(err, PLACIDO_SYSTEM, "%s: exists already", picture->paths[i]);
    }
  }
  return PLACIDO_OK;
}

/* Three files take their places, or none. */
static int move_picture(const struct picture *from, const struct picture *to,
                        placido_error *err) {
  int status = refuse_existing(to, err), moved = 0;
  for (; moved < 3 && status == PLACIDO_OK; moved++) {
    if (rename(from->paths[moved], to->paths[moved]) != 0) {
      status = placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s", to->paths[moved],
                                 strerror(errno));
      break;
    }
  }
  while (status != PLACIDO_OK && moved > 0) {
    unlink(to->paths[--moved]);
  }
  return status;
}

static int save_image(const struct subject *subject, const placido_frame *frame,
                      const struct picture *picture, placido_error *err) {
  int status = placido_instrument_save(&subject->instrument, picture->paths[0], err);
  if (status == PLACIDO_OK) {
    status = placido_surface_save(subject->surface, picture->paths[1], err);
  }
  return status == PLACIDO_OK ? placido_frame_save_png(frame, picture->paths[2], err) : status;
}

/* What is made, where, and who is told. */
struct work {
  const struct subject *subject;
  const struct settings *settings;
  struct interrupt *interrupt;
  int threads;
  placido_directory workshop; /* everything is made in it, and removed with it */
};

static int render_image(struct work *work, placido_error *err) {
  struct picture made, placed;
  placido_frame frame = {0};
  char path[PLACIDO_PATH_MAX];
  int status = placido_path_join(path, work->workshop.temporary, "eye.png", err);
  if (status == PLACIDO_OK) {
    status = name_picture(&made, path, err);
  }
  if (status == PLACIDO_OK) {
    status = name_picture(&placed, work->settings->output, err);
  }
  if (status == PLACIDO_OK) {
    status = refuse_existing(&placed, err);
  }
  if (status == PLACIDO_OK) {
    status = placido_phantom_render(&frame, work->subject->surface, &work->subject->instrument,
                                    &work->subject->disturbance, work->threads, err);
  }
  if (status == PLACIDO_OK) {
    status = save_image(work->subject, &frame, &made, err);
  }
  if (status == PLACIDO_OK) {
    interrupt_hold(work->interrupt);
    status = move_picture(&made, &placed, err);
    interrupt_release(work->interrupt, &work->workshop);
  }
  placido_frame_free(&frame);
  return status;
}

static int render_session(struct work *work, placido_error *err) {
  placido_directory session = work->workshop;
  const struct settings *settings = work->settings;
  int status = placido_path_join(session.temporary, work->workshop.temporary, "session", err);
  if (status == PLACIDO_OK) {
    status = placido_phantom_session(session.temporary, work->subject->surface,
                                     &work->subject->instrument,
                                     settings->side ? settings->side : "OD", settings->frames,
                                     RATE_HZ, &work->subject->disturbance, work->threads, err);
  }
  if (status == PLACIDO_OK) {
    interrupt_hold(work->interrupt);
    status = placido_directory_commit(&session, err);
    interrupt_release(work->interrupt, &work->workshop);
  }
  return status;
}

static int render(const struct subject *subject, const struct settings *settings,
                  struct outcome *outcome, placido_error *err) {
  const bool image = subject_has_ending(settings->output, ".png");
  if (!image && !subject_has_ending(settings->output, ".session")) {
    return placido_error_set(err, STATUS_USAGE, "-o %s: FILE.png or NAME.session was expected",
                             settings->output);
  }
  struct work work = {.subject = subject,
                      .settings = settings,
                      .interrupt = outcome->interrupt,
                      .threads = settings_use_threads(settings)};
  stages_next(&outcome->stages, "render");
  interrupt_hold(work.interrupt);
  int status = placido_directory_create(&work.workshop, settings->output, NULL, err);
  interrupt_release(work.interrupt, &work.workshop);
  if (status == PLACIDO_OK) {
    status = image ? render_image(&work, err) : render_session(&work, err);
  }
  placido_directory_discard(&work.workshop);
  return status;
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
  read_disturbance(&subject.disturbance, settings);
  int status = load_subject(&subject, settings, &outcome->notes, err);
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
