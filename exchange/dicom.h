/* What a Corneal Topography Map says, before it is written down. */
#ifndef PLACIDO_EXCHANGE_DICOM_H
#define PLACIDO_EXCHANGE_DICOM_H

#include "exchange/uid.h"

#include <placido/dicom.h>
#include <placido/map.h>
#include <stdio.h>

/* Stored values of the picture: 0 is no data, k the power POWER_LEAST_D + k POWER_STEP_D. */
#define PLACIDO_DICOM_LEVELS 4096
#define PLACIDO_DICOM_STEP_D 0.02
#define PLACIDO_DICOM_LEAST_D 10.0

/* Radius of a pupil that nobody measured, mm: DICOM demands one. */
#define PLACIDO_DICOM_PUPIL_MM 2.0

/* A pixel's size. It is no square, as an image of this kind must give its aspect ratio, and one of
 * 1:1 must not be given (PS3.3, C.8.30.2 and C.7.6.3.1.7). */
#define PLACIDO_DICOM_PIXEL_X_MM 0.02
#define PLACIDO_DICOM_PIXEL_Y_MM 0.025
#define PLACIDO_DICOM_ASPECT "5\\4"

/* Names of the files beside the dump. */
#define PLACIDO_DICOM_PIXELS "pixels.raw"
extern const char *const placido_dicom_palettes[3]; /* red, green, blue */

/* The figures of the whole cornea that DICOM has a place for. */
typedef struct placido_dicom_figures {
  double flat_D, flat_deg, steep_D, steep_deg, least_D, least_deg;
  double average_D, inferior_superior_D, area_mm2;
  double peak_D, peak_mm[2];      /* greatest tangential power; NaN: not known */
  double eccentricity, kpi;       /* NaN: not known */
  double vertex_mm[3];            /* of the corneal vertex */
} placido_dicom_figures;

enum placido_dicom_uid {
  PLACIDO_DICOM_STUDY, PLACIDO_DICOM_SERIES, PLACIDO_DICOM_INSTANCE, PLACIDO_DICOM_FRAME,
  PLACIDO_DICOM_SOURCE, PLACIDO_DICOM_UIDS
};

typedef struct placido_dicom_map {
  const placido_dicom_info *info;
  placido_dicom_figures figures;
  placido_maps points;      /* that are listed */
  double *wavefront_um;     /* at each of them; NaN where there is none */
  int columns, rows;        /* of the picture */
  double centre_px[2];      /* of the vertex: column, row */
  char uids[PLACIDO_DICOM_UIDS][PLACIDO_UID_SIZE];
  char date[9], time[7];
} placido_dicom_map;

/* Fills points, wavefront_um and figures; PLACIDO_QUALITY where one that DICOM demands is not
 * known. */
int placido_dicom_measure(placido_dicom_map *map, const placido_surface *surface, double step_mm,
                          placido_error *err);

/* Writes the data set as dump2dcm reads it. */
void placido_dicom_dump(FILE *stream, const placido_dicom_map *map);

#endif
