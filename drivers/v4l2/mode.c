/* What a camera offers (formats, sizes, rates), and the choice among it. */
#include "drivers/v4l2/mode.h"

#include "base/text.h"
#include "drivers/v4l2/mjpeg.h"
#include "drivers/v4l2/rate.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Lists of a camera that are longer than this do not end. */
#define LIVE_HZ 10 /* with fewer pictures a second nobody can aim */
#define FORMATS_MAX 64
#define SIZES_MAX 64

static void name_fourcc(char name[8], uint32_t fourcc) {
  for (int i = 0; i < 4; i++) {
    const char letter = (char)(fourcc >> 8 * i & 0x7f);
    name[i] = letter > ' ' && letter <= '~' ? letter : '_';
  }
  name[4] = '\0';
}

static bool is_side(uint32_t side_px) {
  return side_px >= 1 && side_px <= PLACIDO_V4L2_SIDE_MAX_PX;
}

/* Fills in the sizes; false where they cannot be meant. */
static bool take_size(placido_v4l2_offer *offer, const struct v4l2_frmsizeenum *size) {
  struct v4l2_frmsize_stepwise range = size->stepwise;
  if (size->type == V4L2_FRMSIZE_TYPE_DISCRETE) {
    const struct v4l2_frmsize_discrete one = size->discrete;
    range = (struct v4l2_frmsize_stepwise){one.width, one.width, 0, one.height, one.height, 0};
  }
  /* Some drivers offer anything up to 2^16 or more; what lies above our own limit is cut off. */
  range.max_width = is_side(range.max_width) ? range.max_width : PLACIDO_V4L2_SIDE_MAX_PX;
  range.max_height = is_side(range.max_height) ? range.max_height : PLACIDO_V4L2_SIDE_MAX_PX;
  if (!is_side(range.min_width) || !is_side(range.min_height) ||
      range.min_width > range.max_width || range.min_height > range.max_height) {
    return false;
  }
  offer->width_min_px = (int)range.min_width;
  offer->width_max_px = (int)range.max_width;
  offer->width_step_px = (int)(range.step_width & 0x7fff);
  offer->height_min_px = (int)range.min_height;
  offer->height_max_px = (int)range.max_height;
  offer->height_step_px = (int)(range.step_height & 0x7fff);
  return true;
}

static int offer_sizes(placido_v4l2_offer *offer, const placido_v4l2_camera *camera,
                       uint32_t fourcc,
                       int (*each)(void *user, const placido_v4l2_offer *offer), void *user) {
  int status = PLACIDO_OK;
  for (uint32_t i = 0; !status && i < SIZES_MAX; i++) {
    struct v4l2_frmsizeenum size = {.index = i, .pixel_format = fourcc};
    if (placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_ENUM_FRAMESIZES, &size)) {
      return PLACIDO_OK;
    }
    if (take_size(offer, &size)) {
      placido_v4l2_rates_list(offer, camera, fourcc);
      status = each(user, offer);
    }
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
      return status;
    }
  }
  return status;
}

/* The index-th format of the camera; false behind the last. */
static bool format_at(placido_v4l2_offer *offer, uint32_t *fourcc,
                      const placido_v4l2_camera *camera, uint32_t index) {
  struct v4l2_fmtdesc said = {.index = index, .type = camera->type};
  if (placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_ENUM_FMT, &said)) {
    return false;
  }
  *offer = (placido_v4l2_offer){.format = placido_v4l2_format_of(said.pixelformat)};
  *fourcc = said.pixelformat;
  name_fourcc(offer->name, said.pixelformat);
  if (offer->format) {
    snprintf(offer->name, sizeof offer->name, "%s", offer->format->name);
  }
  memcpy(offer->description, said.description, sizeof said.description);
  offer->description[sizeof said.description] = '\0';
  placido_text_line(offer->description);
  return true;
}

int placido_v4l2_offers(const placido_v4l2_camera *camera,
                        int (*each)(void *user, const placido_v4l2_offer *offer), void *user) {
  int status = PLACIDO_OK;
  placido_v4l2_offer offer;
  uint32_t fourcc;
  for (uint32_t i = 0; !status && i < FORMATS_MAX && format_at(&offer, &fourcc, camera, i); i++) {
    status = offer_sizes(&offer, camera, fourcc, each, user);
  }
  return status;
}

/* The best of the offers seen so far. */
struct choice {
  const placido_v4l2_request *request;
  const placido_v4l2_format *format;
  int width_px, height_px;
  bool has_size;
  bool live; /* fast enough to aim by */
};

static bool is_within(int side_px, int min_px, int max_px, int step_px) {
  return side_px >= min_px && side_px <= max_px &&
         (step_px < 2 || (side_px - min_px) % step_px == 0);
}

static bool offers_size(const placido_v4l2_offer *offer, const placido_v4l2_request *request) {
  return request->width_px == 0 ||
         (is_within(request->width_px, offer->width_min_px, offer->width_max_px,
                    offer->width_step_px) &&
          is_within(request->height_px, offer->height_min_px, offer->height_max_px,
                    offer->height_step_px));
}

/* Negative where `a` is to be preferred: what was asked first, then the table's order. */
static int compare_formats(const placido_v4l2_format *a, const placido_v4l2_format *b,
                           const placido_v4l2_request *request) {
  if ((a == request->format) != (b == request->format)) {
    return a == request->format ? -1 : 1;
  }
  return a < b ? -1 : a > b;
}

/* Whether the offer comes fast enough to aim by; one that tells no rate is believed to. */
static bool is_live(const placido_v4l2_offer *offer) {
  double fastest = offer->rate_count ? 0 : LIVE_HZ;
  for (int i = 0; i < offer->rate_count; i++) {
    fastest = fmax(fastest, offer->rates_hz[i]);
  }
  return fastest >= LIVE_HZ;
}

/* A format that was asked for comes before the size, the size before the order of formats; among
 * equals the largest picture wins that comes fast enough to aim by. */
static int weigh(void *user, const placido_v4l2_offer *offer) {
  struct choice *best = user;
  const placido_v4l2_request *request = best->request;
  if (!offer->format || !placido_v4l2_is_readable(offer->format)) {
    return 0;
  }
  const bool has_size = offers_size(offer, request);
  const bool is_fixed = offer->width_min_px == offer->width_max_px &&
                        offer->height_min_px == offer->height_max_px;
  bool is_better = true;
  if (best->format) {
    const int by_format = compare_formats(offer->format, best->format, request);
    const bool asked = (offer->format == request->format) != (best->format == request->format);
    const bool live = is_live(offer);
    const long area = is_fixed ? (long)offer->width_max_px * offer->height_max_px : 0;
    is_better = asked                        ? by_format < 0
                : has_size != best->has_size ? has_size
                : by_format != 0             ? by_format < 0
                : live != best->live         ? live
                                             : area > (long)best->width_px * best->height_px;
  }
  if (is_better) {
    best->format = offer->format;
    /* The end of a range is what the kernel's driver could take, not what a sensor has. */
    best->width_px = is_fixed ? offer->width_max_px : 0;
    best->height_px = is_fixed ? offer->height_max_px : 0;
    best->has_size = has_size;
    best->live = is_live(offer);
  }
  return 0;
}

/* A camera that lists formats but no sizes: the best format, at the size it is set to. */
static void weigh_without_sizes(struct choice *best, const placido_v4l2_camera *camera) {
  placido_v4l2_offer offer;
  uint32_t fourcc;
  for (uint32_t i = 0; i < FORMATS_MAX && format_at(&offer, &fourcc, camera, i); i++) {
    if (offer.format && placido_v4l2_is_readable(offer.format) &&
        (!best->format || compare_formats(offer.format, best->format, best->request) < 0)) {
      best->format = offer.format;
    }
  }
}

static int choose(struct choice *best, const placido_v4l2_camera *camera,
                  const placido_v4l2_request *request, placido_error *err) {
  *best = (struct choice){.request = request};
  placido_v4l2_offers(camera, weigh, best);
  if (!best->format) {
    weigh_without_sizes(best, camera);
  }
  if (best->format) {
    return PLACIDO_OK;
  }
  char names[64] = "";
  size_t length = 0;
  placido_v4l2_offer offer;
  uint32_t fourcc;
  for (uint32_t i = 0; i < 6 && format_at(&offer, &fourcc, camera, i); i++) {
    length += (size_t)snprintf(names + length, sizeof names - length, " %s", offer.name);
  }
  return placido_error_set(err, PLACIDO_UNSUPPORTED,
                           "the camera %s offers%s, of which this build can read none",
                           camera->card, names[0] ? names : " no format");
}

/* The two layouts of a format, single-planar and multiplanar, as one. */
struct layout {
  uint32_t width, height, fourcc, stride, size, field, planes;
};

static int set_format(struct layout *layout, const placido_v4l2_camera *camera) {
  struct v4l2_format said = {.type = camera->type};
  int code = placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_G_FMT, &said);
  said.type = camera->type;
  struct v4l2_pix_format *pix = &said.fmt.pix;
  struct v4l2_pix_format_mplane *planes = &said.fmt.pix_mp;
  if (!code && camera->is_multiplanar) {
    planes->width = layout->width ? layout->width : planes->width;
    planes->height = layout->height ? layout->height : planes->height;
    planes->pixelformat = layout->fourcc;
    planes->field = V4L2_FIELD_NONE;
    planes->num_planes = 1;
    planes->plane_fmt[0].bytesperline = planes->plane_fmt[0].sizeimage = 0;
  } else if (!code) {
    pix->width = layout->width ? layout->width : pix->width;
    pix->height = layout->height ? layout->height : pix->height;
    pix->pixelformat = layout->fourcc;
    pix->field = V4L2_FIELD_NONE;
    pix->bytesperline = pix->sizeimage = 0;
  }
  code = code ? code : placido_v4l2_ioctl(camera->calls, camera->fd, VIDIOC_S_FMT, &said);
  if (camera->is_multiplanar) {
    *layout = (struct layout){planes->width,       planes->height,
                              planes->pixelformat, planes->plane_fmt[0].bytesperline,
                              planes->plane_fmt[0].sizeimage, planes->field,
                              planes->num_planes};
  } else {
    *layout = (struct layout){pix->width,     pix->height, pix->pixelformat, pix->bytesperline,
                              pix->sizeimage, pix->field,  1};
  }
  return code;
}

/* Believes nothing that the camera's driver says of its picture before it is bounded. */
static int take_layout(placido_v4l2_mode *mode, const struct layout *layout,
                       const placido_v4l2_camera *camera, placido_error *err) {
  char name[8];
  name_fourcc(name, layout->fourcc);
  mode->format = placido_v4l2_format_of(layout->fourcc);
  if (!mode->format || !placido_v4l2_is_readable(mode->format)) {
    return placido_error_set(err, PLACIDO_UNSUPPORTED,
                             "the camera %s insists on the format %s, which this build cannot read",
                             camera->card, name);
  }
  if (!is_side(layout->width) || !is_side(layout->height) || layout->planes != 1) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "the camera %s claims pictures of %u x %u pixels in %u planes",
                             camera->card, layout->width, layout->height, layout->planes);
  }
  mode->width_px = (int)layout->width;
  mode->height_px = (int)layout->height;
  const size_t row_bytes = placido_v4l2_row_bytes(mode->format, mode->width_px);
  mode->stride_bytes = layout->stride ? layout->stride : row_bytes;
  if (mode->stride_bytes < row_bytes ||
      mode->stride_bytes > PLACIDO_V4L2_PICTURE_MAX_BYTES / layout->height ||
      layout->size > PLACIDO_V4L2_PICTURE_MAX_BYTES) {
    return placido_error_set(err, PLACIDO_SYSTEM,
                             "the camera %s claims rows of %zu bytes and pictures of %u for %u x "
                             "%u pixels of %s",
                             camera->card, mode->stride_bytes, layout->size, layout->width,
                             layout->height, mode->format->name);
  }
  const bool is_compressed = row_bytes == 0;
  mode->picture_bytes =
      is_compressed ? 0 : mode->stride_bytes * (layout->height - 1) + row_bytes;
  /* No JPEG of a camera takes more than two bytes a pixel. */
  const size_t least =
      is_compressed ? 2 * (size_t)layout->width * layout->height : mode->picture_bytes;
  mode->buffer_bytes = layout->size > least ? layout->size : least;
  return PLACIDO_OK;
}

static void note_differences(const placido_v4l2_mode *mode, const placido_v4l2_camera *camera,
                             const placido_v4l2_request *request, placido_notes *notes) {
  if (request->format && mode->format != request->format) {
    placido_notes_add(notes, "the camera %s gives %s, not %s as asked", camera->card,
                      mode->format->name, request->format->name);
  }
  if (request->width_px > 0 &&
      (mode->width_px != request->width_px || mode->height_px != request->height_px)) {
    placido_notes_add(notes, "the camera %s gives %d x %d pixels, not %d x %d as asked",
                      camera->card, mode->width_px, mode->height_px, request->width_px,
                      request->height_px);
  }
  /* Intervals are fractions: 30 frames/s may come back as 29.97. Half a percent is the same. */
  if (request->rate_hz > 0 && !(fabs(mode->rate_hz / request->rate_hz - 1) <= 0.005)) {
    if (isnan(mode->rate_hz)) {
      placido_notes_add(notes, "the camera %s has no frame rate to set (%g/s was asked)",
                        camera->card, request->rate_hz);
    } else {
      placido_notes_add(notes, "the camera %s gives %.4g frames/s, not %g as asked", camera->card,
                        mode->rate_hz, request->rate_hz);
    }
  }
}

int placido_v4l2_mode_set(placido_v4l2_mode *mode, const placido_v4l2_camera *camera,
                          const placido_v4l2_request *request, placido_notes *notes,
                          placido_error *err) {
  *mode = (placido_v4l2_mode){.rate_hz = NAN};
  struct choice best;
  int status = choose(&best, camera, request, err);
  if (status) {
    return status;
  }
  const bool asks_size = request->width_px > 0;
  struct layout layout = {
      .width = (uint32_t)(asks_size ? request->width_px : best.width_px),
      .height = (uint32_t)(asks_size ? request->height_px : best.height_px),
      .fourcc = best.format->fourcc};
  const int code = set_format(&layout, camera);
  if (code) {
    return placido_v4l2_camera_failed(camera, "setting the format of", code, err);
  }
  status = take_layout(mode, &layout, camera, err);
  if (status) {
    return status;
  }
  if (layout.field != V4L2_FIELD_NONE && layout.field != V4L2_FIELD_ANY) {
    placido_notes_add(notes, "the camera %s gives interlaced pictures: moving mires will be torn",
                      camera->card);
  }
  placido_v4l2_rate_choose(camera, mode, request);
  mode->rate_hz = placido_v4l2_rate(camera);
  note_differences(mode, camera, request, notes);
  return PLACIDO_OK;
}
