/* What `placido bench effects` finds about one eye before one scene. */
#ifndef PLACIDO_CLI_BENCH_EFFECTS_H
#define PLACIDO_CLI_BENCH_EFFECTS_H

#include <placido/plan.h>

#define BENCH_TOLERANCES 3
#define BENCH_LISTED 512

extern const double bench_tolerances[BENCH_TOLERANCES];

/* Who looks at what. */
struct bench_look {
  const char *scene_name, *eye_name;
  const placido_scene *scene;
  const placido_surface *surface;
  double pupil_mm; /* 0: what the luminance gives */
  int threads;
  bool quick; /* everything on is coarse, too */
};

/* A plan for one tolerance. */
struct bench_planned {
  double difference;       /* from everything on, up to white */
  double planned_s, asking_s, everything_s; /* processor time; asking: wall time */
  bool ran[PLACIDO_EFFECTS_MAX], applies[PLACIDO_EFFECTS_MAX];
  double bound[PLACIDO_EFFECTS_MAX];
  double worth[PLACIDO_EFFECTS_MAX]; /* everything on against everything but this; NaN: not in it */
};

/* Plans for the first `count` tolerances and everything on, seen and compared. */
int bench_look_at(struct bench_planned planned[BENCH_TOLERANCES], const struct bench_look *look,
                  size_t count, placido_error *err);

#endif
