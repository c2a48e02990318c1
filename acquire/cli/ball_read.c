/* A picture of a ball, from whatever gives pictures. */
#include "acquire/acquire.h"
#include "acquire/cli/ball.h"

int ball_read(placido_frame *picture, placido_device_info *source, const char *uri, int frame,
              placido_notes *notes, placido_error *err) {
  placido_device *device = NULL;
  placido_choice choice;
  int status = placido_device_open(&device, uri, notes, err);
  if (status == PLACIDO_OK) {
    *source = *placido_device_info_get(device);
    status = placido_frame_choose(picture, &choice, device, frame, notes, err);
  }
  placido_device_close(device);
  return status;
}
