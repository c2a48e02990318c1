/* From the frame to the cornea: mires, surface, maps, indices, wavefront. */
#include "acquire/cli/examination.h"

#define MAP_STEP_MM 0.1 /* the grid of maps.csv, docs/formats.md */

int step_mires(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "mires");
  const placido_mires_options options = {.meridians = examination->settings->meridians,
                                         .filter_px = examination->settings->filter_px};
  const int status =
      placido_mires_find(&examination->mires, &examination->frame, &examination->instrument,
                         &options, &examination->outcome->notes, err);
  return status == PLACIDO_OK && examination->combination.chosen > 1
             ? combination_measure(examination, err)
             : status;
}

int step_fit(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "fit");
  const placido_fit_options options = {.axis_z_mm = examination->axis_z_mm,
                                       .axis_z_sigma_mm = examination->axis_z_sigma_mm,
                                       .geometry = &examination->geometry,
                                       .knot_mm = examination->settings->knot_mm,
                                       .degree = examination->settings->degree,
                                       .tolerance = examination->settings->fit_tolerance};
  const int status = placido_fit_new(&examination->fit, &examination->mires,
                                     &examination->instrument, &options,
                                     &examination->outcome->notes, err);
  if (status == PLACIDO_OK) {
    examination->surface = placido_fit_surface(examination->fit);
  }
  return status;
}

int step_maps(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "maps");
  const struct settings *settings = examination->settings;
  const placido_maps_options options = {.zone_mm = settings->maps.zone_mm,
                                        .index = settings->index,
                                        .retina_mm = settings->retina_mm};
  int status = placido_maps_find_all(&examination->maps, examination->surface, examination->fit,
                                     &options, MAP_STEP_MM, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  stages_next(&examination->outcome->stages, "indices");
  status = placido_indices_find(examination->indices, &examination->index_count,
                                examination->surface, examination->fit, err);
  return status == PLACIDO_OK && examination->frame.data
             ? placido_indices_of_mires(examination->indices, &examination->index_count,
                                        examination->fit, &examination->mires,
                                        &examination->instrument, err)
             : status;
}

int step_wavefront(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "wavefront");
  return wavefronts_find(&examination->wavefronts, examination->surface, examination->fit,
                         examination->settings, &examination->outcome->notes, err);
}

int step_surface(struct examination *examination, placido_error *err) {
  stages_next(&examination->outcome->stages, "read");
  const int status = placido_surface_load(&examination->loaded, examination->settings->input,
                                          &examination->outcome->notes, err);
  examination->surface = examination->loaded;
  return status;
}
