/* Command-line options as data: a table row says how an option is called, what it means and where
 * its value goes. */
#ifndef PLACIDO_CLI_OPTIONS_H
#define PLACIDO_CLI_OPTIONS_H

#include <placido/status.h>
#include <stdbool.h>
#include <stddef.h>

/* A status of the program beside the libraries': the command line is wrong. */
#define STATUS_USAGE 1

#define LIST_MAX 16

/* Values separated by commas. */
struct number_list {
  size_t count;
  double values[LIST_MAX];
};

/* Values of an option that may stand several times; borrowed from argv. */
struct text_list {
  size_t count;
  const char *values[LIST_MAX];
};

struct option_row {
  const char *name;  /* without its dashes */
  char letter;       /* 0 for none */
  const char *value; /* what the help calls its value; NULL for a switch. With a space in it, and
                        not in quotes: two words, which `parse` gets with one space in between;
                        `text` then lasts no longer than the call */
  const char *help;  /* meaning, unit and default */
  size_t offset;     /* of the field in struct settings */
  /* Reads `text` into the field; STATUS_USAGE with a sentence where it cannot. */
  int (*parse)(void *field, const struct option_row *row, const char *text, placido_error *err);
  double min, max; /* of numbers; of lists, each value's */
};

struct option_group {
  const char *title;
  const struct option_row *rows;
  size_t count;
};

/* The ways to read a value; the comment names the field's type. */
int parse_switch(void *field, const struct option_row *row, const char *text,
                 placido_error *err); /* bool */
int parse_number(void *field, const struct option_row *row, const char *text,
                 placido_error *err); /* double */
int parse_integer(void *field, const struct option_row *row, const char *text,
                  placido_error *err); /* int */
int parse_text(void *field, const struct option_row *row, const char *text,
               placido_error *err); /* const char *, borrowed */
int parse_numbers(void *field, const struct option_row *row, const char *text,
                  placido_error *err); /* struct number_list */
int parse_text_more(void *field, const struct option_row *row, const char *text,
                    placido_error *err); /* struct text_list */

/* A text of exactly `least` to `most` numbers separated by commas. */
int parse_tuple(struct number_list *list, const struct option_row *row, const char *text,
                size_t least, size_t most, placido_error *err);

/* A word that may stand in place of a number. */
struct number_word {
  const char *text;
  double value; /* what it is read as, whatever the option's range */
};

/* The same with that word (NULL: none). */
int parse_tuple_or_word(struct number_list *list, const struct option_row *row, const char *text,
                        size_t least, size_t most, const struct number_word *word,
                        placido_error *err);

/* Reads the command line of a command (argv[0] is its name) into `settings`, by the rows of the
 * groups (NULL-terminated). The first word that is no option goes to *word (NULL: there is none),
 * further ones to `more`, which is NULL where one is enough. */
int options_parse(void *settings, const char **word, struct text_list *more,
                  const struct option_group *const *groups, int argc, char **argv,
                  placido_error *err);

/* Prints the rows of the groups to stdout, one paragraph a group. */
void options_print(const struct option_group *const *groups);

#endif
