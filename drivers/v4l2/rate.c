/* How many pictures a second: what a camera lists, what it is set to, and what it is asked for. */
#include "drivers/v4l2/rate.h"

#include "drivers/settings.h"

#include <math.h>

static double rate_of(struct v4l2_fract interval) {
  return interval.numerator > 0 ? (double)interval.denominator / interval.numerator : NAN;
}

void placido_v4l2_rates_list(placido_v4l2_offer *offer, const placido_v4l2_camera *camera,
                             uint32_t fourcc) {
  offer->rate_count = 0;
  offer->any_rate = false;
  for (uint32_t i = 0; i < PLACIDO_RATES_MAX; i++) {
    struct v4l2_frmivalenum interval = {.index = i,
                                        .pixel_format = fourcc,
                                        .width = (uint32_t)offer->width_max_px,
                                        .height = (uint32_t)offer->height_max_px};
    if (placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_ENUM_FRAMEINTERVALS, &interval)) {
      return;
    }
    if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) {
      offer->rates_hz[0] = rate_of(interval.stepwise.min);
      offer->rates_hz[1] = rate_of(interval.stepwise.max);
      offer->rate_count = 2;
      offer->any_rate = true;
      return;
    }
    offer->rates_hz[offer->rate_count++] = rate_of(interval.discrete);
  }
}

double placido_v4l2_rate(const placido_v4l2_camera *camera) {
  struct v4l2_streamparm said = {.type = camera->type};
  if (placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_G_PARM, &said)) {
    return NAN;
  }
  const double rate_hz = rate_of(said.parm.capture.timeperframe);
  return rate_hz > 0 ? rate_hz : NAN;
}

int placido_v4l2_rate_set(const placido_v4l2_camera *camera, double rate_hz) {
  struct v4l2_streamparm wish = {.type = camera->type};
  wish.parm.capture.timeperframe =
      (struct v4l2_fract){.numerator = 1000, .denominator = (uint32_t)lround(1000 * rate_hz)};
  return placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_S_PARM, &wish);
}

/* The lowest and highest rate that the camera lists; NaN where it lists none. */
static void listed_range(double rates_hz[2], const placido_v4l2_camera *camera,
                         const placido_v4l2_mode *mode) {
  placido_v4l2_offer offer = {.width_max_px = mode->width_px, .height_max_px = mode->height_px};
  placido_v4l2_rates_list(&offer, camera, mode->format->fourcc);
  rates_hz[0] = rates_hz[1] = NAN;
  for (int i = 0; i < offer.rate_count; i++) {
    rates_hz[0] = fmin(rates_hz[0], offer.rates_hz[i]);
    rates_hz[1] = fmax(rates_hz[1], offer.rates_hz[i]);
  }
}

void placido_v4l2_rate_range(double rates_hz[2], const placido_v4l2_camera *camera,
                             const placido_v4l2_mode *mode) {
  listed_range(rates_hz, camera, mode);
  if (isnan(rates_hz[1]) && mode->rate_hz > 0) {
    rates_hz[0] = 1; /* settable, in a range that the camera keeps to itself */
    rates_hz[1] = 1000;
  }
}

void placido_v4l2_rate_choose(const placido_v4l2_camera *camera, const placido_v4l2_mode *mode,
                              const placido_v4l2_request *request) {
  double rates_hz[2] = {request->rate_hz, request->rate_hz};
  if (!(request->rate_hz > 0)) {
    listed_range(rates_hz, camera, mode);
  }
  if (rates_hz[1] > 0 && rates_hz[1] <= PLACIDO_RATE_MAX_HZ) {
    placido_v4l2_rate_set(camera, rates_hz[1]);
  }
}
