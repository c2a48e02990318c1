/* The sections of report.html about what the eye sees, one for every pupil. */
#include "report/page.h"

#include "report/correction.h"
#include "report/html.h"
#include "report/number.h"
#include "report/page_plan.h"

static void write_rays(FILE *stream, const placido_psf *psf) {
  char text[160], share[PLACIDO_NUMBER_SIZE];
  placido_number_write(share, sizeof share,
                       100 * (double)psf->rays_landed / (double)psf->rays_entered, 2);
  snprintf(text, sizeof text, "%ld of %ld (%s %%); %ld missed the surface", psf->rays_landed,
           psf->rays_entered, share, psf->rays_missed);
  placido_html_row(stream, "Rays that landed", text);
}

/* Ratios are written to three digits, or as far as they are known. */
static void write_strehl(char *number, size_t size, const placido_report_pupil *pupil) {
  if (pupil->strehl_g_sigma > 0) {
    placido_number_measure(number, size, pupil->psf->strehl_g, pupil->strehl_g_sigma);
  } else {
    placido_number_significant(number, size, pupil->psf->strehl_g, 3);
  }
}

static void write_figures(FILE *stream, const placido_report_pupil *pupil) {
  const placido_psf *psf = pupil->psf;
  char text[160], number[PLACIDO_NUMBER_SIZE], correction[PLACIDO_CORRECTION_SIZE];
  fputs("<table>\n<tbody>\n", stream);
  write_strehl(number, sizeof number, pupil);
  if (psf->wavelength_nm > 0) {
    snprintf(text, sizeof text, "diffraction at %g nm", psf->wavelength_nm);
    placido_html_row(stream, "Light", text);
    placido_html_row(stream, "Fullest bucket, share of the light that landed", number);
  } else {
    placido_html_row(stream, "Geometric Strehl ratio", number);
    write_rays(stream, psf);
  }
  placido_correction_write(correction, &psf->correction);
  placido_html_row(stream, "Correction", correction);
  snprintf(text, sizeof text, "%.3f mm behind the cornea's point on the axis, index %g",
           psf->retina_mm, psf->index);
  placido_html_row(stream, "Retina", text);
  snprintf(text, sizeof text, "%g′ × %g′ (%.3g µm on the retina), %d × %d of them",
           psf->bucket_arcmin, psf->bucket_arcmin, psf->bucket_um, psf->n, psf->n);
  placido_html_row(stream, "Buckets", text);
  fputs("</tbody>\n</table>\n", stream);
}

static void write_acuities(FILE *stream, const placido_report_pupil *pupil) {
  char text[256], heading[96];
  if (pupil->acuity_count == 0) {
    return;
  }
  fputs("<table>\n<tbody>\n", stream);
  for (size_t i = 0; i < pupil->acuity_count; i++) {
    const placido_acuity *acuity = &pupil->acuities[i];
    snprintf(heading, sizeof heading, "Predicted acuity, %s", acuity->test->title);
    placido_acuity_write(text, sizeof text, acuity);
    placido_html_row(stream, heading, text);
  }
  placido_ghosts_write(text, sizeof text, pupil->ghosts);
  placido_html_row(stream, "Ghost images", text);
  fputs("</tbody>\n</table>\n", stream);
}

static int write_psf(FILE *stream, const placido_report *report, const placido_report_pupil *pupil,
                     placido_error *err) {
  if (pupil->psf_picture == NULL) {
    return PLACIDO_OK;
  }
  fputs("<figure>\n", stream);
  int status = placido_html_picture(stream, NULL, report->directory, pupil->psf_picture,
                                    "Point spread function as a height field and as a plan", err);
  fputs(
      "<figcaption>Point spread function: what becomes of a point of light, as the patient sees "
      "it.</figcaption>\n</figure>\n",
      stream);
  return status;
}

static int write_scene(FILE *stream, const placido_report *report,
                       const placido_report_pupil *pupil, size_t k, placido_error *err) {
  char alternative[256];
  placido_html_size size;
  snprintf(alternative, sizeof alternative, "%s as the patient sees it", pupil->scene_names[k]);
  fputs("<figure>\n", stream);
  int status = placido_html_picture(stream, &size, report->directory, pupil->scene_pictures[k],
                                    alternative, err);
  fputs("<figcaption>", stream);
  placido_html_text(stream, pupil->scene_names[k]);
  if (pupil->scene_arcmin_per_px > 0) {
    double degrees_per_px = pupil->scene_arcmin_per_px / 60;
    placido_html_print(stream, ": %g′ per pixel, %.3g° × %.3g°", pupil->scene_arcmin_per_px,
                       size.width_px * degrees_per_px, size.height_px * degrees_per_px);
  }
  fputs("</figcaption>\n</figure>\n", stream);
  return status;
}

static void write_plans(FILE *stream, const placido_report_pupil *pupil) {
  bool any = false;
  for (size_t k = 0; pupil->plans != NULL && k < pupil->scene_count; k++) {
    if (pupil->plans[k].count > 0 && !any) {
      fputs("<p class=\"small\">Each picture has the effects that would be seen in it. Error "
            "without: at most so much of it, in linear light relative to white, would be wrong if "
            "the effect were left out.</p>\n", stream);
      any = true;
    }
    placido_page_plan(stream, pupil->scene_names[k], &pupil->plans[k]);
  }
}

static int write_pupil(FILE *stream, const placido_report *report,
                       const placido_report_pupil *pupil, placido_error *err) {
  fputs("<section>\n<h2>", stream);
  placido_html_print(stream, "Vision with a pupil of %.3g mm%s", pupil->psf->pupil_mm,
                     pupil->automatic ? ", as its scenes' light gives it" : "");
  fputs("</h2>\n", stream);
  int status = write_psf(stream, report, pupil, err);
  write_acuities(stream, pupil);
  write_figures(stream, pupil);
  if (pupil->scene_count > 0) {
    fprintf(stream, "<div class=\"%s\">\n", pupil->scene_count > 1 ? "pair scenes" : "scenes");
    for (size_t k = 0; status == PLACIDO_OK && k < pupil->scene_count; k++) {
      status = write_scene(stream, report, pupil, k, err);
    }
    fputs("</div>\n", stream);
  }
  write_plans(stream, pupil);
  fputs("</section>\n", stream);
  return status;
}

int placido_page_pupils(FILE *stream, const placido_report *report, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t k = 0; status == PLACIDO_OK && k < report->pupil_count; k++) {
    status = write_pupil(stream, report, &report->pupils[k], err);
  }
  return status;
}
