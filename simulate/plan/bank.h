/* The pupils of all nodes of a view, from which the spread of any of them follows for any light and
 * distance. */
#ifndef PLACIDO_SIMULATE_BANK_H
#define PLACIDO_SIMULATE_BANK_H

#include "simulate/plan/view.h"

/* nodes² of them, row by row. */
typedef struct placido_bank {
  int count;
  placido_pupil *pupils;
  double (*field_deg)[2];
  double offset_arcmin[2]; /* fixation, from the chief ray */
} placido_bank;

/* Traces every node's pupil and dims it as the view says. Free with placido_bank_free. PLACIDO_OK,
 * PLACIDO_QUALITY, PLACIDO_MEMORY. */
int placido_bank_new(placido_bank *bank, const placido_view *view, placido_error *err);
void placido_bank_free(placido_bank *bank);

/* The spread at node number `node` of light number `light` from what has defocus_D:
 * settings->buckets a side, values summing to the view's core: the little that lands beyond them is
 * put back among them, so that an even field stays even (what is scattered farther than half a
 * degree is straylight's). Nothing else is filled in. Free with placido_psf_free. Errors as placido_slopes and
 * placido_diffraction. */
int placido_bank_psf(placido_psf *psf, const placido_bank *bank, const placido_view *view,
                     int node, int light, double defocus_D, int threads, placido_error *err);

/* Fills in what such a spread has beside its values. */
void placido_bank_describe(placido_psf *psf, const placido_bank *bank, const placido_view *view,
                           int node, int light);

#endif
