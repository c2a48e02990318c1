/* How much of a rectangle a disc covers. */
#ifndef PLACIDO_SIMULATE_QUALITY_DISC_H
#define PLACIDO_SIMULATE_QUALITY_DISC_H

/* Area of the rectangle x0 <= x <= x1, y0 <= y <= y1 within the disc of this radius about the
 * origin, exactly. */
double placido_disc_area(double radius, double x0, double x1, double y0, double y1);

#endif
