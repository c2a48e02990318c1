/* Evaluates a formula while it reads it, by precedence; what is not chosen is read, but not
 * evaluated. */
#include "drivers/genicam/formula.h"

#include "drivers/genicam/operators.h"
#include "drivers/genicam/variable.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

#define TOKEN_MAX 256 /* characters of a name or a number */

struct formula {
  placido_genicam *features;
  uint32_t node;
  const char *text, *at;
  bool is_whole;
  const char *input_name;
  const struct number *input;
  placido_error *err;
};

static int condition(struct formula *formula, bool is_live, struct number *value);

static int wrong(const struct formula *formula, const char *why) {
  return placido_error_set(formula->err, PLACIDO_INPUT,
                           "the formula of %s, at \"%.20s\": %s: %.200s",
                           placido_genicam_name(formula->features, formula->node), formula->at,
                           why, formula->text);
}

static void skip_space(struct formula *formula) {
  while (isspace((unsigned char)*formula->at)) {
    formula->at++;
  }
}

static bool take(struct formula *formula, char sign) {
  skip_space(formula);
  const bool is_there = *formula->at == sign;
  formula->at += is_there;
  return is_there;
}

/* Reading goes one bracket, sign or operator deeper. */
static int deepen(struct formula *formula) {
  if (formula->features->nesting >= PLACIDO_GENICAM_NESTING_MAX) {
    return wrong(formula, "its brackets lie too deep");
  }
  formula->features->nesting++;
  return PLACIDO_OK;
}

static struct number as_number(const struct formula *formula, int64_t value) {
  return formula->is_whole ? placido_genicam_whole(value) : placido_genicam_real((double)value);
}

static bool is_true(const struct number *value) {
  return value->is_whole ? value->whole != 0 : value->real != 0;
}

/* Makes a number of what the formula counts in. */
static int convert(const struct formula *formula, struct number *value) {
  int64_t whole;
  if (!formula->is_whole) {
    *value = placido_genicam_real(value->is_whole ? (double)value->whole : value->real);
  } else if (placido_genicam_round(value, &whole)) {
    *value = placido_genicam_whole(whole);
  } else {
    return wrong(formula, "a number does not fit into 64 bits");
  }
  return PLACIDO_OK;
}

/* How long the number is that begins here. */
static size_t number_length(const char *text) {
  size_t length = 0;
  if (text[0] == '0' && (text[1] == 'x' || text[1] == 'X')) {
    for (length = 2; isxdigit((unsigned char)text[length]); length++) {
    }
    return length;
  }
  while (isdigit((unsigned char)text[length]) || text[length] == '.') {
    length++;
  }
  if (text[length] == 'e' || text[length] == 'E') {
    const size_t sign = text[length + 1] == '-' || text[length + 1] == '+';
    if (isdigit((unsigned char)text[length + 1 + sign])) {
      for (length += 1 + sign; isdigit((unsigned char)text[length]); length++) {
      }
    }
  }
  return length;
}

static int literal(struct formula *formula, struct number *value) {
  char token[TOKEN_MAX];
  const size_t length = number_length(formula->at);
  if (length >= sizeof token) {
    return wrong(formula, "a number is too long");
  }
  memcpy(token, formula->at, length);
  token[length] = '\0';
  if (!placido_genicam_number_read(value, token)) {
    return wrong(formula, "this is no number");
  }
  if (formula->is_whole && !value->is_whole && value->real != trunc(value->real)) {
    return wrong(formula, "a formula of integers has a fraction");
  }
  const int status = convert(formula, value);
  formula->at += length;
  return status;
}

/* Another formula of the same node, in the same numbers. */
static int expression(struct formula *formula, uint32_t property, struct number *value) {
  int status = deepen(formula);
  if (status) {
    return status;
  }
  status = placido_genicam_formula(
      formula->features, formula->node, placido_genicam_text(formula->features, property),
      formula->is_whole, formula->input_name, formula->input, value, formula->err);
  formula->features->nesting--;
  return status;
}

/* *is_known is false where the name is nothing that the node defines. */
static int look_up(struct formula *formula, const char *name, struct number *value,
                   bool *is_known) {
  *is_known = true;
  if (formula->input && strcmp(name, formula->input_name) == 0) {
    *value = *formula->input;
    return convert(formula, value);
  }
  const struct node *node = &formula->features->nodes[formula->node];
  int status = placido_genicam_charge(formula->features, formula->node,
                                      1 + node->property_count / 32, formula->err);
  if (status) {
    return status;
  }
  enum tag tag;
  const uint32_t property = 
      placido_genicam_definition(formula->features, formula->node, name, &tag);
  if (!property) {
    *is_known = false;
    return PLACIDO_OK;
  }
  status = tag == TAG_EXPRESSION
               ? expression(formula, property, value)
               : placido_genicam_variable(formula->features, formula->node, property, name, value,
                                          formula->err);
  return status ? status : convert(formula, value);
}

/* What stands in brackets behind the name of a function. */
static int arguments(struct formula *formula, bool is_live, struct number *values,
                     size_t *count) {
  *count = 0;
  if (take(formula, ')')) {
    return PLACIDO_OK;
  }
  do {
    if (*count == PLACIDO_GENICAM_ARGUMENTS_MAX) {
      return wrong(formula, "no function has that many numbers");
    }
    const int status = condition(formula, is_live, &values[(*count)++]);
    if (status) {
      return status;
    }
  } while (take(formula, ','));
  return take(formula, ')') ? PLACIDO_OK : wrong(formula, "a bracket is not closed");
}

/* A variable, a constant, or a function with what it is applied to. */
static int name(struct formula *formula, bool is_live, struct number *value) {
  const char *const begin = formula->at;
  char token[TOKEN_MAX];
  size_t length = 0;
  while (isalnum((unsigned char)begin[length]) || begin[length] == '_' || begin[length] == '.') {
    length++;
  }
  if (length >= sizeof token) {
    return wrong(formula, "a name is too long");
  }
  memcpy(token, begin, length);
  token[length] = '\0';
  formula->at += length;
  struct number values[PLACIDO_GENICAM_ARGUMENTS_MAX] = {{0}};
  size_t count = 0;
  bool is_known = false;
  int status = PLACIDO_OK;
  if (take(formula, '(')) {
    status = arguments(formula, is_live, values, &count);
  } else if (is_live) {
    status = look_up(formula, token, value, &is_known);
  }
  if (status || is_known || !is_live) {
    return status;
  }
  const char *why = placido_genicam_call(token, length, formula->is_whole, values, count, value,
                                         &is_known);
  if (why) {
    formula->at = begin;
    return wrong(formula, why);
  }
  return PLACIDO_OK;
}

static int operand(struct formula *formula, bool is_live, struct number *value);

static int sign(struct formula *formula, bool is_live, struct number *value) {
  const char which = *formula->at++;
  int status = operand(formula, is_live, value);
  if (status || !is_live || which == '+') {
    return status;
  }
  /* -x is 0 - x, except for the sign of a real zero; ~x is -1 ^ x */
  if (which == '-' && !formula->is_whole) {
    *value = placido_genicam_real(-value->real);
    return PLACIDO_OK;
  }
  const struct number left = as_number(formula, which == '-' ? 0 : -1);
  const struct number right = *value;
  const char *why = placido_genicam_apply(placido_genicam_operator(which == '-' ? "-" : "^"),
                                          &left, &right, value);
  return why ? wrong(formula, why) : PLACIDO_OK;
}

static int bracket(struct formula *formula, bool is_live, struct number *value) {
  formula->at++;
  const int status = condition(formula, is_live, value);
  if (status) {
    return status;
  }
  return take(formula, ')') ? PLACIDO_OK : wrong(formula, "a bracket is not closed");
}

static int operand(struct formula *formula, bool is_live, struct number *value) {
  int status = deepen(formula);
  if (status) {
    return status;
  }
  skip_space(formula);
  const char at = *formula->at;
  if (at == '(') {
    status = bracket(formula, is_live, value);
  } else if (at == '-' || at == '+' || at == '~') {
    status = sign(formula, is_live, value);
  } else if (isdigit((unsigned char)at) || at == '.') {
    status = literal(formula, value);
  } else if (isalpha((unsigned char)at) || at == '_') {
    status = name(formula, is_live, value);
  } else {
    status = wrong(formula, "a number, a name or a bracket was expected");
  }
  formula->features->nesting--;
  return status;
}

/* Operators of at least that precedence, from left to right. */
static int operation(struct formula *formula, int precedence, bool is_live,
                     struct number *value) {
  int status = deepen(formula);
  if (status) {
    return status;
  }
  status = operand(formula, is_live, value);
  while (!status) {
    skip_space(formula);
    const struct operator_row *row = placido_genicam_operator(formula->at);
    if (!row || row->precedence < precedence) {
      break;
    }
    formula->at += strlen(row->text);
    const bool is_decided = is_live && ((row->lazy == LAZY_AND && !is_true(value)) ||
                                        (row->lazy == LAZY_OR && is_true(value)));
    struct number right = as_number(formula, 0);
    status = operation(formula, row->precedence + !row->is_from_right, is_live && !is_decided,
                       &right);
    if (!status && is_live) {
      const struct number left = *value;
      if (is_decided) {
        right = left;
      }
      const char *why = placido_genicam_apply(row, &left, &right, value);
      status = why ? wrong(formula, why) : PLACIDO_OK;
    }
  }
  formula->features->nesting--;
  return status;
}

/* a ? b : c ? d : e, of which one is evaluated. */
static int condition(struct formula *formula, bool is_live, struct number *value) {
  int status = deepen(formula);
  if (status) {
    return status;
  }
  bool is_open = is_live; /* nothing has been chosen yet */
  for (;;) {
    struct number choice = as_number(formula, 0);
    status = operation(formula, 0, is_open, &choice);
    if (status || !take(formula, '?')) {
      if (is_open) {
        *value = choice;
      }
      break;
    }
    const bool is_chosen = is_open && is_true(&choice);
    status = condition(formula, is_chosen, is_chosen ? value : &choice);
    is_open = is_open && !is_chosen;
    if (!status && !take(formula, ':')) {
      status = wrong(formula, "a ':' was expected for the '?'");
    }
    if (status) {
      break;
    }
  }
  formula->features->nesting--;
  return status;
}

int placido_genicam_formula(placido_genicam *features, uint32_t node, const char *text,
                            bool is_whole, const char *input_name, const struct number *input,
                            struct number *value, placido_error *err) {
  struct formula formula = {.features = features,
                            .node = node,
                            .text = text,
                            .at = text,
                            .is_whole = is_whole,
                            .input_name = input_name,
                            .input = input,
                            .err = err};
  *value = as_number(&formula, 0);
  int status = placido_genicam_charge(features, node, 1 + strlen(text) / 64, err);
  if (status) {
    return status;
  }
  status = condition(&formula, true, value);
  if (status) {
    return status;
  }
  skip_space(&formula);
  if (*formula.at) {
    return wrong(&formula, "an operator was expected");
  }
  return isnan(value->real) ? wrong(&formula, "its result is no number") : PLACIDO_OK;
}
