/* Pictures of balls: how they are read and how their check is kept. */
#ifndef PLACIDO_CLI_BALL_H
#define PLACIDO_CLI_BALL_H

#include <placido/calibrate.h>
#include <placido/device.h>

/* Reads frame number `frame` of a device (-1: the one that shows the mires best), and what the
 * device tells of itself. */
int ball_read(placido_frame *picture, placido_device_info *source, const char *uri, int frame,
              placido_notes *notes, placido_error *err);

/* A line of the log of `placido verify`. */
struct ball_record {
  double t_s; /* since 1970, UTC */
  double ball_mm, z_mm, radius_mm, rms_6_um, rms_8_um, power_D[PLACIDO_BALL_ZONES], mires_rms_px;
  double limit_D, limit_um;
  bool z_given, passed;
};

/* Appends a line to the log, which is begun where there is none, as one piece or not at all. */
int ball_log_append(const char *path, const struct ball_record *record, const char *instrument,
                    const char *input, placido_error *err);

/* The log's records in order. Lines that cannot be read are counted in *odd. Free *records with
 * placido_memory_free. */
int ball_log_read(struct ball_record **records, size_t *count, size_t *odd, const char *path,
                  placido_error *err);

#endif
