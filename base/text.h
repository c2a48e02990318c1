/* Text that goes to a person as one line. */
#ifndef PLACIDO_BASE_TEXT_H
#define PLACIDO_BASE_TEXT_H

#include <stdio.h>

/* Makes `text` one clean line in place: control characters become spaces, and a UTF-8 character
 * that was cut off at the end by a full buffer is removed. */
void placido_text_line(char *text);

/* Writes `text` in quotes as CSV has it (RFC 4180), on one line: control characters become spaces. */
void placido_text_quote(FILE *stream, const char *text);

/* The end of a path, short enough to stand in a message; borrowed from `path`. */
const char *placido_text_tail(const char *path);

#endif
