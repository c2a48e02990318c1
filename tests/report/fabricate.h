/* Data made up for the figures' tests, and a look at the pictures that came of them. */
#ifndef PLACIDO_TESTS_REPORT_FABRICATE_H
#define PLACIDO_TESTS_REPORT_FABRICATE_H

#include "report/report.h"

/* Maps of 4.5 mm radius in steps of 0.1 mm, every kind with the values at(x, y); NaN is not
 * supported. Free with fabricate_maps_free. */
placido_maps fabricate_maps(double (*at)(double x_mm, double y_mm));
void fabricate_maps_free(placido_maps *maps);

/* A black frame; free with placido_frame_free. */
placido_frame fabricate_frame(int width_px, int height_px, enum placido_format format);

/* `edges` circles about a point, a point every 2 degrees, every tenth not used; free with
 * free(mires.points). */
placido_mires fabricate_mires(double u_px, double v_px, double spacing_px, int edges);

/* A PSF of n × n buckets with all light in the centre; free with free(psf.values). */
placido_psf fabricate_psf(int n);

/* A picture's colour 0xRRGGBB; a picture without colours is read as MONO8. */
unsigned colour_at(const placido_frame *picture, int x, int y);

#endif
