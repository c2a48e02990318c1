/* What an eye with this cornea sees of a chart: a surface file in, a picture out.
 *   see SURFACE.json OUT.png [PUPIL_MM] */
#include <placido/simulate.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
  placido_error err = {0};
  placido_surface *surface = NULL;
  placido_psf psf = {0};
  placido_scene scene = {0};
  placido_image seen = {0};
  const placido_eye eye = {.pupil_mm = argc > 3 ? atof(argv[3]) : 4,
                           .correct = PLACIDO_CORRECT_FULL};
  const placido_optics optics = {.threads = 1};
  if (argc < 3) {
    fprintf(stderr, "usage: see SURFACE.json OUT.png [PUPIL_MM]\n");
    return 2;
  }
  int status = placido_surface_load(&surface, argv[1], NULL, &err);
  status = status ? status : placido_psf_new(&psf, NULL, surface, &eye, &optics, NULL, &err);
  status = status ? status : placido_scene_load(&scene, "tumbling-e", 0, NULL, &err);
  status = status ? status : placido_scene_see(&seen, &scene, &psf, 1, &err);
  if (!status) {
    placido_image_to_srgb(&seen);
    status = placido_image_save_png(&seen, argv[2], &err);
  }
  fprintf(stderr, "%s\n", status ? err.text : "done");
  placido_image_free(&seen);
  placido_scene_free(&scene);
  placido_psf_free(&psf);
  placido_surface_free(surface);
  return status != PLACIDO_OK;
}
