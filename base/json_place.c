/* Finds the line of a value by scanning the text, which the parser has found to be valid JSON. */
#include "base/json_place.h"

#include <string.h>

bool placido_json_step_next(placido_json_step *step, const char **path) {
  *step = (placido_json_step){0};
  const char *p = *path;
  if (*p == '[') {
    const char *digit = ++p;
    while (*p >= '0' && *p <= '9') {
      step->index = step->index * 10 + (size_t)(*p++ - '0');
    }
    if (p == digit || *p != ']') {
      return false;
    }
    p++;
  } else {
    step->key = p;
    step->key_length = strcspn(p, ".[");
    if (step->key_length == 0) {
      return false;
    }
    p += step->key_length;
  }
  *path = *p == '.' ? p + 1 : p;
  return true;
}

static const char *skip_space(const char *p) {
  return p + strspn(p, " \t\r\n");
}

/* Behind the string whose opening quote is at `p`. */
static const char *skip_string(const char *p) {
  for (p++; *p && *p != '"'; p++) {
    if (*p == '\\' && p[1]) {
      p++;
    }
  }
  return *p ? p + 1 : p;
}

/* Behind the value that opens at `p`. */
static const char *skip_value(const char *p) {
  int depth = 0;
  do {
    if (*p == '"') {
      p = skip_string(p);
    } else if (*p == '{' || *p == '[') {
      depth++;
      p++;
    } else if (*p == '}' || *p == ']') {
      depth--;
      p++;
    } else if (depth > 0) {
      p++;
    } else {
      p += strcspn(p, ",]} \t\r\n");
    }
  } while (*p && depth > 0);
  return p;
}

/* The value of a key of the object that opens at `p`, NULL where it has none. */
static const char *find_key(const char *p, const char *key, size_t length) {
  p = skip_space(p + 1);
  while (*p == '"') {
    const char *name = p + 1;
    p = skip_string(p);
    size_t name_length = (size_t)(p - name) - 1;
    p = skip_space(skip_space(p) + 1);
    if (name_length == length && strncmp(name, key, length) == 0) {
      return p;
    }
    p = skip_space(skip_value(p));
    p = *p == ',' ? skip_space(p + 1) : p;
  }
  return NULL;
}

/* The element of the array that opens at `p`, NULL where it is shorter. */
static const char *find_index(const char *p, size_t index) {
  p = skip_space(p + 1);
  for (size_t i = 0; *p && *p != ']'; i++) {
    if (i == index) {
      return p;
    }
    p = skip_space(skip_value(p));
    p = *p == ',' ? skip_space(p + 1) : p;
  }
  return NULL;
}

int placido_json_line(const char *text, const char *path) {
  const char *place = skip_space(text);
  placido_json_step step;
  while (placido_json_step_next(&step, &path)) {
    const char *child = NULL;
    if (step.key && *place == '{') {
      child = find_key(place, step.key, step.key_length);
    } else if (!step.key && *place == '[') {
      child = find_index(place, step.index);
    }
    if (!child) {
      break;
    }
    place = child;
  }
  int line = 1;
  for (const char *p = text; p < place; p++) {
    line += *p == '\n';
  }
  return line;
}
