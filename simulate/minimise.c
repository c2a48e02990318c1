/* Downhill simplex: Nelder and Mead, Computer Journal 7 (1965) 308, with the usual coefficients
 * (reflect 1, expand 2, contract 1/2, shrink 1/2). */
#include "simulate/minimise.h"

#include <math.h>
#include <string.h>

typedef struct corner {
  double at[PLACIDO_MINIMISE_MAX], value;
} corner;

typedef struct simplex {
  placido_objective *objective;
  void *user;
  int count, calls;
  corner corners[PLACIDO_MINIMISE_MAX + 1]; /* sorted, the best first */
} simplex;

static void evaluate(simplex *s, corner *c) {
  c->value = s->objective(s->user, c->at);
  s->calls++;
}

static void sort(simplex *s) {
  for (int i = 1; i <= s->count; i++) {
    corner moving = s->corners[i];
    int j = i;
    for (; j > 0 && s->corners[j - 1].value > moving.value; j--) {
      s->corners[j] = s->corners[j - 1];
    }
    s->corners[j] = moving;
  }
}

static double spread(const simplex *s) {
  double widest = 0;
  for (int i = 1; i <= s->count; i++) {
    for (int k = 0; k < s->count; k++) {
      widest = fmax(widest, fabs(s->corners[i].at[k] - s->corners[0].at[k]));
    }
  }
  return widest;
}

/* The point on the line from the worst corner through the others' middle: `way` -1 the worst
 * corner itself, 0 the middle, 1 its mirror image. */
static corner beyond(simplex *s, double way) {
  corner c = {0};
  for (int k = 0; k < s->count; k++) {
    double middle = 0;
    for (int i = 0; i < s->count; i++) {
      middle += s->corners[i].at[k] / s->count;
    }
    c.at[k] = middle + way * (middle - s->corners[s->count].at[k]);
  }
  evaluate(s, &c);
  return c;
}

static void shrink(simplex *s) {
  for (int i = 1; i <= s->count; i++) {
    for (int k = 0; k < s->count; k++) {
      s->corners[i].at[k] = (s->corners[i].at[k] + s->corners[0].at[k]) / 2;
    }
    evaluate(s, &s->corners[i]);
  }
}

static void step_downhill(simplex *s) {
  corner *worst = &s->corners[s->count];
  corner mirrored = beyond(s, 1);
  if (mirrored.value < s->corners[0].value) {
    corner farther = beyond(s, 2);
    *worst = farther.value < mirrored.value ? farther : mirrored;
  } else if (mirrored.value < s->corners[s->count - 1].value) {
    *worst = mirrored;
  } else {
    corner nearer = beyond(s, mirrored.value < worst->value ? 0.5 : -0.5);
    if (nearer.value < fmin(mirrored.value, worst->value)) {
      *worst = nearer;
    } else {
      shrink(s);
    }
  }
}

double placido_minimise(placido_objective *objective, void *user, double *at, int count,
                        double step, double tolerance, int calls) {
  simplex s = {.objective = objective, .user = user, .count = count};
  for (int i = 0; i <= count; i++) {
    memcpy(s.corners[i].at, at, (size_t)count * sizeof *at);
    if (i > 0) {
      s.corners[i].at[i - 1] += step;
    }
    evaluate(&s, &s.corners[i]);
  }
  sort(&s);
  while (s.calls < calls && spread(&s) > tolerance) {
    step_downhill(&s);
    sort(&s);
  }
  memcpy(at, s.corners[0].at, (size_t)count * sizeof *at);
  return s.corners[0].value;
}
