/* Contrast filters of frequency in cycles per degree: neural, and of a perfect pupil. */
#ifndef PLACIDO_SIMULATE_ACUITY_NEURAL_H
#define PLACIDO_SIMULATE_ACUITY_NEURAL_H

/* Contrast sensitivity of the mean observer of ModelFest. */
double placido_contrast_sensitivity(double cpd);

/* Modulation transfer of a perfect pupil at 555 nm. */
double placido_diffraction_mtf(double cpd, double pupil_mm);

/* Modulation transfer of the mean human eye at 555 nm, pupil 2 to 6 mm. */
double placido_mean_mtf(double cpd, double pupil_mm);

/* What the nervous system does to contrast: sensitivity less the part of the mean eye's optics. */
double placido_neural_filter(double cpd);

#endif
