/* Mean powers of zones, with the area weights of ISO 19980 (annex C). */
#include "reconstruct/indices/cornea.h"

#define FIRST_RING 1 /* at 0.3, 0.5 and 0.7 mm: rings 2 to 4 of the TMS */
#define LAST_RING 3

static void measure(placido_cornea *cornea) {
  double sum = 0;
  for (int ring = FIRST_RING; ring <= LAST_RING; ring++) {
    sum += cornea->power.before[ring][PLACIDO_AZIMUTHS] /
           cornea->layout->support.before[ring][PLACIDO_AZIMUTHS];
  }
  cornea->central_k_D = sum / (LAST_RING - FIRST_RING + 1);
}

static double central_k(const placido_cornea *cornea) {
  return cornea->central_k_D;
}

static double central_zone(const placido_cornea *cornea) {
  return placido_cornea_mean(cornea, 0, 3);
}

static double middle_zone(const placido_cornea *cornea) {
  return placido_cornea_mean(cornea, 3, 6);
}

static double outer_zone(const placido_cornea *cornea) {
  return placido_cornea_mean(cornea, 6, 8);
}

static const placido_index_row rows[] = {
    {.name = "central_k_D",
     .unit = "D",
     .help = "Central keratometry: mean axial power of the circles of radius 0.3, 0.5 and 0.7 mm, "
             "which are rings 2 to 4 of the TMS (Rabinowitz, Surv. Ophthalmol. 42, 297-319, 1998). "
             "Suspect over 47.2 D.",
     .zone_mm = 1.6,
     .at = central_k},
    {.name = "mean_axial_0_3mm_D",
     .unit = "D",
     .help = "Area-weighted mean axial power of the central zone, 3 mm in diameter (ISO 19980).",
     .zone_mm = 3,
     .at = central_zone},
    {.name = "mean_axial_3_6mm_D",
     .unit = "D",
     .help = "Area-weighted mean axial power of the middle zone, 3 to 6 mm in diameter.",
     .zone_mm = 6,
     .at = middle_zone},
    {.name = "mean_axial_6_8mm_D",
     .unit = "D",
     .help = "Area-weighted mean axial power of the outer zone, 6 to 8 mm in diameter.",
     .zone_mm = 8,
     .at = outer_zone},
};

const placido_index_group placido_power_group = {measure, rows, sizeof rows / sizeof rows[0]};
