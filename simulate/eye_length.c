/* The retina of an eye of known length, in a model without a crystalline lens.
 *
 * The lens is that of Bennett and Rabbetts' schematic eye (Clinical Visual Optics, relaxed): a
 * front surface of 11.0 mm, 3.6 mm behind the cornea, 3.7 mm thick, a back surface of -6.47515 mm,
 * index 1.422 in media of 1.336. Vergences are followed from the retina outwards. */
#include <placido/eye.h>

static const double media = 1.336, lens_index = 1.422;
static const double chamber_mm = 3.6, thickness_mm = 3.7;
static const double front_mm = 11.0, back_mm = -6.47515;
static const double length_min_mm = 18, length_max_mm = 36;

/* Vergence `back_by_mm` before the place where it is `vergence_D`, in a medium of `index`. */
static double before(double vergence_D, double back_by_mm, double index) {
  return vergence_D / (1 + back_by_mm / 1000 / index * vergence_D);
}

int placido_eye_retina_of_length(double *retina_mm, double axial_mm, double index,
                                 placido_error *err) {
  *retina_mm = 0;
  if (!(axial_mm >= length_min_mm && axial_mm <= length_max_mm)) {
    return placido_error_set(err, PLACIDO_INPUT, "the eye's axial length (mm) is %g, expected %g to "
                             "%g", axial_mm, length_min_mm, length_max_mm);
  }
  if (!(index >= 1.01 && index <= 2)) {
    return placido_error_set(err, PLACIDO_INPUT, "the refractive index is %g, expected 1.01 to 2",
                             index);
  }
  double vergence_D = 1000 * media / (axial_mm - chamber_mm - thickness_mm);
  vergence_D -= 1000 * (media - lens_index) / back_mm;
  vergence_D = before(vergence_D, thickness_mm, lens_index);
  vergence_D -= 1000 * (lens_index - media) / front_mm;
  vergence_D = before(vergence_D, chamber_mm, media);
  *retina_mm = 1000 * index / vergence_D;
  return PLACIDO_OK;
}
