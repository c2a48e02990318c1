/* A correcting lens as a prescription writes it. */
#ifndef PLACIDO_REPORT_CORRECTION_H
#define PLACIDO_REPORT_CORRECTION_H

#include <placido/simulate.h>

#define PLACIDO_CORRECTION_SIZE 192

/* "+0.25 D sphere, −1.25 D cylinder × 37°". */
void placido_correction_write(char text[PLACIDO_CORRECTION_SIZE],
                              const placido_correction *correction);

#endif
