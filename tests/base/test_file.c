/* A file or directory appears whole under its name, or not at all. */
#include "base/file.h"
#include "base/memory.h"
#include "base/temporary.h"
#include "tests/base/scratch.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void a_file_appears_at_commit(void **state) {
  char *path = scratch_path(state, "a.txt"), *folder = scratch_path(state, "");
  placido_file file;
  placido_error err;
  assert_int_equal(placido_file_create(&file, path, &err), PLACIDO_OK);
  fputs("words", file.stream);
  assert_int_not_equal(access(path, F_OK), 0);
  assert_int_equal(placido_file_commit(&file, &err), PLACIDO_OK);
  placido_file_discard(&file);
  char *text;
  size_t size;
  assert_int_equal(placido_file_read(&text, &size, path, 0, &err), PLACIDO_OK);
  assert_int_equal(size, 5);
  assert_string_equal(text, "words");
  placido_memory_free(text);
  assert_int_equal(scratch_count(folder), 1);
  free(path);
  free(folder);
}

static void a_discarded_file_leaves_what_was_there(void **state) {
  char *path = scratch_write_text(state, "a.txt", "old"), *folder = scratch_path(state, "");
  placido_file file;
  assert_int_equal(placido_file_create(&file, path, NULL), PLACIDO_OK);
  fputs("new", file.stream);
  placido_file_discard(&file);
  placido_file_discard(&file);
  char *text;
  size_t size;
  assert_int_equal(placido_file_read(&text, &size, path, 0, NULL), PLACIDO_OK);
  assert_string_equal(text, "old");
  placido_memory_free(text);
  assert_int_equal(scratch_count(folder), 1);
  free(path);
  free(folder);
}

static void a_full_disk_is_reported_and_leaves_nothing(void **state) {
  (void)state;
  if (access("/dev/full", W_OK) != 0) {
    skip();
  }
  placido_file file;
  placido_error err;
  char *path = scratch_path(state, "a.txt"), *folder = scratch_path(state, "");
  assert_int_equal(placido_file_create(&file, path, &err), PLACIDO_OK);
  assert_non_null(freopen("/dev/full", "wb", file.stream));
  fputs("words", file.stream);
  assert_int_equal(placido_file_commit(&file, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "a.txt"));
  assert_int_equal(scratch_count(folder), 0);
  free(path);
  free(folder);
}

static void what_cannot_be_written_is_refused_by_name(void **state) {
  char *path = scratch_path(state, "no/such/folder/a.txt"), *folder = scratch_path(state, "");
  placido_file file;
  placido_error err;
  assert_int_equal(placido_file_create(&file, path, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "folder/a.txt"));
  placido_file_discard(&file);
  assert_int_equal(placido_file_create(&file, folder, &err), PLACIDO_SYSTEM);
  free(path);
  free(folder);
}

static void a_pipe_without_a_writer_is_empty(void **state) {
  char *path = scratch_path(state, "pipe"), *text;
  size_t size;
  assert_int_equal(mkfifo(path, 0600), 0);
  assert_int_equal(placido_file_read(&text, &size, path, 0, NULL), PLACIDO_OK);
  assert_int_equal(size, 0);
  placido_memory_free(text);
  free(path);
}

static void temporary_names_are_hidden_from_people(void **state) {
  (void)state;
  char name[PLACIDO_PATH_MAX], text[4 * PLACIDO_PATH_MAX];
  assert_int_equal(placido_temporary_name(name, "out", 12, "tmp", NULL), PLACIDO_OK);
  snprintf(text, sizeof text, "cannot write %s/%s.x: %s", name, name, name);
  placido_temporary_hide(text);
  assert_string_equal(text, "cannot write out/out.x: out");
  snprintf(text, sizeof text, "a.1-0.tmp and .%ld-", (long)getpid());
  char before[4 * PLACIDO_PATH_MAX];
  memcpy(before, text, sizeof before);
  placido_temporary_hide(text);
  assert_string_equal(text, before);
}

static void reading_is_bounded(void **state) {
  char *path = scratch_write_text(state, "a.txt", "123456789"), *folder = scratch_path(state, "");
  char *text;
  size_t size;
  placido_error err;
  assert_int_equal(placido_file_read(&text, &size, path, 9, &err), PLACIDO_OK);
  placido_memory_free(text);
  assert_int_equal(placido_file_read(&text, &size, path, 8, &err), PLACIDO_INPUT);
  assert_null(text);
  assert_int_equal(placido_file_read(&text, &size, folder, 0, &err), PLACIDO_SYSTEM);
  assert_int_equal(placido_file_read(&text, &size, "/dev/zero", 1 << 20, &err), PLACIDO_INPUT);
  assert_int_equal(placido_file_read(&text, &size, "/dev/null", 0, &err), PLACIDO_OK);
  assert_int_equal(size, 0);
  placido_memory_free(text);
  free(path);
  free(folder);
}

static void put(const placido_directory *directory, const char *name) {
  char path[PLACIDO_PATH_MAX];
  assert_int_equal(placido_path_join(path, directory->temporary, name, NULL), PLACIDO_OK);
  FILE *stream = fopen(path, "wb");
  assert_non_null(stream);
  assert_int_equal(fclose(stream), 0);
}

/* Makes the directory PATH with one file NAME in it. */
static int make(const char *path, const char *name, const char *replaceable) {
  placido_directory directory;
  int status = placido_directory_create(&directory, path, replaceable, NULL);
  if (!status) {
    put(&directory, name);
    status = placido_directory_commit(&directory, NULL);
  }
  placido_directory_discard(&directory);
  return status;
}

static void a_directory_appears_at_commit(void **state) {
  char *path = scratch_path(state, "exam/"), *folder = scratch_path(state, "");
  placido_directory directory;
  assert_int_equal(placido_directory_create(&directory, path, "exam.json", NULL), PLACIDO_OK);
  put(&directory, "exam.json");
  assert_int_not_equal(access(path, F_OK), 0);
  assert_int_equal(placido_directory_commit(&directory, NULL), PLACIDO_OK);
  placido_directory_discard(&directory);
  assert_int_equal(scratch_count(path), 1);
  assert_int_equal(scratch_count(folder), 1);
  free(path);
  free(folder);
}

static void only_ones_own_kind_is_replaced(void **state) {
  char *path = scratch_path(state, "exam"), *folder = scratch_path(state, "");
  char *old = scratch_path(state, "exam/exam.json");
  char *new = scratch_path(state, "exam/new.json");
  assert_int_equal(mkdir(path, 0777), 0);
  assert_int_equal(make(path, "exam.json", "exam.json"), PLACIDO_OK); /* it was empty */
  assert_int_equal(make(path, "new.json", NULL), PLACIDO_SYSTEM);
  assert_int_equal(make(path, "new.json", "other.json"), PLACIDO_SYSTEM);
  assert_int_equal(access(old, F_OK), 0);
  assert_int_equal(make(path, "new.json", "exam.json"), PLACIDO_OK);
  assert_int_equal(access(new, F_OK), 0);
  assert_int_not_equal(access(old, F_OK), 0);
  assert_int_equal(scratch_count(folder), 1);
  free(old);
  free(new);
  free(path);
  free(folder);
}

static void a_directory_that_cannot_be_is_refused_at_once(void **state) {
  char *file = scratch_write_text(state, "file", "x");
  char *inside = scratch_path(state, "file/exam"), *nowhere = scratch_path(state, "no/exam");
  placido_directory directory;
  placido_error err;
  assert_int_equal(placido_directory_create(&directory, file, "exam.json", &err), PLACIDO_SYSTEM);
  assert_int_equal(placido_directory_create(&directory, inside, NULL, &err), PLACIDO_SYSTEM);
  assert_int_equal(placido_directory_create(&directory, nowhere, NULL, &err), PLACIDO_SYSTEM);
  assert_non_null(strstr(err.text, "no/exam"));
  assert_int_equal(placido_directory_create(&directory, "", NULL, &err), PLACIDO_INPUT);
  placido_directory_discard(&directory);
  free(file);
  free(inside);
  free(nowhere);
}

static void a_discarded_directory_is_gone_with_its_tree_but_not_beyond_links(void **state) {
  char *path = scratch_path(state, "exam"), *folder = scratch_path(state, "");
  char *kept = scratch_write_text(state, "kept", "x");
  char inner[PLACIDO_PATH_MAX];
  placido_directory directory;
  assert_int_equal(placido_directory_create(&directory, path, NULL, NULL), PLACIDO_OK);
  assert_int_equal(placido_path_join(inner, directory.temporary, "maps", NULL), PLACIDO_OK);
  assert_int_equal(mkdir(inner, 0777), 0);
  put(&directory, "maps/axial.png");
  assert_int_equal(placido_path_join(inner, directory.temporary, "link", NULL), PLACIDO_OK);
  assert_int_equal(symlink(folder, inner), 0);
  placido_directory_discard(&directory);
  assert_int_equal(scratch_count(folder), 1);
  assert_int_equal(access(kept, F_OK), 0);
  free(path);
  free(kept);
  free(folder);
}

static void a_path_that_is_too_long_is_refused(void **state) {
  (void)state;
  char name[PLACIDO_PATH_MAX], out[PLACIDO_PATH_MAX];
  memset(name, 'a', sizeof name);
  name[sizeof name - 1] = '\0';
  assert_int_equal(placido_path_join(out, "b", name, NULL), PLACIDO_INPUT);
  placido_file file;
  assert_int_not_equal(placido_file_create(&file, name, NULL), PLACIDO_OK);
  assert_int_equal(placido_path_join(out, "b/", "c", NULL), PLACIDO_OK);
  assert_string_equal(out, "b/c");
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, scratch_setup, scratch_teardown)
  const struct CMUnitTest tests[] = {
      TEST(a_file_appears_at_commit),
      TEST(a_discarded_file_leaves_what_was_there),
      TEST(a_full_disk_is_reported_and_leaves_nothing),
      TEST(what_cannot_be_written_is_refused_by_name),
      TEST(reading_is_bounded),
      TEST(a_pipe_without_a_writer_is_empty),
      TEST(temporary_names_are_hidden_from_people),
      TEST(a_directory_appears_at_commit),
      TEST(only_ones_own_kind_is_replaced),
      TEST(a_directory_that_cannot_be_is_refused_at_once),
      TEST(a_discarded_directory_is_gone_with_its_tree_but_not_beyond_links),
      TEST(a_path_that_is_too_long_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
