/* Where in a picture effects of the field matter most. */
#ifndef PLACIDO_SIMULATE_ASIDE_H
#define PLACIDO_SIMULATE_ASIDE_H

#include "simulate/effects/effect.h"
#include "simulate/ocular/ocular.h"

/* Direction (ocular.h) of the place off the middle that stands for all others: what turns rays there
 * meets contrast. Returns how much of the scene's contrast that is, or, where nearer places have more
 * of it, as much as they matter: 0 to 1. {0, 0} and 0 where no light differs from any other. */
double placido_aside_deg(double field_deg[2], const placido_question *question);

/* What the retina's curve and the footprint on the cornea do to the question's rays there, `ocular`
 * being what is behind the cornea and retina_mm where its retina stands: their turns, arcmin, less
 * their mean, as pictures are seen straight (bank.c). Returns their root mean square. A ray that does
 * not arrive does not turn: sketches cannot lose rays. */
double placido_aside_turns(float *turn_x, float *turn_y, const placido_question *question,
                           const placido_ocular *ocular, double retina_mm,
                           const double field_deg[2]);

#endif
