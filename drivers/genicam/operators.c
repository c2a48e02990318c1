/* The arithmetic of formulas: every operator and function for integers and for real numbers. */
#include "drivers/genicam/operators.h"

#include <math.h>
#include <string.h>
#include <strings.h>

static const char *add(int64_t a, int64_t b, int64_t *result) {
  *result = (int64_t)((uint64_t)a + (uint64_t)b);
  return NULL;
}

static const char *subtract(int64_t a, int64_t b, int64_t *result) {
  *result = (int64_t)((uint64_t)a - (uint64_t)b);
  return NULL;
}

static const char *multiply(int64_t a, int64_t b, int64_t *result) {
  *result = (int64_t)((uint64_t)a * (uint64_t)b);
  return NULL;
}

static const char *divide(int64_t a, int64_t b, int64_t *result) {
  if (b == 0) {
    return "it divides by zero";
  }
  *result = b == -1 ? (int64_t)(0 - (uint64_t)a) : a / b; /* the least number wraps around */
  return NULL;
}

static const char *remain(int64_t a, int64_t b, int64_t *result) {
  if (b == 0) {
    return "it divides by zero";
  }
  *result = b == -1 ? 0 : a % b;
  return NULL;
}

static const char *raise_power(int64_t a, int64_t b, int64_t *result) {
  if (b < 0) {
    return "it raises an integer to a negative power";
  }
  uint64_t power = 1, square = (uint64_t)a;
  for (uint64_t left = (uint64_t)b; left > 0; left >>= 1) {
    power *= left & 1 ? square : 1;
    square *= square;
  }
  *result = (int64_t)power;
  return NULL;
}

static const char *shift_left(int64_t a, int64_t b, int64_t *result) {
  if (b < 0 || b > 63) {
    return "it shifts by less than 0 or more than 63 bits";
  }
  *result = (int64_t)((uint64_t)a << b);
  return NULL;
}

/* The sign stays. */
static const char *shift_right(int64_t a, int64_t b, int64_t *result) {
  if (b < 0 || b > 63) {
    return "it shifts by less than 0 or more than 63 bits";
  }
  *result = a < 0 ? ~(~a >> b) : a >> b;
  return NULL;
}

/* An operator that always has a result, for both kinds of numbers. */
#define SIMPLE(name, operation)                                                                    \
  static const char *name(int64_t a, int64_t b, int64_t *result) {                                 \
    *result = operation;                                                                           \
    return NULL;                                                                                   \
  }
#define COMPARISON(name, operation)                                                                \
  SIMPLE(name, operation)                                                                          \
  static double name##_real(double a, double b) {                                                  \
    return operation;                                                                              \
  }
SIMPLE(bits_and, a & b)
SIMPLE(bits_or, a | b)
SIMPLE(bits_xor, a ^ b)
COMPARISON(equal, a == b)
COMPARISON(unequal, a != b)
COMPARISON(less, a < b)
COMPARISON(greater, a > b)
COMPARISON(at_most, a <= b)
COMPARISON(at_least, a >= b)
COMPARISON(both, a != 0 && b != 0)
COMPARISON(either, a != 0 || b != 0)

static double add_real(double a, double b) {
  return a + b;
}

static double subtract_real(double a, double b) {
  return a - b;
}

static double multiply_real(double a, double b) {
  return a * b;
}

static double divide_real(double a, double b) {
  return a / b;
}

/* The longer of two that begin alike comes first. The ladder is that of C, and ** above it. */
static const struct operator_row operators[] = {
    {"**", 11, true, LAZY_NO, raise_power, pow},
    {"*", 10, false, LAZY_NO, multiply, multiply_real},
    {"/", 10, false, LAZY_NO, divide, divide_real},
    {"%", 10, false, LAZY_NO, remain, fmod},
    {"+", 9, false, LAZY_NO, add, add_real},
    {"-", 9, false, LAZY_NO, subtract, subtract_real},
    {"<<", 8, false, LAZY_NO, shift_left, NULL},
    {">>", 8, false, LAZY_NO, shift_right, NULL},
    {"<=", 7, false, LAZY_NO, at_most, at_most_real},
    {">=", 7, false, LAZY_NO, at_least, at_least_real},
    {"<>", 6, false, LAZY_NO, unequal, unequal_real},
    {"<", 7, false, LAZY_NO, less, less_real},
    {">", 7, false, LAZY_NO, greater, greater_real},
    {"==", 6, false, LAZY_NO, equal, equal_real}, /* not GenApi's, but written */
    {"=", 6, false, LAZY_NO, equal, equal_real},
    {"!=", 6, false, LAZY_NO, unequal, unequal_real}, /* the same */
    {"&&", 2, false, LAZY_AND, both, both_real},
    {"||", 1, false, LAZY_OR, either, either_real},
    {"&", 5, false, LAZY_NO, bits_and, NULL},
    {"^", 4, false, LAZY_NO, bits_xor, NULL},
    {"|", 3, false, LAZY_NO, bits_or, NULL},
};

const struct operator_row *placido_genicam_operator(const char *text) {
  for (size_t i = 0; i < sizeof operators / sizeof *operators; i++) {
    if (strncmp(text, operators[i].text, strlen(operators[i].text)) == 0) {
      return &operators[i];
    }
  }
  return NULL;
}

const char *placido_genicam_apply(const struct operator_row *row, const struct number *a,
                                  const struct number *b, struct number *result) {
  if (row->real && !a->is_whole) {
    *result = placido_genicam_real(row->real(a->real, b->real));
    return NULL;
  }
  int64_t left, right, whole;
  if (!placido_genicam_round(a, &left) || !placido_genicam_round(b, &right)) {
    return "an operator of integers is applied to what does not fit into 64 bits";
  }
  const char *why = row->whole(left, right, &whole);
  if (!why) {
    *result = a->is_whole ? placido_genicam_whole(whole) : placido_genicam_real((double)whole);
  }
  return why;
}

static double negative(double x) {
  return -x;
}

static double sign(double x) {
  return (x > 0) - (x < 0);
}

static double fraction(double x) {
  return x - trunc(x);
}

static int64_t negative_whole(int64_t x) {
  return (int64_t)(0 - (uint64_t)x);
}

static int64_t sign_whole(int64_t x) {
  return (x > 0) - (x < 0);
}

static int64_t magnitude_whole(int64_t x) {
  return x < 0 ? negative_whole(x) : x;
}

static int64_t same(int64_t x) {
  return x;
}

/* Functions of one number; GenApi's integer formulas know none of the irrational ones. */
static const struct {
  const char *name;
  double (*real)(double x);
  int64_t (*whole)(int64_t x); /* NULL: not for integers */
} functions[] = {
    {"NEG", negative, negative_whole},
    {"ABS", fabs, magnitude_whole},
    {"SGN", sign, sign_whole},
    {"TRUNC", trunc, same},
    {"ROUND", round, same},
    {"FLOOR", floor, same},
    {"CEIL", ceil, same},
    {"FRAC", fraction, NULL},
    {"SQRT", sqrt, NULL},
    {"EXP", exp, NULL},
    {"LN", log, NULL},
    {"LG", log10, NULL},
    {"SIN", sin, NULL},
    {"COS", cos, NULL},
    {"TAN", tan, NULL},
    {"ASIN", asin, NULL},
    {"ACOS", acos, NULL},
    {"ATAN", atan, NULL},
};

static const struct {
  const char *name;
  double value;
} constants[] = {
    {"PI", 3.14159265358979323846},
    {"E", 2.71828182845904523536},
};

static bool is_named(const char *row, const char *name, size_t length) {
  return strlen(row) == length && strncasecmp(row, name, length) == 0;
}

/* ROUND with a number of digits behind the point. */
static const char *round_to(bool is_whole, const struct number *arguments,
                            struct number *result) {
  if (is_whole) {
    *result = arguments[0];
    return NULL;
  }
  const double scale = pow(10, trunc(arguments[1].real));
  *result = placido_genicam_real(round(arguments[0].real * scale) / scale);
  return NULL;
}

const char *placido_genicam_call(const char *name, size_t length, bool is_whole,
                                 const struct number *arguments, size_t count,
                                 struct number *result, bool *is_known) {
  *is_known = true;
  for (size_t i = 0; i < sizeof constants / sizeof *constants; i++) {
    if (count == 0 && is_named(constants[i].name, name, length)) {
      *result = placido_genicam_real(constants[i].value);
      return is_whole ? "a formula of integers cannot have it" : NULL;
    }
  }
  if (count == 2 && is_named("ROUND", name, length)) {
    return round_to(is_whole, arguments, result);
  }
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++) {
    if (!is_named(functions[i].name, name, length)) {
      continue;
    }
    if (count != 1) {
      return "it has not the numbers that belong in its brackets";
    }
    if (is_whole && !functions[i].whole) {
      return "a formula of integers cannot have it";
    }
    *result = is_whole ? placido_genicam_whole(functions[i].whole(arguments[0].whole))
                       : placido_genicam_real(functions[i].real(arguments[0].real));
    return NULL;
  }
  *is_known = false;
  return "there is no such function or variable";
}
