/* json_check FILE FORMAT [KEY...]: whether a file is JSON of a format ("-": any) with these keys,
 * where "a.b" is key b of the object a. For the shell tests. */
#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static const json_t *find(const json_t *value, const char *path) {
  while (value && *path) {
    char key[128];
    const size_t length = strcspn(path, ".");
    snprintf(key, sizeof key, "%.*s", (int)length, path);
    value = json_object_get(value, key);
    path += length;
    path += *path == '.';
  }
  return value;
}

static bool check(const json_t *root, int count, char **words) {
  const char *format = json_string_value(json_object_get(root, "format"));
  if (strcmp(words[0], "-") != 0 && (!format || strcmp(format, words[0]) != 0)) {
    fprintf(stderr, "format is %s, not %s\n", format ? format : "missing", words[0]);
    return false;
  }
  for (int i = 1; i < count; i++) {
    if (!find(root, words[i])) {
      fprintf(stderr, "%s is missing\n", words[i]);
      return false;
    }
  }
  return true;
}

int main(int argc, char **argv) {
  if (argc < 3) {
    fputs("usage: json_check FILE FORMAT [KEY...]\n", stderr);
    return 2;
  }
  json_error_t cause;
  json_t *root = json_load_file(argv[1], JSON_REJECT_DUPLICATES, &cause);
  if (!root) {
    fprintf(stderr, "%s:%d: %s\n", argv[1], cause.line, cause.text);
    return 1;
  }
  const bool good = check(root, argc - 2, argv + 2);
  json_decref(root);
  return good ? 0 : 1;
}
