/* The log of the daily check: a CSV file that only grows, one whole line at a time. */
#include "acquire/cli/ball.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define LOG_MAX_BYTES (64u << 20)
#define LINE_SIZE 4096
#define FIELDS 14

/* docs/formats.md. The two texts stand last, so that the numbers before them need no quotes. */
static const char header[] =
    "time,result,ball_mm,z_mm,distance,radius_mm,rms_6_um,rms_8_um,power_inner_D,power_middle_D,"
    "power_outer_D,mires_rms_px,limit_D,limit_um,instrument,input\n";

/* A number, or nothing where there is none. */
static size_t put_number(char *out, size_t room, double value) {
  int length = isfinite(value) ? snprintf(out, room, ",%.6g", value) : snprintf(out, room, ",");
  return (size_t)length;
}

/* In quotes, as RFC 4180 has it, on one line. */
static size_t put_text(char *out, size_t room, const char *text) {
  size_t used = 0;
  out[used++] = ',';
  out[used++] = '"';
  for (; *text && used + 4 < room; text++) {
    if (*text == '"') {
      out[used++] = '"';
    }
    out[used++] = (unsigned char)*text < ' ' ? ' ' : *text;
  }
  out[used++] = '"';
  out[used] = '\0';
  return used;
}

static int write_line(char line[LINE_SIZE], const struct ball_record *r, const char *instrument,
                      const char *input, placido_error *err) {
  const time_t t = (time_t)r->t_s;
  struct tm utc;
  if (!gmtime_r(&t, &utc)) {
    return placido_error_set(err, PLACIDO_SYSTEM, "the clock cannot be told");
  }
  size_t used = strftime(line, LINE_SIZE, "%Y-%m-%dT%H:%M:%SZ", &utc);
  used += (size_t)snprintf(line + used, LINE_SIZE - used, ",%s", r->passed ? "pass" : "fail");
  used += put_number(line + used, LINE_SIZE - used, r->ball_mm);
  used += put_number(line + used, LINE_SIZE - used, r->z_mm);
  used += (size_t)snprintf(line + used, LINE_SIZE - used, ",%s", r->z_given ? "given" : "found");
  const double numbers[] = {r->radius_mm,  r->rms_6_um,   r->rms_8_um,     r->power_D[0],
                            r->power_D[1], r->power_D[2], r->mires_rms_px, r->limit_D,
                            r->limit_um};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
    used += put_number(line + used, LINE_SIZE - used, numbers[i]);
  }
  used += put_text(line + used, LINE_SIZE / 4, instrument);
  used += put_text(line + used, LINE_SIZE - used - 1, placido_text_tail(input));
  line[used++] = '\n';
  line[used] = '\0';
  return PLACIDO_OK;
}

/* Whether a file that is there already is a log of ours. A line that a power cut tore gets its
 * end. */
static int check_start(int descriptor, off_t size, bool *torn, const char *path,
                       placido_error *err) {
  char start[sizeof header] = "", last = '\n';
  *torn = false;
  if (size == 0) {
    return PLACIDO_OK;
  }
  if (pread(descriptor, start, sizeof header - 1, 0) < 0 ||
      pread(descriptor, &last, 1, size - 1) < 0) {
    return placido_error_set(err, PLACIDO_SYSTEM, "cannot read %s: %s", placido_text_tail(path),
                             strerror(errno));
  }
  if (strcmp(start, header) != 0) {
    return placido_error_set(err, PLACIDO_INPUT,
                             "%s is no log of placido verify: nothing is added to it",
                             placido_text_tail(path));
  }
  *torn = last != '\n';
  return PLACIDO_OK;
}

/* All of the text or nothing of it. */
static int add(int descriptor, off_t size, const char *text, const char *path,
               placido_error *err) {
  size_t length = strlen(text);
  ssize_t written = write(descriptor, text, length);
  if (written == (ssize_t)length && fsync(descriptor) == 0) {
    return PLACIDO_OK;
  }
  int status = placido_error_set(err, PLACIDO_SYSTEM, "cannot write %s: %s",
                                 placido_text_tail(path),
                                 written >= 0 && written < (ssize_t)length ? "the disk is full"
                                                                          : strerror(errno));
  if (ftruncate(descriptor, size) != 0) {
    return status; /* the next line's start mends it */
  }
  return status;
}

int ball_log_append(const char *path, const struct ball_record *record, const char *instrument,
                    const char *input, placido_error *err) {
  char line[LINE_SIZE], text[LINE_SIZE + sizeof header + 1];
  struct stat found;
  bool torn = false;
  int status = write_line(line, record, instrument, input, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  int descriptor = open(path, O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0 || flock(descriptor, LOCK_EX) != 0 || fstat(descriptor, &found) != 0) {
    status = placido_error_set(err, PLACIDO_SYSTEM, "cannot open %s: %s", placido_text_tail(path),
                               strerror(errno));
  }
  if (status == PLACIDO_OK) {
    status = check_start(descriptor, found.st_size, &torn, path, err);
  }
  if (status == PLACIDO_OK) {
    snprintf(text, sizeof text, "%s%s%s", found.st_size == 0 ? header : "", torn ? "\n" : "",
             line);
    status = add(descriptor, found.st_size, text, path, err);
  }
  if (descriptor >= 0) {
    close(descriptor);
  }
  return status;
}

/* The number of a field, NaN where it is empty. */
static double number_of(const char *field) {
  char *end;
  double value = strtod(field, &end);
  return end == field || *end != '\0' ? NAN : value;
}

/* "2026-11-22T07:21:07Z" as seconds since 1970. */
static double seconds_of(const char *text) {
  struct tm utc = {0};
  char zone;
  if (sscanf(text, "%4d-%2d-%2dT%2d:%2d:%2d%c", &utc.tm_year, &utc.tm_mon, &utc.tm_mday,
             &utc.tm_hour, &utc.tm_min, &utc.tm_sec, &zone) != 7 ||
      zone != 'Z') {
    return NAN;
  }
  utc.tm_year -= 1900;
  utc.tm_mon -= 1;
  return (double)timegm(&utc);
}

/* Reads a line, which is cut up; false where it is not one of ours. */
static bool read_line(struct ball_record *r, char *line) {
  char *fields[FIELDS];
  for (int i = 0; i < FIELDS; i++) {
    fields[i] = strsep(&line, ",");
    if (!line) {
      return false;
    }
  }
  *r = (struct ball_record){.t_s = seconds_of(fields[0]),
                            .passed = strcmp(fields[1], "pass") == 0,
                            .ball_mm = number_of(fields[2]),
                            .z_mm = number_of(fields[3]),
                            .z_given = strcmp(fields[4], "given") == 0,
                            .radius_mm = number_of(fields[5]),
                            .rms_6_um = number_of(fields[6]),
                            .rms_8_um = number_of(fields[7]),
                            .power_D = {number_of(fields[8]), number_of(fields[9]),
                                        number_of(fields[10])},
                            .mires_rms_px = number_of(fields[11]),
                            .limit_D = number_of(fields[12]),
                            .limit_um = number_of(fields[13])};
  return isfinite(r->t_s) && isfinite(r->limit_D);
}

int ball_log_read(struct ball_record **records, size_t *count, size_t *odd, const char *path,
                  placido_error *err) {
  char *text = NULL;
  size_t size, lines = 0;
  *records = NULL;
  *count = *odd = 0;
  int status = placido_file_read(&text, &size, path, LOG_MAX_BYTES, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  for (size_t i = 0; i < size; i++) {
    lines += text[i] == '\n';
    /* a power cut may leave zero bytes, which must not hide the lines behind them */
    text[i] = text[i] == '\0' ? '?' : text[i];
  }
  *records = placido_memory_new(lines + 1, sizeof **records, err);
  char *rest = text;
  for (char *line; *records && (line = strsep(&rest, "\n"));) {
    bool first = line == text;
    if (first || *line == '\0') {
      continue;
    }
    bool ours = read_line(&(*records)[*count], line);
    *count += ours;
    *odd += !ours;
  }
  placido_memory_free(text);
  return *records ? PLACIDO_OK : PLACIDO_MEMORY;
}
