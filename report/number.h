/* Numbers and units as people read them. */
#ifndef PLACIDO_REPORT_NUMBER_H
#define PLACIDO_REPORT_NUMBER_H

#include <stddef.h>

/* Enough for any number that this page or figure writes. */
#define PLACIDO_NUMBER_SIZE 64

/* Writes a number with a true minus sign; "–" where it is not finite. */
void placido_number_write(char *text, size_t size, double value, int decimals);

/* With as many decimals as give this many significant digits, none where that many stand before
 * the point. */
void placido_number_significant(char *text, size_t size, double value, int digits);

/* "43.27 ± 0.02": two significant digits of the standard deviation set the decimals; without one
 * (NaN or 0) the value has four significant digits. No more than five decimals: below that
 * "100.00000 ± <0.00001". */
void placido_number_measure(char *text, size_t size, double value, double sigma);

/* A unit as it is written for people: "um" becomes "µm", "mm^-2" becomes "mm⁻²", "deg" becomes "°";
 * any other stays. Borrowed: the argument or a constant. */
const char *placido_unit_text(const char *unit);

#endif
