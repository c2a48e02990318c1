/* What a person may set about taking and giving others' data. */
#ifndef PLACIDO_CLI_EXCHANGE_SETTINGS_H
#define PLACIDO_CLI_EXCHANGE_SETTINGS_H

#include <placido/elevation.h>
#include <stdbool.h>

struct exchange_settings {
  /* import */
  placido_elevation_options reading;

  /* export: a file each; NULL: not wanted */
  const char *zernike, *stl, *ply, *csv, *dicom;
  double radius_mm; /* of the disc of Zernike terms; 0: the default */
  int order;
  double step_mm; /* of grid and mesh; 0: the default */
  double solid_mm; /* depth of a closed mesh below its lowest point; 0: an open one */
  const char *eye, *subject, *uid_seed;
};

#endif
