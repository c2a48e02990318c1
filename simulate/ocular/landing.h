/* Where many rays of a pupil are seen. */
#ifndef PLACIDO_SIMULATE_LANDING_H
#define PLACIDO_SIMULATE_LANDING_H

#include "simulate/ocular/sight.h"
#include "simulate/trace.h"

/* The angles, arcmin from the sight's focus, of rays with these entries; NaN where one does not
 * arrive. */
void placido_landing_angles(float *angle_x, float *angle_y, const placido_sight *sight,
                            const placido_entry *entries, size_t count);

/* The densest place uphill from `peak_arcmin` by the profile of the search of the focus, which it
 * replaces. Points that are NaN are not looked at. */
void placido_landing_climb(double peak_arcmin[2], const float *x, const float *y, size_t count);

/* The middle of (x, y) of those points that lie about (at_x, at_y) in (u, v), weighted with the
 * derivative of that profile. */
void placido_landing_middle(double middle[2], const float *x, const float *y, const float *u,
                            const float *v, size_t count, const double at[2]);

/* Leaves out the points that are NaN; returns how many are left. */
size_t placido_landing_close_up(float *x, float *y, size_t count);

#endif
