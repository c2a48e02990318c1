/* Several frames of an examination made into one. */
#include "acquire/cli/combination.h"

#include "acquire/cli/examination.h"

int combination_capture(struct examination *examination, placido_device *device,
                        placido_error *err) {
  struct combination *combination = &examination->combination;
  placido_notes *notes = &examination->outcome->notes;
  const size_t asked = (size_t)examination->settings->combine;
  const int status = placido_frames_choose(combination->frames, combination->choices, asked,
                                           &combination->chosen, device, notes, err);
  if (status != PLACIDO_OK) {
    return status;
  }
  examination->choice = combination->choices[0];
  examination->frame = combination->frames[0];
  combination->frames[0] = (placido_frame){0};
  if (combination->chosen < asked) {
    placido_notes_add(notes, "%zu frames to combine were asked for, %zu can be", asked,
                      combination->chosen);
  }
  return PLACIDO_OK;
}

/* Appends the mires of the other frames to `list`, whose first is the best frame's. */
static int find_others(struct examination *examination, placido_mires *list,
                       const placido_mires_options *options, placido_error *err) {
  struct combination *combination = &examination->combination;
  combination->index[0] = examination->choice.index;
  combination->count = 1;
  for (size_t i = 1; i < combination->chosen; i++) {
    placido_error why = {0};
    placido_mires *mires = &list[combination->count];
    const long index = combination->choices[i].index;
    const int status = placido_mires_find(mires, &combination->frames[i], &examination->instrument,
                                          options, NULL, &why);
    placido_frame_free(&combination->frames[i]);
    if (status == PLACIDO_OK) {
      combination->index[combination->count++] = index;
    } else if (status == PLACIDO_QUALITY) {
      placido_notes_add(&examination->outcome->notes, "frame %ld was left out: %s", index,
                        why.text);
    } else {
      return placido_error_set(err, status, "%s", why.text);
    }
  }
  return PLACIDO_OK;
}

static void note_outsiders(const struct combination *combination, placido_notes *notes) {
  for (size_t i = 0; i < combination->count; i++) {
    if (combination->movements[i].weight <= 0) {
      placido_notes_add(notes,
                        "frame %ld was set aside: it does not agree with the other frames (its "
                        "edges scatter about theirs by %.3f px)",
                        combination->index[i], combination->movements[i].spread_px);
    }
  }
}

/* The combined mires of `list` take the place of the examination's. */
static int combine(struct examination *examination, const placido_mires *list, placido_error *err) {
  struct combination *combination = &examination->combination;
  const placido_fit_options options = {.axis_z_mm = examination->axis_z_mm,
                                       .knot_mm = examination->settings->knot_mm,
                                       .degree = examination->settings->degree,
                                       .tolerance = examination->settings->fit_tolerance,
                                       .threads = examination->threads};
  placido_mires combined;
  const int status =
      placido_mires_combine(&combined, combination->movements, list, combination->count,
                            &examination->instrument, &options, err);
  if (status == PLACIDO_OK) {
    combination->offset_px[0] = list[0].centre_u_px - combined.centre_u_px;
    combination->offset_px[1] = list[0].centre_v_px - combined.centre_v_px;
    note_outsiders(combination, &examination->outcome->notes);
    placido_mires_free(&examination->mires);
    examination->mires = combined;
  }
  return status;
}

int combination_measure(struct examination *examination, placido_error *err) {
  const placido_mires_options options = {.meridians = examination->settings->meridians,
                                         .filter_px = examination->settings->filter_px,
                                         .threads = examination->threads};
  placido_mires list[PLACIDO_COMBINE_MAX] = {examination->mires};
  int status = find_others(examination, list, &options, err);
  if (status == PLACIDO_OK) {
    stages_next(&examination->outcome->stages, "combine");
    status = combine(examination, list, err);
  }
  for (size_t i = 1; i < examination->combination.count; i++) {
    placido_mires_free(&list[i]);
  }
  return status;
}

void combination_free(struct combination *combination) {
  for (size_t i = 0; i < combination->chosen; i++) {
    placido_frame_free(&combination->frames[i]);
  }
}
