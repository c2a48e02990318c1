/* A scene cut into layers of one distance each, to be spread one by one and laid behind each
 * other. */
#ifndef PLACIDO_SIMULATE_LAYERS_H
#define PLACIDO_SIMULATE_LAYERS_H

#include "simulate/plan/view.h"

/* Fills view->layers from the scene's depth, for an eye that is focused at focus_D: no layer where
 * all of it is in focus, one where everything stands at one distance, else at most
 * view->settings->layers, far to near: as far from each other as so many would be over the whole
 * range, none where nothing is, one where the eye is focused. Each pixel's covers sum to 1, the
 * farthest layer's being what the others leave: laid behind each other in focus (overlay.h) they
 * are the picture again. Behind edges at which the distance jumps a layer goes on as the nearest
 * pixel in which it can be seen, so that no dark comes from there. What it has put into
 * view->layers is the view's, whatever the status. PLACIDO_OK, PLACIDO_MEMORY, or as
 * placido_scene_canvas_new. */
int placido_layers_fill(placido_view *view, double focus_D, placido_error *err);

#endif
