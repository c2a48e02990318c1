/* Where every edge is to be expected on every meridian, judged by the numbered ones around it. */
#ifndef PLACIDO_MIRES_FIELD_H
#define PLACIDO_MIRES_FIELD_H

#include <placido/status.h>
#include <stdbool.h>

/* What is numbered of one edge within one sector. */
typedef struct placido_cell {
  int count;
  double ratio;  /* sum of log(radius / ordinary radius) */
  double offset; /* sum of the distances from the sector's middle, in sectors */
} placido_cell;

typedef struct placido_field {
  int edges, meridians, sectors;
  double *ordinary_px; /* radius of every edge in an ordinary cornea, without gaps */
  placido_cell *cells; /* edges × sectors, edge by edge */
  float *log_ratio;    /* expected in each cell; NaN: nothing near it is numbered */
  float *expected_px;  /* edges × meridians */
} placido_field;

/* An empty field. `ordinary_px` (edges, NaN where an ordinary cornea does not mirror the edge) is
 * copied, and continued outwards. Free with placido_field_free. */
int placido_field_new(placido_field *field, int edges, int meridians, const double *ordinary_px,
                      placido_error *err);
void placido_field_free(placido_field *field);

placido_cell *placido_field_cell(const placido_field *field, int edge, int sector);
int placido_field_sector(const placido_field *field, int meridian);

/* Forgets what was numbered. */
void placido_field_clear(placido_field *field);

/* Takes note of a numbered crossing. */
void placido_field_add(placido_field *field, int edge, int meridian, double radius_px);

/* Works out expected_px from the cells: a plane in edge and angle, with a step from rising to
 * falling edges, fitted to the cells around each. */
int placido_field_predict(placido_field *field, placido_error *err);

/* Distance on a meridian from an edge to the nearest other of its polarity, as expected; that of an
 * ordinary cornea where none is. Negative where the cornea would fold the mires. */
double placido_field_period(const placido_field *field, int edge, int meridian);

#endif
