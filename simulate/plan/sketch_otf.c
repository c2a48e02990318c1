/* The optical transfer function of a sketch: every ray's phase is found at a low frequency and
 * doubled from octave to octave. Sums run in lanes of a fixed number, so that they do not depend on
 * how wide the processor's vectors are. */
#include "base/dispatch.h"
#include "simulate/eye.h"
#include "simulate/plan/sketch.h"

#include <math.h>
#include <stddef.h>

enum {
  LANES = PLACIDO_SKETCH_LANES,
  ROOM = PLACIDO_SKETCH_ROOM,
  SEEDS = 2,         /* half octaves within an octave */
  QUIET_OCTAVES = 2, /* doublings from where phases are found to the first frequency that counts */
  OCTAVES = (PLACIDO_SKETCH_FREQUENCIES + SEEDS - 1) / SEEDS
};

static const double pi = 3.14159265358979323846;
static const double first_cpd = 0.125;
static const double angle_max_arcmin = 600; /* beyond it a ray's light is even light */
static const double usual_wavelength_nm = 555;

double placido_sketch_frequency_cpd(int index) {
  const double half_octave = 1.41421356237309504880;
  return first_cpd * (double)(1 << index / 2) * (index % 2 != 0 ? half_octave : 1);
}

/* One wave's rays along one direction, at a seed's frequency. */
typedef struct wave_rays {
  float angle[ROOM];    /* arcmin */
  float around2[ROOM], outwards2[ROOM]; /* squared changes of the angle across a ray's cell */
  float weight[ROOM];   /* of the light */
  float area[ROOM];     /* of the pupil */
  float rim_mm[ROOM];
} wave_rays;

/* Overlap of the pupil with itself shifted: how far rays must be from the rim at 1 cycle/degree,
 * and how gradually they drop out. By rays none does: a start of 1. */
typedef struct overlap {
  float rim_mm_per_cpd;
  float per_mm, start;
} overlap;

typedef struct phasor {
  float c[ROOM], s[ROOM];
} phasor;

/* Sums over rays: of phasors, and of the pupil's area that counts. */
typedef struct sums {
  float re, im, area;
} sums;

/* Phases at `cycles_per_arcmin`, which is low: Taylor's series, exact to 1e-6 for a radian. */
PLACIDO_WIDE static void seed(phasor *restrict p, const wave_rays *restrict rays,
                              float cycles_per_arcmin) {
  const float turn = (float)(2 * pi) * cycles_per_arcmin;
  for (int i = 0; i < ROOM; i++) {
    float t = turn * rays->angle[i], t2 = t * t;
    p->c[i] = 1 - t2 / 2 * (1 - t2 / 12 * (1 - t2 / 30 * (1 - t2 / 56)));
    p->s[i] = t * (1 - t2 / 6 * (1 - t2 / 20 * (1 - t2 / 42)));
  }
}

/* To twice the frequency. */
PLACIDO_WIDE static void redouble(phasor *restrict p) {
  for (int i = 0; i < ROOM; i++) {
    float c = p->c[i], s = p->s[i];
    p->c[i] = c * c - s * s;
    p->s[i] = 2 * c * s;
  }
}

/* To 0 to 1; compilers make branches of comparisons here. */
PLACIDO_INSIDE float clamped(float value) {
  return 0.5f * (fabsf(value) + 1 - fabsf(value - 1));
}

/* How much a ray counts for its cell, across which its phase turns sqrt(turns2) times: all where
 * the quadrature is good, nothing where one ray cannot stand for a whole turn. */
PLACIDO_INSIDE float followed(float turns2) {
  const float all = 0.2f;
  float kept = clamped((1 - turns2) * (1 / (1 - all)));
  return kept * kept;
}

/* The lanes' sum, in pairs. */
PLACIDO_INSIDE float gather(const float lanes[LANES]) {
  float eight[8], four[4];
  for (int i = 0; i < 8; i++) {
    eight[i] = lanes[i] + lanes[i + 8];
  }
  for (int i = 0; i < 4; i++) {
    four[i] = eight[i] + eight[i + 4];
  }
  return (four[0] + four[2]) + (four[1] + four[3]);
}

/* The sums over rays at `cpd`, and the phases at twice that. */
PLACIDO_INSIDE sums add_up(phasor *restrict p, const wave_rays *restrict rays, const overlap *over,
                           float cpd) {
  float re[LANES] = {0}, im[LANES] = {0}, area[LANES] = {0};
  const float half = over->rim_mm_per_cpd * cpd, steep = over->per_mm, square = cpd * cpd / 3600;
  for (int block = 0; block < ROOM; block += LANES) {
    for (int lane = 0; lane < LANES; lane++) {
      int i = block + lane;
      float c = p->c[i], s = p->s[i];
      float share = clamped((rays->rim_mm[i] - half) * steep + over->start);
      float seen = rays->weight[i] * share * followed(square * rays->around2[i]) *
                   followed(square * rays->outwards2[i]);
      re[lane] += seen * c;
      im[lane] += seen * s;
      area[lane] += rays->area[i] * share;
      p->c[i] = c * c - s * s;
      p->s[i] = 2 * c * s;
    }
  }
  return (sums){gather(re), gather(im), gather(area)};
}

/* The same at `first_cpd`, twice that, and so on. */
PLACIDO_WIDE static void add_octaves(sums octaves[OCTAVES], phasor *restrict p,
                                     const wave_rays *restrict rays, const overlap *over,
                                     float from_cpd) {
  for (int octave = 0; octave < OCTAVES; octave++) {
    octaves[octave] = add_up(p, rays, over, from_cpd * (float)(1 << octave));
  }
}

/* Of a round pupil without aberrations; `frequency` relative to the cut-off. */
static float diffraction_mtf(float frequency) {
  if (!(frequency < 1)) {
    return 0;
  }
  return (float)(2 / pi) * (acosf(frequency) - frequency * sqrtf(1 - frequency * frequency));
}

/* The rays along one direction. */
typedef struct line {
  const placido_sketch *sketch;
  const placido_strokes *strokes;
  int direction;
  double cosine, sine;
  wave_rays rays;        /* before any wave */
  float around[ROOM], outwards[ROOM]; /* changes of the angle across the cells */
  float mtf[PLACIDO_SKETCH_FREQUENCIES]; /* of the aperture */
} line;

static double sinc(double x) { return fabs(x) < 1e-6 ? 1 : sin(pi * x) / (pi * x); }

static void find_aperture(line *l) {
  double width_deg = l->strokes->aperture_arcmin / 60;
  for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
    double turns = placido_sketch_frequency_cpd(k) * width_deg;
    l->mtf[k] = width_deg > 0 ? (float)(sinc(turns * l->cosine) * sinc(turns * l->sine)) : 1;
  }
}

static void find_line(line *l, const placido_sketch *sketch, const placido_strokes *strokes,
                      int direction) {
  const placido_sketch_rays *rays = &sketch->rays;
  const double angle_rad = placido_sketch_direction_deg(direction) * pi / 180;
  *l = (line){.sketch = sketch, .strokes = strokes, .direction = direction,
              .cosine = cos(angle_rad), .sine = sin(angle_rad)};
  const float c = (float)l->cosine, s = (float)l->sine;
  for (int i = 0; i < rays->count; i++) {
    float x = rays->angle_x[i] + (strokes->turns ? strokes->angle_x[i] : 0);
    float y = rays->angle_y[i] + (strokes->turns ? strokes->angle_y[i] : 0);
    l->rays.angle[i] = c * x + s * y;
    l->rays.area[i] = rays->weight[i];
    l->rays.weight[i] = rays->weight[i] * (strokes->dims ? strokes->weight[i] : 1);
    l->rays.rim_mm[i] = l->sketch->rim_mm[l->direction][i];
  }
  for (int i = 0; i < rays->count; i++) {
    const placido_sketch_cell *cell = &l->sketch->cells[i];
    const float *angle = l->rays.angle;
    l->around[i] = (angle[cell->after] - angle[cell->before]) * cell->around;
    l->outwards[i] = (angle[cell->outer] - angle[cell->inner]) * cell->outwards;
  }
  find_aperture(l);
}

/* More power bends a ray from +x towards -x: where it is seen moves in proportion to its place. */
PLACIDO_WIDE static void defocus(wave_rays *restrict rays, const line *restrict l,
                                double power_D, double shift) {
  const float turn = (float)(-1e-3 * power_D / PLACIDO_ARCMIN_RAD), moved = (float)shift;
  const float most = (float)angle_max_arcmin;
  const float *place = l->sketch->place_mm[l->direction];
  const float *around_mm = l->sketch->around_mm[l->direction];
  const float *outwards_mm = l->sketch->outwards_mm[l->direction];
  for (int i = 0; i < ROOM; i++) {
    float angle = l->rays.angle[i] + turn * place[i] + moved;
    float around = l->around[i] + turn * around_mm[i];
    float outwards = l->outwards[i] + turn * outwards_mm[i];
    angle = angle < most ? angle : most;
    rays->angle[i] = angle > -most ? angle : -most;
    rays->around2[i] = around * around;
    rays->outwards2[i] = outwards * outwards;
    rays->weight[i] = l->rays.weight[i];
    rays->area[i] = l->rays.area[i];
    rays->rim_mm[i] = l->rays.rim_mm[i];
  }
}

/* A wave, and what its diffraction makes of the pupil. */
typedef struct wave_overlap {
  const placido_wave *wave;
  overlap over;
  bool diffracts;
  float mtf[PLACIDO_SKETCH_FREQUENCIES];
} wave_overlap;

/* How the logarithm of what rays count falls with the squared distance from the pupil's middle: a
 * line fitted to it, per mm². */
static double dimming_per_mm2(const placido_sketch_rays *rays, const placido_strokes *strokes) {
  double square = 0, logarithm = 0, both = 0, fourth = 0;
  for (int i = 0; i < rays->count && strokes->dims; i++) {
    double x = (double)rays->x_mm[i], y = (double)rays->y_mm[i], weight = (double)rays->weight[i];
    double r2 = x * x + y * y, dims = log(fmax((double)strokes->weight[i], 1e-6));
    square += weight * r2;
    fourth += weight * r2 * r2;
    logarithm += weight * dims;
    both += weight * r2 * dims;
  }
  double variance = fourth - square * square;
  return variance > 0 ? (both - square * logarithm) / variance : 0;
}

/* A pupil that is dimmed like a Gaussian overlaps with itself, shifted by s, like one dimmed so
 * where both overlap, times what the dimming comes to at s / 2 from its peak. */
static void find_overlap(wave_overlap *o, const placido_wave *wave, const placido_strokes *strokes,
                         double pupil_mm, double dimming) {
  const double lambda_mm_per_cpd = wave->wavelength_nm * 1e-6 * 180 / pi;
  const double rings = 2 * PLACIDO_SKETCH_RINGS;
  *o = (wave_overlap){.wave = wave, .diffracts = strokes->waves, .over = {.start = 1}};
  if (strokes->waves) {
    o->over = (overlap){(float)(lambda_mm_per_cpd / 2), (float)(rings / pupil_mm), 0.5f};
    for (int k = 0; k < PLACIDO_SKETCH_FREQUENCIES; k++) {
      double frequency = lambda_mm_per_cpd / pupil_mm * placido_sketch_frequency_cpd(k);
      double half_mm = 0.5 * frequency * pupil_mm;
      o->mtf[k] = diffraction_mtf((float)frequency) * (float)exp(dimming * half_mm * half_mm);
    }
  }
}

/* Adds a wave's transfer along a line, times its weight. */
static void add_wave(float *re, float *im, const line *l, const wave_overlap *o) {
  const placido_strokes *strokes = l->strokes;
  const placido_wave *wave = o->wave;
  double power_D = wave->defocus_D + strokes->defocus_D;
  double shift = l->cosine * (wave->x_arcmin + strokes->shift_x_arcmin * wave->defocus_D) +
                 l->sine * (wave->y_arcmin + strokes->shift_y_arcmin * wave->defocus_D);
  sums octaves[OCTAVES];
  wave_rays rays;
  phasor p;
  defocus(&rays, l, power_D, shift);
  for (int half = 0; half < SEEDS; half++) {
    double from_cpd = placido_sketch_frequency_cpd(half);
    seed(&p, &rays, (float)(from_cpd / (1 << QUIET_OCTAVES) / 60));
    for (int quiet = 0; quiet < QUIET_OCTAVES; quiet++) {
      redouble(&p);
    }
    add_octaves(octaves, &p, &rays, &o->over, (float)from_cpd);
    for (int k = half; k < PLACIDO_SKETCH_FREQUENCIES; k += SEEDS) {
      sums sum = octaves[k / SEEDS];
      float scale = (float)wave->weight * l->mtf[k];
      if (o->diffracts) {
        scale *= sum.area > 0 ? o->mtf[k] / sum.area : 0;
      }
      re[k] += scale * sum.re;
      im[k] += scale * sum.im;
    }
  }
}

void placido_sketch_transfer(placido_sketch_otf *otf, const placido_sketch *sketch,
                             const placido_strokes *strokes) {
  const placido_sketch_light plain = {1, {{.wavelength_nm = usual_wavelength_nm, .weight = 1}}};
  const double dimming = strokes->waves ? dimming_per_mm2(&sketch->rays, strokes) : 0;
  line lines[PLACIDO_SKETCH_DIRECTIONS];
  *otf = (placido_sketch_otf){.lights = strokes->lights > 0 ? strokes->lights : 1};
  for (int direction = 0; direction < PLACIDO_SKETCH_DIRECTIONS; direction++) {
    find_line(&lines[direction], sketch, strokes, direction);
  }
  for (int light = 0; light < otf->lights; light++) {
    const placido_sketch_light *of = strokes->lights > 0 ? &strokes->light[light] : &plain;
    for (int wave = 0; wave < of->count; wave++) {
      wave_overlap o;
      find_overlap(&o, &of->waves[wave], strokes, sketch->pupil_mm, dimming);
      for (int direction = 0; direction < PLACIDO_SKETCH_DIRECTIONS; direction++) {
        add_wave(otf->re[light][direction], otf->im[light][direction], &lines[direction], &o);
      }
    }
  }
}
