/* A text file line by line, with messages that name the place. */
#ifndef PLACIDO_EXCHANGE_TEXT_H
#define PLACIDO_EXCHANGE_TEXT_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

typedef struct placido_reader {
  char *text, *end; /* the whole file; lines are cut out of it in place */
  char *next;
  const char *path;
  int line; /* of the one given last, from 1 */
} placido_reader;

/* Reads the file; refuses what is no text. End with placido_reader_close, whatever the status. */
int placido_reader_open(placido_reader *reader, const char *path, placido_error *err);
void placido_reader_close(placido_reader *reader);

/* The next line without its ending and the blanks around it, borrowed; NULL after the last. */
char *placido_reader_next(placido_reader *reader);

/* "FILE:LINE: " and the formatted text; returns PLACIDO_INPUT. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int placido_reader_refuse(const placido_reader *reader, placido_error *err, const char *format,
                          ...);

/* Cuts the blanks off both ends, in place; the result lies within `text`. */
char *placido_text_trim(char *text);

/* Reads a text that is one decimal number and nothing else, with a decimal point or, where
 * `comma`, a comma. */
bool placido_text_number(const char *text, bool comma, double *value);

#endif
