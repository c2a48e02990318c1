/* The table of a plan that a person reads: scene and eye above it, settings and what is promised
 * below. No line is longer than 120 columns. */
#include "simulate/plan/plan.h"

#include <errno.h>
#include <math.h>
#include <string.h>

enum { WIDTH = 120, SENTENCE = 54 };

/* A sentence from column SENTENCE on, broken between words. */
static void write_sentence(FILE *stream, const char *text) {
  const size_t room = WIDTH - SENTENCE;
  while (strlen(text) > room) {
    size_t end = room;
    while (end > 0 && text[end] != ' ') {
      end--;
    }
    end = end > 0 ? end : room;
    fprintf(stream, "%.*s\n%*s", (int)end, text, SENTENCE, "");
    text += end + (text[end] == ' ');
  }
  fprintf(stream, "%s\n", text);
}

static const char *outcome(const placido_verdict *verdict) {
  if (!verdict->applies && !verdict->runs) {
    return "nothing to do";
  }
  if (verdict->runs) {
    return verdict->force == PLACIDO_FORCE_ON ? "runs, forced" : "runs";
  }
  return verdict->force == PLACIDO_FORCE_OFF ? "out, forced" : "left out";
}

/* An error of the picture: digits as far as they say something. */
static void print_bound(char text[16], double bound) {
  if (bound > 0 && bound < 0.00005) {
    snprintf(text, 16, "<0.0001");
  } else {
    snprintf(text, 16, "%.4f", bound);
  }
}

static void write_verdict(FILE *stream, const placido_verdict *verdict) {
  char bound[16] = "-";
  if (verdict->applies) {
    print_bound(bound, verdict->bound);
  }
  fprintf(stream, "%-22s %-13s %7s %7.1f  ", verdict->name, outcome(verdict), bound,
          verdict->applies ? verdict->cost_ms : 0);
  write_sentence(stream, verdict->reason);
}

static void write_scene(FILE *stream, const placido_plan *plan) {
  const placido_scene *scene = plan->scene;
  const placido_facts *facts = &plan->facts;
  fprintf(stream, "scene %s: %.1f by %.1f degrees, %s", scene->name, facts->width_deg,
          facts->height_deg, facts->planes == 1 ? "grey" : "in colours");
  if (scene->conditions.luminance_cd_m2 > 0) {
    fprintf(stream, ", white of %.3g cd/m2", scene->conditions.luminance_cd_m2);
  }
  if (facts->nearest_D > facts->farthest_D) {
    fprintf(stream, ", from %.2f to %.2f D away", facts->farthest_D, facts->nearest_D);
  } else if (facts->focus_D > 0) {
    fprintf(stream, ", %.3g m away", 1 / facts->focus_D);
  } else {
    fprintf(stream, ", far away");
  }
  fprintf(stream, "\n");
}

static void write_eye(FILE *stream, const placido_eye *eye) {
  double sphere_D, cylinder_D, axis_deg;
  placido_correction_clinical(&eye->correction, &sphere_D, &cylinder_D, &axis_deg);
  fprintf(stream, "eye: pupil %.2f mm", eye->pupil_mm);
  if (eye->pupil_x_mm != 0 || eye->pupil_y_mm != 0) {
    fprintf(stream, " at (%.2f, %.2f)", eye->pupil_x_mm, eye->pupil_y_mm);
  }
  fprintf(stream, ", wearing %+.2f D", sphere_D);
  if (isfinite(axis_deg)) {
    fprintf(stream, " %+.2f x %.0f", cylinder_D, axis_deg);
  }
  fprintf(stream, ", %.0f years\n", eye->age_years);
}

static void write_settings(FILE *stream, const placido_plan *plan) {
  const placido_plan_settings *s = &plan->settings;
  const int values[] = {s->pupil_samples, s->wavelengths, s->layers, s->nodes, s->buckets};
  char bound[16];
  fprintf(stream, "\n%-30s %5s %7s\n", "computed with", "", "error");
  for (size_t i = 0; i < sizeof plan->settings_share / sizeof *plan->settings_share; i++) {
    print_bound(bound, plan->settings_share[i]);
    fprintf(stream, "%-30s ", placido_plan_setting_names[i]);
    if (i < sizeof values / sizeof *values) {
      fprintf(stream, "%5d %7s\n", values[i], bound);
    } else {
      fprintf(stream, "%5s %7s\n", s->doubles ? "64" : "32", bound);
    }
  }
}

static bool any_forced_off(const placido_plan *plan) {
  for (size_t i = 0; i < plan->effects.count; i++) {
    if (plan->verdicts[i].applies && !plan->verdicts[i].runs && !plan->own[i]) {
      return true;
    }
  }
  return false;
}

static void write_promise(FILE *stream, const placido_plan *plan) {
  char left_out[16], settings[16], sum[16];
  double promised = plan->left_out + plan->settings.bound;
  print_bound(left_out, plan->left_out);
  print_bound(settings, plan->settings.bound);
  print_bound(sum, promised);
  fprintf(stream, "\nabout %.3g s on one core\n", 1e-3 * plan->settings.cost_ms);
  fprintf(stream, "at most %s of white is wrong: %s by what was left out, %s by how it is "
          "computed; tolerance %g\n", sum, left_out, settings, plan->wish.tolerance);
  if (promised > plan->wish.tolerance) {
    fprintf(stream, "that is more than the tolerance: nothing here computes it more finely\n");
  }
  if (any_forced_off(plan)) {
    fprintf(stream, "what was forced off is not counted: it was a person's decision\n");
  }
}

int placido_plan_write(const placido_plan *plan, FILE *stream, placido_error *err) {
  write_scene(stream, plan);
  write_eye(stream, &plan->eye);
  fprintf(stream, "\n%-22s %-13s %7s %7s  %s\n", "effect", "", "bound", "ms", "why");
  for (size_t i = 0; i < plan->effects.count; i++) {
    write_verdict(stream, &plan->verdicts[i]);
  }
  write_settings(stream, plan);
  write_promise(stream, plan);
  if (fflush(stream) != 0 || ferror(stream)) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot write the plan: %s", strerror(errno));
  }
  return PLACIDO_OK;
}
