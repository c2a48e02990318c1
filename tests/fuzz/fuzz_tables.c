/* The program's own tables: the log of the daily check, and what accuracy costs in time. */
#include "acquire/cli/accuracy/table.h"
#include "acquire/cli/ball.h"
#include "base/memory.h"
#include "tests/fuzz/files.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <string.h>

/* A record appended to a log is read back behind those that were there. */
static void read_log(const char *path) {
  struct ball_record *records;
  size_t count, odd, more;
  placido_error err = {0};
  if (!fuzz_check(ball_log_read(&records, &count, &odd, path, &err), &err)) {
    FUZZ_REQUIRE(records == NULL && count == 0);
    return;
  }
  for (size_t i = 0; i < count; i++) {
    FUZZ_REQUIRE(isfinite(records[i].t_s) && isfinite(records[i].limit_D));
  }
  placido_memory_free(records);
  const struct ball_record record = {.t_s = 1795000000, .ball_mm = 7.94, .limit_D = 0.25};
  if (fuzz_check(ball_log_append(path, &record, "a \"name\",\nof two", "in,put", &err), &err)) {
    FUZZ_REQUIRE(fuzz_check(ball_log_read(&records, &more, &odd, path, &err), &err));
    FUZZ_REQUIRE(more >= count + 1 && records[more - 1].ball_mm == record.ball_mm);
    placido_memory_free(records);
  }
}

static void read_accuracy(const char *path) {
  struct accuracy_table table, same;
  placido_error err = {0};
  if (!fuzz_check(accuracy_table_load(&table, path, &err), &err)) {
    FUZZ_REQUIRE(table.rows == NULL && table.count == 0);
    return;
  }
  const char *first = fuzz_path("first.csv"), *second = fuzz_path("second.csv");
  FUZZ_REQUIRE(table.count >= 1 && table.probe_ms > 0);
  for (size_t i = 0; i < table.count; i++) {
    const struct accuracy_row *row = &table.rows[i];
    FUZZ_REQUIRE((int)row->stage >= 0 && row->stage < ACCURACY_STAGES);
    FUZZ_REQUIRE(isfinite(row->ms) && row->ms >= 0);
  }
  FUZZ_REQUIRE(fuzz_check(accuracy_table_save(&table, first, &err), &err));
  FUZZ_REQUIRE(fuzz_check(accuracy_table_load(&same, first, &err), &err));
  FUZZ_REQUIRE(fuzz_check(accuracy_table_save(&same, second, &err), &err));
  FUZZ_REQUIRE(same.count == table.count && fuzz_same(first, second));
  accuracy_table_free(&same);
  accuracy_table_free(&table);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *path = fuzz_file("table.csv", data, size);
  read_accuracy(path);
  read_log(path);
  return 0;
}
