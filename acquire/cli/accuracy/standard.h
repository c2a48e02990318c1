/* The accuracy table that the program brings along, as the bytes of standard.csv: the build makes
 * the source of it (cmake/EmbedFile.cmake). */
#ifndef PLACIDO_CLI_ACCURACY_STANDARD_H
#define PLACIDO_CLI_ACCURACY_STANDARD_H

extern const unsigned char accuracy_standard_csv[]; /* ends with a zero byte */

#endif
