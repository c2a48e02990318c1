/* Pieces of HTML that are safe whatever stands in the strings: escaped text, embedded pictures.
 * Write errors are found when the file is committed. */
#ifndef PLACIDO_REPORT_HTML_H
#define PLACIDO_REPORT_HTML_H

#include <placido/status.h>

#include <stdio.h>

/* A string for text and for attributes in double quotes: & < > " ' become references, control
 * characters spaces, and bytes that are not UTF-8 the replacement character. NULL writes
 * nothing. */
void placido_html_text(FILE *stream, const char *text);

/* The same of formatted text of at most 1023 bytes. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void placido_html_print(FILE *stream, const char *format, ...);

/* The size of an embedded picture. */
typedef struct placido_html_size {
  int width_px, height_px;
} placido_html_size;

/* An img element with the PNG file folder/name as data URI. `size` may be NULL. PLACIDO_OK,
 * PLACIDO_SYSTEM (cannot read), PLACIDO_INPUT (no PNG), PLACIDO_MEMORY. */
int placido_html_picture(FILE *stream, placido_html_size *size, const char *folder,
                         const char *name, const char *alternative, placido_error *err);

/* A table row of a heading and a value, both escaped; nothing where the value is NULL or empty. */
void placido_html_row(FILE *stream, const char *heading, const char *value);

#endif
