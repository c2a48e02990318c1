/* The eye behind the cornea, and what it wears. */
#ifndef PLACIDO_EYE_H
#define PLACIDO_EYE_H

#include <placido/status.h>

#define PLACIDO_EYE_INDEX 1.3375 /* keratometric: has the cornea's back surface in it */
#define PLACIDO_EYE_AGE_YEARS 35

/* A thin lens on the cornea, in power-vector form: dioptres, J0 and J45 of its cross-cylinder
 * (Thibos, Wheeler, Horner, Optom. Vis. Sci. 74 (1997) 367). */
typedef struct placido_correction {
  double m_D, j0_D, j45_D;
} placido_correction;

/* Sphere, minus-cylinder and axis (0 to below 180) of a power vector; the axis is NaN where the
 * cylinder is zero. */
void placido_correction_clinical(const placido_correction *correction, double *sphere_D,
                                 double *cylinder_D, double *axis_deg);

/* The power vector of sphere, cylinder (plus or minus) and axis; without cylinder the axis is not
 * looked at. */
placido_correction placido_correction_of(double sphere_D, double cylinder_D, double axis_deg);

/* The lens that does the same for light from afar when worn `nearer_mm` nearer to the eye, farther
 * where that is negative: every principal meridian's power F becomes F / (1 - d F). From spectacles
 * to the cornea d is their vertex distance, back it is minus that. Returns PLACIDO_OK, or
 * PLACIDO_INPUT where a meridian's focus lies within the way. `moved` may be `correction`. */
int placido_correction_move(placido_correction *moved, const placido_correction *correction,
                            double nearer_mm, placido_error *err);

/* What of a correction is searched for the best focus. The sphere is the retina's distance where
 * that is not given, as in the seed, and the lens's m_D where it is. */
enum placido_correct {
  PLACIDO_CORRECT_NONE,   /* the lens stays as it is */
  PLACIDO_CORRECT_FULL,   /* sphere and cross-cylinder */
  PLACIDO_CORRECT_SPHERE  /* sphere alone: the lens's cross-cylinder stays */
};

/* How dark the eye is: p of the CIE's glare function (CIE 135/1), 0.5, 0, 1 and 1.2. */
enum placido_iris {
  PLACIDO_IRIS_BROWN,
  PLACIDO_IRIS_DARK,
  PLACIDO_IRIS_GREEN,
  PLACIDO_IRIS_BLUE
};

/* The eye behind the cornea: a value. Zero means the default in brackets. */
typedef struct placido_eye {
  double pupil_mm;             /* diameter of the entrance pupil, 0.1 to 12; no default */
  double pupil_x_mm, pupil_y_mm;
  double index;                /* refractive index behind the surface [PLACIDO_EYE_INDEX] */
  double retina_mm;            /* distance from the surface's point on the axis; [searched] */
  enum placido_correct correct;
  placido_correction correction; /* worn; what is searched of it replaces it */
  double age_years;            /* 5 to 100 [35]: pupil, accommodation, straylight */
  enum placido_iris iris;      /* [brown]: straylight */
} placido_eye;

/* Where the retina of an eye of `axial_mm` (18 to 36, cornea to retina) stands in a model of the
 * cornea alone with refractive index `index`. The crystalline lens that the model lacks is that of
 * Bennett and Rabbetts' schematic eye at rest: light from the retina is followed back through it to
 * the cornea, and retina_mm has the same vergence there. Their eye, 24.086 mm with a cornea of
 * 7.8 mm and index 1.336, is emmetropic. Returns PLACIDO_OK or PLACIDO_INPUT. */
int placido_eye_retina_of_length(double *retina_mm, double axial_mm, double index,
                                 placido_error *err);

#endif
