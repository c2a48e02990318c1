/* Sector indices and the keratoconus prediction index (Maeda, Klyce, Smolek & Thompson, Invest.
 * Ophthalmol. Vis. Sci. 35, 2749-2757, 1994): eight sectors of 45 degrees, turned in steps of
 * 360/256 degrees, mean powers by area. */
#include "reconstruct/indices/cornea.h"

#include <math.h>

#define SECTOR (PLACIDO_AZIMUTHS / 8)
#define HALF (PLACIDO_AZIMUTHS / 2)

/* Mean power of the sector that begins at azimuth `first`; NaN where too little is supported. */
static double sector_mean(const placido_cornea *cornea, int first) {
  double power = 0, supported = 0, area = 0;
  for (int ring = 0; ring < PLACIDO_RINGS; ring++) {
    double weight = placido_ring_area(ring, 0, PLACIDO_ZONE_MAX_MM);
    power += weight * placido_arcs_sum(&cornea->power, ring, first, first + SECTOR);
    supported += weight * placido_arcs_sum(&cornea->layout->support, ring, first, first + SECTOR);
    area += weight * SECTOR;
  }
  return supported >= PLACIDO_SHARE_MIN * area ? power / supported : NAN;
}

/* A sector that is missing might be the extreme one: then there is no figure. */
static void measure(placido_cornea *cornea) {
  double mean[PLACIDO_AZIMUTHS];
  for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
    mean[a] = sector_mean(cornea, a);
  }
  cornea->dsi_D = cornea->osi_D = 0;
  for (int turn = 0; turn < SECTOR; turn++) {
    double least = INFINITY, most = -INFINITY;
    for (int a = turn; a < PLACIDO_AZIMUTHS; a += SECTOR) {
      double opposite = fabs(mean[a] - mean[(a + HALF) % PLACIDO_AZIMUTHS]);
      cornea->osi_D = cornea->osi_D >= opposite ? cornea->osi_D : opposite;
      least = least <= mean[a] ? least : mean[a];
      most = most >= mean[a] ? most : mean[a];
    }
    cornea->dsi_D = cornea->dsi_D >= most - least ? cornea->dsi_D : most - least;
  }
  for (int a = 0; a < PLACIDO_AZIMUTHS; a++) {
    if (isnan(mean[a])) {
      cornea->dsi_D = cornea->osi_D = NAN;
    }
  }
  cornea->csi_D = placido_cornea_mean(cornea, 0, 3) - placido_cornea_mean(cornea, 3, 6);
}

static double dsi(const placido_cornea *cornea) {
  return cornea->dsi_D;
}

static double osi(const placido_cornea *cornea) {
  return cornea->osi_D;
}

static double csi(const placido_cornea *cornea) {
  return cornea->csi_D;
}

static double analysed(const placido_cornea *cornea) {
  return 100 * cornea->layout->analysed;
}

static double kpi(const placido_cornea *cornea) {
  return 0.30 + 0.01 * (-41.23 - 0.15 * cornea->dsi_D + 1.18 * cornea->osi_D +
                        1.49 * cornea->csi_D + 4.13 * cornea->sai_D - 0.56 * cornea->simk.steep_D +
                        1.08 * cornea->simk.across_steep_D - 3.74 * cornea->iai_D +
                        0.10 * analysed(cornea));
}

static const placido_index_row rows[] = {
    {.name = "dsi_D",
     .unit = "D",
     .help = "Differential sector index: greatest difference of area-weighted mean axial power "
             "between any two of eight sectors of the central 8 mm (Maeda et al. 1994). Needs 70 % "
             "of every sector.",
     .zone_mm = 8,
     .at = dsi},
    {.name = "osi_D",
     .unit = "D",
     .help = "Opposite sector index: as dsi_D, between opposite sectors.",
     .zone_mm = 8,
     .at = osi},
    {.name = "csi_D",
     .unit = "D",
     .help = "Centre/surround index: area-weighted mean axial power of the central 3 mm less that "
             "of the annulus from 3 to 6 mm (Maeda et al. 1994).",
     .zone_mm = 6,
     .at = csi},
    {.name = "analysed_area_percent",
     .unit = "%",
     .help = "Share of the fitted disc that data support. It is what was measured, and exactly "
             "known.",
     .at = analysed},
    {.name = "kpi",
     .unit = "",
     .help = "Keratoconus prediction index: 0.30 + 0.01 (-41.23 - 0.15 DSI + 1.18 OSI + 1.49 CSI + "
             "4.13 SAI - 0.56 SimK1 + 1.08 SimK2 - 3.74 IAI + 0.10 AA) (Maeda et al. 1994), SimK1 "
             "the steepest meridian and SimK2 across it, but SAI and IAI our own: a guide, not "
             "their figure. There, below 0.23 is no keratoconus, from 0.30 it is.",
     .zone_mm = 8,
     .at = kpi},
};

const placido_index_group placido_sector_group = {measure, rows, sizeof rows / sizeof rows[0]};
