/* Irregularity in the manner of Klyce's and Wilson's indices (Wilson & Klyce, Arch. Ophthalmol.
 * 109, 349-353, 1991; Maeda, Klyce, Smolek & Thompson, Invest. Ophthalmol. Vis. Sci. 35, 2749-2757,
 * 1994). Their weights and scales are not published: these are our own, and so are the names. */
#include "reconstruct/indices/cornea.h"

#include <math.h>

#define HALF (PLACIDO_AZIMUTHS / 2)

/* Asymmetry: rings at 0.3 to 0.9 mm, four as there, the inner ones weighing more. */
#define SAI_FIRST_RING 1
#define SAI_RINGS 4
static const double sai_weights[SAI_RINGS] = {0.4, 0.3, 0.2, 0.1};

/* Fluctuation: ten rings, the central 4.4 mm. */
#define SRI_FIRST_RING 1
#define SRI_LAST_RING 10

/* A mean of the values that are there. */
struct mean {
  double sum, weight;
};

static void add(struct mean *mean, double value, double weight) {
  if (isfinite(value)) {
    mean->sum += weight * fabs(value);
    mean->weight += weight;
  }
}

static double asymmetry(const placido_cornea *cornea) {
  struct mean mean = {0};
  for (int i = 0; i < SAI_RINGS; i++) {
    const double *power = cornea->axial_D[SAI_FIRST_RING + i];
    for (int a = 0; a < HALF; a++) {
      add(&mean, power[a] - power[a + HALF], sai_weights[i]);
    }
  }
  return mean.sum / mean.weight;
}

static double fluctuation(const placido_cornea *cornea) {
  struct mean mean = {0};
  for (int ring = SRI_FIRST_RING + 1; ring < SRI_LAST_RING; ring++) {
    for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
      double beside = (cornea->axial_D[ring - 1][a] + cornea->axial_D[ring + 1][a]) / 2;
      add(&mean, cornea->axial_D[ring][a] - beside, 1);
    }
  }
  return mean.sum / mean.weight;
}

static double variation(const placido_cornea *cornea) {
  struct mean mean = {0};
  for (int ring = 0; ring < PLACIDO_RINGS - 1; ring++) {
    double weight = placido_ring_area(ring, 0, PLACIDO_ZONE_MAX_MM) +
                    placido_ring_area(ring + 1, 0, PLACIDO_ZONE_MAX_MM);
    for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
      add(&mean, cornea->axial_D[ring + 1][a] - cornea->axial_D[ring][a], weight);
    }
  }
  return mean.sum / mean.weight;
}

static void measure(placido_cornea *cornea) {
  cornea->sai_D = asymmetry(cornea);
  cornea->sri_D = fluctuation(cornea);
  cornea->iai_D = variation(cornea);
}

static double sai(const placido_cornea *cornea) {
  return cornea->sai_D;
}

static double sri(const placido_cornea *cornea) {
  return cornea->sri_D;
}

static double iai(const placido_cornea *cornea) {
  return cornea->iai_D;
}

static const placido_index_row rows[] = {
    {.name = "sai_like_D",
     .unit = "D",
     .help = "Surface asymmetry, like the SAI: mean difference of axial power between opposite "
             "points on 128 meridians at 0.3, 0.5, 0.7 and 0.9 mm, weighted 4:3:2:1. Noise adds to "
             "it.",
     .zone_mm = 2,
     .at = sai},
    {.name = "sri_like_D",
     .unit = "D",
     .help =
         "Surface irregularity, like the SRI: mean distance of axial power from the mean of its "
         "neighbours 0.2 mm inwards and outwards, on 256 semi-meridians within 4.4 mm. Noise "
         "adds to it.",
     .zone_mm = 4.4,
     .at = sri},
    {.name = "iai_like_D",
     .unit = "D",
     .help = "Irregular astigmatism, like the IAI: area-weighted mean change of axial power over "
             "0.2 mm along 256 semi-meridians within 8 mm. Noise adds to it.",
     .zone_mm = 8,
     .at = iai},
};

const placido_index_group placido_regularity_group = {measure, rows, sizeof rows / sizeof rows[0]};
