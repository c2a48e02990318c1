/* Nodes of the field: a grid over the picture, at each of which the spread is computed. Between them
 * it is interpolated: each takes its share of every pixel's light, so that there is no seam. */
#ifndef PLACIDO_SIMULATE_NODES_H
#define PLACIDO_SIMULATE_NODES_H

/* Where sample number `at` of a side of the canvas (`size` samples, bleed_px of them at either end)
 * stands among the nodes along it, `nodes` of them, odd: 0 at the first and before, nodes - 1 at the
 * last and beyond; the outermost stand in the corners of what is seen. A node's share along that side
 * is 1 less its distance from that, 0 where it is farther than 1 (a hat function); its weight is the
 * product of both sides' shares, and those of all nodes sum to 1. */
double placido_node_place(int at, int size, int bleed_px, int nodes);

/* The direction from which a node's light comes, degrees in the instrument's frame (ocular.h): what
 * is seen on the patient's right comes from -x, what is seen above from +y. The picture is flat and
 * stands square to the line of sight, which meets its middle: arcmin_per_px holds there. */
void placido_node_field_deg(double field_deg[2], int width_px, int height_px, int bleed_px,
                            double arcmin_per_px, int nodes, int node);

/* The same for any place of such a picture: `right_px` and `down_px` from its middle. */
void placido_field_of_px(double field_deg[2], double right_px, double down_px,
                         double arcmin_per_px);

#endif
