/* Reads a command line by tables, with getopt_long doing the splitting. */
#include "acquire/cli/options.h"

#include <errno.h>
#include <getopt.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROWS_MAX 96
#define LONG_BASE 256 /* getopt's value of row i is LONG_BASE + i: beyond every letter */
#define HELP_COLUMN 26
#define HELP_WIDTH 96
#define WORDS_SIZE 128 /* of an option's two words */

static int refuse_empty(const struct option_row *row, placido_error *err) {
  return placido_error_set(err, STATUS_USAGE, "--%s: its value is empty (%s)", row->name,
                           row->value);
}

/* Reads the number at `at` within the option's `text`. */
static int read_number(double *value, char **end, const struct option_row *row, const char *text,
                       const char *at, placido_error *err) {
  errno = 0;
  *value = strtod(at, end);
  if (*end == at || errno == ERANGE || !isfinite(*value)) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: a number was expected%s (%s)", row->name,
                             text, at == text ? "" : " after each comma", row->value);
  }
  if (*value < row->min || *value > row->max) {
    return placido_error_set(err, STATUS_USAGE, "--%s %g: it ranges from %g to %g", row->name,
                             *value, row->min, row->max);
  }
  return PLACIDO_OK;
}

int parse_switch(void *field, const struct option_row *row, const char *text, placido_error *err) {
  (void)row;
  (void)text;
  (void)err;
  *(bool *)field = true;
  return PLACIDO_OK;
}

int parse_number(void *field, const struct option_row *row, const char *text, placido_error *err) {
  struct number_list one;
  const int status = parse_tuple(&one, row, text, 1, 1, err);
  if (status == PLACIDO_OK) {
    *(double *)field = one.values[0];
  }
  return status;
}

int parse_integer(void *field, const struct option_row *row, const char *text, placido_error *err) {
  struct number_list one;
  const int status = parse_tuple(&one, row, text, 1, 1, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  if (one.values[0] != floor(one.values[0])) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: a whole number was expected", row->name,
                             text);
  }
  *(int *)field = (int)one.values[0];
  return PLACIDO_OK;
}

int parse_text(void *field, const struct option_row *row, const char *text, placido_error *err) {
  if (text[0] == '\0') {
    return refuse_empty(row, err);
  }
  *(const char **)field = text;
  return PLACIDO_OK;
}

/* A number, or the word that stands for one. */
static int read_item(double *value, char **end, const struct option_row *row, const char *text,
                     const char *at, const struct number_word *word, placido_error *err) {
  const size_t length = strcspn(at, ",");
  if (word && length == strlen(word->text) && strncmp(at, word->text, length) == 0) {
    *value = word->value;
    *end = (char *)(uintptr_t)(at + length);
    return PLACIDO_OK;
  }
  return read_number(value, end, row, text, at, err);
}

int parse_tuple(struct number_list *list, const struct option_row *row, const char *text,
                size_t least, size_t most, placido_error *err) {
  return parse_tuple_or_word(list, row, text, least, most, NULL, err);
}

int parse_tuple_or_word(struct number_list *list, const struct option_row *row, const char *text,
                        size_t least, size_t most, const struct number_word *word,
                        placido_error *err) {
  list->count = 0;
  if (text[0] == '\0') {
    return refuse_empty(row, err);
  }
  const char *next = text;
  for (;;) {
    char *end;
    if (list->count == most) {
      return placido_error_set(err, STATUS_USAGE, "--%s %s: at most %zu number%s (%s)", row->name,
                               text, most, most == 1 ? "" : "s", row->value);
    }
    const int status =
        read_item(&list->values[list->count], &end, row, text, next, word, err);
    if (status != PLACIDO_OK) {
      return status;
    }
    list->count++;
    if (*end == '\0') {
      break;
    }
    if (*end != ',') {
      return placido_error_set(err, STATUS_USAGE, "--%s %s: \"%s\" is not understood (%s)",
                               row->name, text, end, row->value);
    }
    next = end + 1;
  }
  if (list->count < least) {
    return placido_error_set(err, STATUS_USAGE, "--%s %s: %zu numbers were expected (%s)",
                             row->name, text, least, row->value);
  }
  return PLACIDO_OK;
}

int parse_numbers(void *field, const struct option_row *row, const char *text, placido_error *err) {
  return parse_tuple(field, row, text, 1, LIST_MAX, err);
}

int parse_text_more(void *field, const struct option_row *row, const char *text,
                    placido_error *err) {
  struct text_list *list = field;
  if (list->count == LIST_MAX) {
    return placido_error_set(err, STATUS_USAGE, "--%s: given more than %d times", row->name,
                             LIST_MAX);
  }
  return parse_text(&list->values[list->count++], row, text, err);
}

/* The tables as getopt_long wants them. */
struct getopt_tables {
  size_t count;
  const struct option_row *rows[ROWS_MAX];
  struct option longs[ROWS_MAX + 1];
  char letters[2 * ROWS_MAX + 2];
};

static void fill_tables(struct getopt_tables *tables, const struct option_group *const *groups) {
  char *letter = tables->letters;
  *letter++ = ':'; /* a missing value is told apart from an unknown option */
  for (; *groups; groups++) {
    for (size_t i = 0; i < (*groups)->count && tables->count < ROWS_MAX; i++) {
      const struct option_row *row = &(*groups)->rows[i];
      tables->rows[tables->count] = row;
      tables->longs[tables->count] =
          (struct option){.name = row->name,
                          .has_arg = row->value ? required_argument : no_argument,
                          .val = LONG_BASE + (int)tables->count};
      tables->count++;
      if (row->letter) {
        *letter++ = row->letter;
        if (row->value) {
          *letter++ = ':';
        }
      }
    }
  }
}

static const struct option_row *find_row(const struct getopt_tables *tables, int code) {
  if (code >= LONG_BASE) {
    return tables->rows[code - LONG_BASE];
  }
  for (size_t i = 0; i < tables->count; i++) {
    if (tables->rows[i]->letter == code) {
      return tables->rows[i];
    }
  }
  return NULL;
}

static int refuse(const struct getopt_tables *tables, int code, char **argv, placido_error *err) {
  const char *given = argv[optind - 1];
  const struct option_row *row = optopt ? find_row(tables, optopt) : NULL;
  if (code == ':' && row) {
    return placido_error_set(err, STATUS_USAGE, "--%s needs a value: %s", row->name, row->value);
  }
  if (row && !row->value) {
    return placido_error_set(err, STATUS_USAGE, "--%s takes no value", row->name);
  }
  if (optopt && !row && optopt < LONG_BASE) {
    return placido_error_set(err, STATUS_USAGE, "unknown option -%c", optopt);
  }
  return placido_error_set(err, STATUS_USAGE, "unknown or ambiguous option %s", given);
}

static int take_words(const char **word, struct text_list *more, int argc, char **argv,
                      placido_error *err) {
  if (optind < argc) {
    *word = argv[optind];
  }
  for (int i = optind + 1; i < argc; i++) {
    if (!more || more->count == LIST_MAX) {
      return placido_error_set(err, STATUS_USAGE, "%s: \"%s\" is one too many",
                               more ? "so many words are not understood" : "one input at a time",
                               argv[i]);
    }
    more->values[more->count++] = argv[i];
  }
  return PLACIDO_OK;
}

static bool takes_two_words(const struct option_row *row) {
  return row->value && row->value[0] != '"' && strchr(row->value, ' ');
}

/* Reads the value of an option that getopt_long has found. The second of two words stands where
 * getopt would look on; it is not looked for where both came as one. */
static int parse_value(void *settings, const struct option_row *row, int argc, char **argv,
                       placido_error *err) {
  char words[WORDS_SIZE];
  const char *text = optarg;
  if (takes_two_words(row) && !strchr(text, ' ') && optind < argc && argv[optind][0] != '-') {
    const int length = snprintf(words, sizeof words, "%s %s", text, argv[optind++]);
    if (length < 0 || (size_t)length >= sizeof words) {
      return placido_error_set(err, STATUS_USAGE, "--%s: %s was expected", row->name, row->value);
    }
    text = words;
  }
  return row->parse((char *)settings + row->offset, row, text, err);
}

int options_parse(void *settings, const char **word, struct text_list *more,
                  const struct option_group *const *groups, int argc, char **argv,
                  placido_error *err) {
  struct getopt_tables tables = {0};
  fill_tables(&tables, groups);
  *word = NULL;
  opterr = 0;
  optind = 0; /* not 1: an earlier call may have ended within a word */
  int code;
  while ((code = getopt_long(argc, argv, tables.letters, tables.longs, NULL)) != -1) {
    const struct option_row *row = find_row(&tables, code);
    if (!row) {
      return refuse(&tables, code, argv, err);
    }
    const int status = parse_value(settings, row, argc, argv, err);
    if (status != PLACIDO_OK) {
      return status;
    }
  }
  return take_words(word, more, argc, argv, err);
}

/* Prints text broken at spaces, every line after the first indented to the help's column. */
static void print_wrapped(const char *text) {
  size_t column = HELP_COLUMN;
  while (*text) {
    const size_t length = strcspn(text, " ");
    if (column > HELP_COLUMN && column + length > HELP_WIDTH) {
      printf("\n%*s", HELP_COLUMN, "");
      column = HELP_COLUMN;
    }
    printf("%.*s ", (int)length, text);
    column += length + 1;
    text += length;
    text += strspn(text, " ");
  }
  putchar('\n');
}

static void print_row(const struct option_row *row) {
  char head[80];
  const char letter[5] = {row->letter ? '-' : ' ', row->letter ? row->letter : ' ',
                          row->letter ? ',' : ' ', ' ', '\0'};
  const int length = snprintf(head, sizeof head, "  %s--%s%s%s", letter, row->name,
                              row->value ? " " : "", row->value ? row->value : "");
  if (length < HELP_COLUMN) {
    printf("%-*s", HELP_COLUMN, head);
  } else {
    printf("%s\n%*s", head, HELP_COLUMN, "");
  }
  print_wrapped(row->help);
}

void options_print(const struct option_group *const *groups) {
  for (; *groups; groups++) {
    printf("\n%s\n", (*groups)->title);
    for (size_t i = 0; i < (*groups)->count; i++) {
      print_row(&(*groups)->rows[i]);
    }
  }
}
