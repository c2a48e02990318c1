/* The option tables: every option of every command, with its unit, range and default. */
#include "acquire/cli/settings.h"

#include <placido/combine.h>

#include <math.h>
#include <stddef.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#define FIELD(name) offsetof(struct settings, name)
#define MOTION_MAX_PX 200.0
#define THREADS_MAX 256
#define COUNT(rows) (sizeof(rows) / sizeof((rows)[0]))

int parse_distance(void *field, const struct option_row *row, const char *text,
                   placido_error *err) {
  struct number_list list;
  const int status = parse_tuple(&list, row, text, 1, 2, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  const double sigma = list.count == 2 ? list.values[1] : 0.0;
  if (sigma < 0.0) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: SIGMA is not negative", row->name, text);
  }
  *(struct distance *)field =
      (struct distance){.given = true, .value_mm = list.values[0], .sigma_mm = sigma};
  return PLACIDO_OK;
}

static int parse_motion(void *field, const struct option_row *row, const char *text,
                        placido_error *err) {
  struct number_list *list = field;
  const int status = parse_tuple(list, row, text, 2, 2, err);
  if (status == PLACIDO_OK && (list->values[0] < 0.0 || list->values[0] > MOTION_MAX_PX)) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: its length ranges from 0 to %g px",
                             row->name, text, MOTION_MAX_PX);
  }
  return status;
}

static int parse_side(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  if (strcmp(text, "OD") != 0 && strcmp(text, "OS") != 0) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: OD or OS was expected", row->name, text);
  }
  return parse_text(field, row, text, err);
}

static int parse_triple(void *field, const struct option_row *row, const char *text,
                        placido_error *err) {
  return parse_tuple(field, row, text, 3, 3, err);
}

static int parse_pair(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  return parse_tuple(field, row, text, 2, 2, err);
}

/* Pupils whose pictures are named by their size: to six digits, as %g writes it. */
static int parse_different(void *field, const struct option_row *row, const char *text,
                           placido_error *err) {
  const int status = parse_numbers(field, row, text, err);
  const struct number_list *list = field;
  for (size_t i = 0; i < list->count && status == PLACIDO_OK; i++) {
    for (size_t k = 0; k < i; k++) {
      if (fabs(list->values[i] - list->values[k]) < 1e-4) {
        return placido_error_set(err, STATUS_USAGE, "--%s: %g stands twice", row->name,
                                 list->values[i]);
      }
    }
  }
  return status;
}

static int parse_degree(void *field, const struct option_row *row, const char *text,
                        placido_error *err) {
  const int status = parse_integer(field, row, text, err);
  if (status == PLACIDO_OK && *(int *)field == 4) {
    return placido_error_set(err, STATUS_USAGE, "--%s 4: 3 or 5 was expected", row->name);
  }
  return status;
}

static int parse_seed(void *field, const struct option_row *row, const char *text,
                      placido_error *err) {
  int seed;
  const int status = parse_integer(&seed, row, text, err);
  if (status == PLACIDO_OK) {
    *(uint64_t *)field = (uint64_t)seed;
  }
  return status;
}

static const struct option_row general_rows[] = {
    {"threads", 0, "N", "Threads to use (default: as many as the machine has). Results do not "
     "depend on it.", FIELD(threads), parse_integer, 1, THREADS_MAX},
    {"json", 0, NULL, "Print one JSON object of the result on standard output, for machines.",
     FIELD(json), parse_switch, 0, 0},
    {"quiet", 'q', NULL, "Print nothing but errors (and --json's object).", FIELD(quiet),
     parse_switch, 0, 0},
    {"help", 'h', NULL, "Print this help.", FIELD(help), parse_switch, 0, 0},
};

static const struct option_row directory_rows[] = {
    {"output", 'o', "DIR", "Directory to write. It appears whole or not at all; an earlier result "
     "of the same command is replaced, anything else is not touched.", FIELD(output),
     parse_text, 0, 0},
    {"timing", 0, NULL, "Print the wall time of every stage, and the processor time of all threads.", FIELD(timing), parse_switch, 0, 0},
};

static const struct option_row measuring_rows[] = {
    {"instrument", 0, "FILE", "The topographer's geometry (placido-instrument/1). Needed for an "
     "image; for a session it takes the place of the session's own.", FIELD(instrument),
     parse_text, 0, 0},
    {"axis-z", 0, "Z[,SIGMA]", "z of the cornea on the instrument's axis and its standard "
     "deviation, mm. Default: what the session recorded, else 0 with sigma 0.05. Without SIGMA it "
     "counts as exactly known.", FIELD(axis_z), parse_distance, -100, 100},
    {"frame", 0, "N", "Frame to examine, counted from 0 (default: the one that shows the mires "
     "best).", FIELD(frame), parse_integer, 0, 2e9},
    {"combine", 0, "N", "Frames to make into one, the best ones, for less noise: the eye's movement "
     "between them is removed, and those that disagree are set aside (default 1). Not with --frame.",
     FIELD(combine), parse_integer, 1, PLACIDO_COMBINE_MAX},
    {"knots", 0, "MM", "Knot spacing of the surface's spline, mm (default: 0.5, or finer where the "
     "residuals ask for it).", FIELD(knot_mm), parse_number, 0.15, 2},
    {"degree", 0, "3|5", "Degree of the surface's spline (default 5).", FIELD(degree), parse_degree,
     3, 5},
    {"fit-tolerance", 0, "SHARE", "The fit ends with a step that moves residuals by less than this "
     "share of their noise (default: as fine as rounding allows).", FIELD(fit_tolerance),
     parse_number, 1e-6, 1},
    {"meridians", 0, "N", "Meridians along which edges are measured (default 360).",
     FIELD(meridians), parse_integer, 24, 1440},
    {"filter", 0, "PX", "Standard deviation of the smoothing along the mires in which edges are "
     "looked for, px (default 1).", FIELD(filter_px), parse_number, 0.6, 4},
};

static const struct option_row seeing_rows[] = {
    {"pupils", 0, "MM,MM,...", "Diameters of the simulated pupil, mm; \"auto\" among them: what the "
     "scene's luminance gives, of each scene its own (default 2,4,8).", FIELD(pupils_mm),
     parse_pupils, 0.1, 12},
    {"scene", 0, "NAME|FILE", "What is looked at: a chart by name or a placido-scene/1 file. May "
     "be given several times (default: tumbling-e).", FIELD(scenes), parse_text_more, 0, 0},
    {"acuity", 0, "TEST,...", "Tests whose acuity is predicted: e (tumbling E), c and c8 (Landolt C in "
     "four and eight directions), sloan, or none (default e).", FIELD(acuity),
     parse_acuity, 0, 0},
    {"trials", 0, "N", "Letters that the predicted observer is shown of each size (default 4096). "
     "The error that they leave is told.", FIELD(trials), parse_integer, 64, 1e6},
    {"allow-coarse", 0, NULL, "Show scenes whose pixels are larger than the point spread "
     "function's buckets, too. Blur finer than a pixel cannot be told from the pixel.",
     FIELD(allow_coarse), parse_switch, 0, 0},
    {"index", 0, "N", "Refractive index behind the cornea (default 1.3375).", FIELD(index),
     parse_number, 1.01, 2},
    {"rays", 0, "N", "Rays: a crosshatch of N×N and (N-1)×(N-1) over the pupil's square (default "
     "400; with --cwhatuc 100, its 19,801 points).", FIELD(samples), parse_integer, 2, 4000},
    {"pattern", 0, "crosshatch|equal-area|quasi-random", "How the pupil is filled with rays: the "
     "crosshatch (default), or as many inside the pupil as a sunflower or as a sequence of even "
     "gaps.", FIELD(rays.pattern), parse_pattern, 0, 0},
    {"light", 0, "spread|counted", "How rays become the point spread function: each one's light "
     "spread over what its cell of the pupil becomes on the retina (default), or counted in the "
     "bucket that it meets (with --cwhatuc).", FIELD(rays.light), parse_light, 0, 0},
    {"grow", 0, "TIMES", "Where over 0.1 % of the light would fall outside, the point spread "
     "function gets more buckets than its 257 a side, up to so many times (default 4, of exam 1: never).",
     FIELD(rays.grow), parse_number, 1, 16},
    {"bucket", 0, "ARCMIN", "Width of a bucket of the point spread function, minutes of arc "
     "(default 0.5).", FIELD(bucket_arcmin), parse_number, 0.01, 10},
    {"diffraction", 0, "NM", "The point spread function by waves of this length, nm, in place of "
     "rays: 555 for green. Scenes diffract where that would be seen (placido help plan).", FIELD(rays.wavelength_nm),
     parse_number, 300, 1200},
    {"through-focus", 0, "D", "Curves of image quality against a lens of up to so many dioptres "
     "either way (default none).", FIELD(rays.through_focus_D), parse_number, 0.1, 10},
    {"cwhatuc", 0, NULL, "As the program CWhatUC did it: buckets of 2.5 µm, each called half a "
     "minute.", FIELD(cwhatuc), parse_switch, 0, 0},
    {"double", 0, NULL, "With --cwhatuc: spread scenes in double precision, for twice the time. Plans "
     "choose for themselves.", FIELD(spread.doubles), parse_switch, 0, 0},
    {"memory", 0, "MB", "With --cwhatuc: most memory for one tile of a scene and for its point spread "
     "function each; larger scenes go in tiles (default 1024).", FIELD(spread.memory_MB), parse_number, 1, 1e6},
    {"wisdom", 0, NULL, "With --cwhatuc: measure once which transforms are quickest on this machine and "
     "keep that in the user's cache. Rounding then depends on it.", FIELD(spread.wisdom), parse_switch, 0, 0},
};

static const struct option_row wavefront_rows[] = {
    {"wavefront", 0, "MM,MM,...", "Diameters of the pupils whose corneal wavefront is given, mm "
     "(default 3,6).", FIELD(wavefront_mm), parse_different, 0.5, 12},
    {"wavefront-centre", 0, "X,Y", "Their centre, mm from the instrument's axis (default 0,0).",
     FIELD(wavefront_centre_mm), parse_pair, -6, 6},
    {"wavefront-order", 0, "N", "Highest order of the Zernike terms (default 8).",
     FIELD(wavefront_order), parse_integer, 2, 15},
    {"wavefront-index", 0, "N", "Refractive index behind the cornea: 1.3375 keratometric, 1.376 "
     "of the cornea itself (default: --index, else 1.3375).", FIELD(wavefront_index),
     parse_number, 1.01, 2},
};

static const struct option_row phantom_rows[] = {
    {"eye", 0, "NAME|FILE", "A built-in eye or a placido-surface/1 file.", FIELD(eye), parse_text,
     0, 0},
    {"instrument", 0, "NAME|FILE", "A built-in instrument or a placido-instrument/1 file.",
     FIELD(instrument), parse_text, 0, 0},
    {"side", 0, "OD|OS", "Which eye a session says it is: right or left (default OD).",
     FIELD(side), parse_side, 0, 0},
    {"output", 'o', "FILE", "FILE.png for one image, NAME.session for a session. Must not exist "
     "yet.",
     FIELD(output), parse_text, 0, 0},
    {"frames", 0, "N", "Frames of the session, with small natural movements of the eye between "
     "them (default 8).", FIELD(frames), parse_integer, 1, 10000},
    {"bits", 0, "N", "Bits of a sample, 8 to 16 (default 8).", FIELD(disturbance.bits),
     parse_integer, 8, 16},
    {"noise", 0, "G", "Standard deviation of sensor noise, grey levels of 8 bits (default 0).",
     FIELD(disturbance.noise), parse_number, 0, 100},
    {"blur", 0, "PX", "Defocus: standard deviation of a Gaussian, px (default 0).",
     FIELD(disturbance.blur_px), parse_number, 0, 50},
    {"motion", 0, "L,DEG", "Motion blur: length in px and direction in degrees (default none).",
     FIELD(motion), parse_motion, -360, 360},
    {"lashes", 0, "N", "Eyelashes in the picture (default 0).", FIELD(disturbance.lashes),
     parse_integer, 0, 200},
    {"nose", 0, NULL, "With the nose's shadow.", FIELD(disturbance.nose), parse_switch, 0, 0},
    {"lid", 0, NULL, "With a drooping upper lid.", FIELD(disturbance.lid), parse_switch, 0, 0},
    {"break-up", 0, "SHARE", "Share of the cornea where the tear film is broken, 0 to 0.5 (default "
     "0).", FIELD(disturbance.break_up), parse_number, 0, 0.5},
    {"shift", 0, "X,Y,Z", "Movement of the whole eye, mm (default 0,0,0).", FIELD(shift_mm),
     parse_triple, -20, 20},
    {"seed", 0, "N", "Seed of everything random (default 1).", FIELD(disturbance.seed), parse_seed,
     0, 2e9},
};

static const struct option_row devices_rows[] = {
    {"watch", 0, NULL, "Go on and tell of every device that comes or goes, until Ctrl-C; with --json "
     "one object a line.", FIELD(watch), parse_switch, 0, 0},
};

static const struct option_row simulated_rows[] = {
    {"eye", 0, "NAME|FILE", "What is seen: a built-in eye of the phantom, or a placido-surface/1 "
     "file, that moves a little and blinks (default normal).", FIELD(eye), parse_text, 0, 0},
    {"instrument", 0, "NAME|FILE", "The topographer before it (default cone24).",
     FIELD(instrument), parse_text, 0, 0},
    {"pictures", 0, "N", "Pictures of the eye, rendered before the camera is plugged in (default "
     "16).", FIELD(pictures), parse_integer, 1, 500},
    {"noise", 0, "G", "Standard deviation of sensor noise, grey levels of 8 bits (default 1.5).",
     FIELD(disturbance.noise), parse_number, 0, 100},
    {"bits", 0, "N", "Bits of a sample, 8 to 16 (default 8).", FIELD(disturbance.bits),
     parse_integer, 8, 16},
    {"face", 0, "NAME", "The kind of camera (default u3v).", FIELD(face), parse_text, 0, 0},
    {"serial", 0, "TEXT", "Its serial number (default SIM0001).", FIELD(serial), parse_text, 0, 0},
    {"rate", 0, "HZ", "Pictures a second until the host asks for another rate (default: the "
     "session's, or 30).", FIELD(rate_hz), parse_number, 0.1, 500},
    {"high-speed", 0, NULL, "As a device of USB 2; without, of USB 3.", FIELD(high_speed),
     parse_switch, 0, 0},
    {"zip", 0, NULL, "u3v: its description file comes in a zip.", FIELD(zip), parse_switch, 0, 0},
    {"listen", 0, "[ADDRESS:]PORT", "Wait on a TCP port for \"usbip attach\" of this or another "
     "machine, rather than be plugged into this machine's kernel. Without ADDRESS only this "
     "machine is heard; who is heard can do as with any USB device.", FIELD(listen), parse_text, 0,
     0},
    {"faults", 0, "LIST", "What goes wrong when: \"stall@5s,drop*3@8s,disconnect=2s@20s,"
     "slow=50@30s\".", FIELD(faults), parse_text, 0, 0},
    {"for", 0, "SECONDS", "End after that time (default: never).", FIELD(for_s), parse_number,
     0.001, 1e7},
};

static const struct option_row session_rows[] = {
    {"output", 'o', "PATH", "What is written: by pack and repair a session, by export a directory "
     "of pictures. Must not exist yet. Without it, pack works in place.", FIELD(output),
     parse_text, 0, 0},
    {"frames", 0, "LIST", "export: which frames, counted from 0, like 3,5-9 (default: all).",
     FIELD(frame_list), parse_text, 0, 0},
    {"type", 0, "png|tiff", "export: the kind of picture (default png).", FIELD(picture_type),
     parse_text, 0, 0},
    {"instrument", 0, "FILE", "repair: the topographer's geometry (placido-instrument/1), where "
     "the session's own is lost.", FIELD(instrument), parse_text, 0, 0},
};

static const struct option_row calibrate_rows[] = {
    {"output", 'o', "DIR", "Directory to write: instrument.json with its uncertainty, and "
     "calibration.json, the report. Must not exist yet, or be empty.", FIELD(output), parse_text,
     0, 0},
    {"meridians", 0, "N", "Meridians along which edges are measured (default 360).",
     FIELD(meridians), parse_integer, 24, 1440},
};

static const struct option_row verify_rows[] = {
    {"ball", 0, "MM", "The ball's radius.", FIELD(ball_mm), parse_number, 4.5, 20},
    {"instrument", 0, "FILE", "The topographer's geometry (placido-instrument/1). Needed unless a "
     "session has its own.", FIELD(instrument), parse_text, 0, 0},
    {"axis-z", 0, "Z", "z of the ball on the instrument's axis, mm (default: what the session "
     "recorded, else as the ball's radius says; then its power as a whole is not checked).",
     FIELD(axis_z), parse_distance, -100, 100},
    {"frame", 0, "N", "Frame to examine, counted from 0 (default: the one that shows the mires "
     "best).", FIELD(frame), parse_integer, 0, 2e9},
    {"limit", 0, "D", "Largest error of axial power in any zone, and of the shape what that power "
     "amounts to, 6.84 µm a dioptre (default 0.1).", FIELD(limit_D), parse_number, 0.001, 10},
    {"log", 0, "FILE.csv", "Add a line to this log, and draw its drift in FILE.png.", FIELD(log),
     parse_text, 0, 0},
};

const struct option_group options_general = {"General", general_rows, COUNT(general_rows)};
const struct option_group options_directory = {"Output", directory_rows, COUNT(directory_rows)};
const struct option_group options_measuring = {"Measuring", measuring_rows, COUNT(measuring_rows)};
const struct option_group options_seeing = {"Seeing", seeing_rows, COUNT(seeing_rows)};
const struct option_group options_wavefront = {"Corneal wavefront", wavefront_rows,
                                                COUNT(wavefront_rows)};
const struct option_group options_session = {"Session", session_rows, COUNT(session_rows)};
const struct option_group options_phantom = {"Phantom", phantom_rows, COUNT(phantom_rows)};
const struct option_group options_devices = {"Devices", devices_rows, COUNT(devices_rows)};
const struct option_group options_simulated = {"Simulated camera", simulated_rows,
                                                COUNT(simulated_rows)};

const struct option_group options_calibrate = {"Calibration", calibrate_rows,
                                                COUNT(calibrate_rows)};
const struct option_group options_verify = {"Verification", verify_rows, COUNT(verify_rows)};

struct settings settings_default(void) {
  return (struct settings){
      .frame = -1,
      .limit_D = 0.1,
      .frames = 8,
      .pictures = 16,
      .pupils_mm = {.count = 3, .values = {2.0, 4.0, 8.0}},
      .wavefront_mm = {.count = 2, .values = {3.0, 6.0}},
      .disturbance = {.seed = 1},
  };
}

#ifdef _OPENMP
int settings_use_threads(const struct settings *settings) {
  int threads = settings->threads > 0 ? settings->threads : omp_get_max_threads();
  threads = threads < THREADS_MAX ? threads : THREADS_MAX;
  omp_set_num_threads(threads);
  return threads;
}
#else
/* Built without OpenMP: there is one thread. */
int settings_use_threads(const struct settings *settings) {
  (void)settings;
  return 1;
}
#endif
