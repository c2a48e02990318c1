/* The cornea as a DICOM Corneal Topography Map (PS3.3, A.73 and C.8.30). */
#ifndef PLACIDO_DICOM_H
#define PLACIDO_DICOM_H

#include <placido/surface.h>

/* Who and what; every text may be NULL but for `eye`. */
typedef struct placido_dicom_info {
  const char *eye;        /* "OD" or "OS" */
  const char *patient_id; /* an opaque one [ANONYMOUS] */
  const char *created;    /* of the measurement, "2026-11-22T10:00:00Z", UTC [now] */
  const char *software;   /* name and version */
  const char *maker, *model, *serial; /* of the camera [unknown] */
  const char *uid_seed;   /* what unique identifiers are made from [chance] */
  double step_mm;         /* between the points that are listed, 0.05 to 1 [0.25] */
} placido_dicom_info;

/* Writes axial power as a picture of 0.02 mm by 0.025 mm pixels with its palette, and at points of
 * a square grid axial, tangential and refractive power, elevation over the best-fit sphere and the
 * wavefront of the front surface, with simulated keratometry and indices, by way of DCMTK's
 * dump2dcm and a temporary name. Returns PLACIDO_OK, PLACIDO_INPUT (info makes no sense),
 * PLACIDO_QUALITY (the map lacks a figure that DICOM demands), PLACIDO_UNSUPPORTED (no dump2dcm),
 * PLACIDO_SYSTEM, PLACIDO_MEMORY. */
int placido_dicom_save(const placido_surface *surface, const placido_dicom_info *info,
                       const char *path, placido_error *err);

#endif
