/* The colours of dioptres. */
#ifndef PLACIDO_EXCHANGE_COLOUR_H
#define PLACIDO_EXCHANGE_COLOUR_H

/* Red, green and blue, 0 to 1: blue at 30 D and less, over cyan, green at 45 D and yellow, to red
 * at 60 D and more, as topographers draw steep corneas warm; grey where power_D is NaN. */
void placido_power_colour(double colour[3], double power_D);

#endif
