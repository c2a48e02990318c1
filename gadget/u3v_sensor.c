/* The sensor of the simulated USB3 Vision camera: exposes when it is time or when it is triggered,
 * and makes samples of what it saw, brighter or darker by gain and exposure time. */
#include "gadget/u3v_camera.h"

#include <math.h>
#include <string.h>

void placido_u3v_sensor_start(placido_u3v_camera *camera) {
  if (camera->is_acquiring) {
    return;
  }
  camera->is_acquiring = true;
  camera->is_exposing = false;
  camera->next_ns = camera->now_ns;
  camera->next_id = 0;
  placido_u3v_stream_flush(camera);
}

void placido_u3v_sensor_stop(placido_u3v_camera *camera) {
  camera->is_acquiring = camera->is_exposing = false;
}

static void begin_exposure(placido_u3v_camera *camera, int64_t at_ns) {
  camera->is_exposing = true;
  camera->exposure_us = placido_u3v_exposure_us(camera);
  camera->exposure_start_ns = at_ns;
  camera->exposure_end_ns = at_ns + llround(camera->exposure_us * 1000.0);
}

void placido_u3v_sensor_trigger(placido_u3v_camera *camera) {
  const uint32_t trigger = placido_u3v_feature(camera, PLACIDO_U3V_TRIGGER);
  if (camera->is_acquiring && !camera->is_exposing && trigger & PLACIDO_U3V_TRIGGER_ON &&
      !(trigger & PLACIDO_U3V_TRIGGER_LINE)) {
    begin_exposure(camera, camera->now_ns);
  }
}

/* What becomes of each grey level. False: it stays as it is. */
static bool make_curve(placido_u3v_camera *camera, int bits) {
  const double full = (double)((1 << bits) - 1);
  const double gain = pow(10.0, placido_u3v_gain_db(camera) / 20.0) * camera->exposure_us /
                      camera->nominal_exposure_us;
  const double black =
      placido_u3v_feature(camera, PLACIDO_U3V_BLACK_LEVEL) * (double)(1 << (bits - 8));
  if (gain == 1.0 && black == 0.0) {
    return false;
  }
  if (gain != camera->curve_gain || black != camera->curve_black) {
    for (int i = 0; i < 1 << bits; i++) {
      camera->curve[i] = (uint16_t)lround(fmin(full, i * gain + black));
    }
    camera->curve_gain = gain;
    camera->curve_black = black;
  }
  return true;
}

/* The picture's part of a view, without copying. */
static placido_frame cut_out(const placido_u3v_camera *camera, const placido_frame *seen) {
  placido_frame part = *seen;
  const size_t x_px = placido_u3v_feature(camera, PLACIDO_U3V_OFFSET_X);
  const size_t y_px = placido_u3v_feature(camera, PLACIDO_U3V_OFFSET_Y);
  part.data = seen->data + y_px * seen->stride_bytes + x_px * placido_format_bytes(seen->format);
  part.width_px = (int)placido_u3v_feature(camera, PLACIDO_U3V_WIDTH);
  part.height_px = (int)placido_u3v_feature(camera, PLACIDO_U3V_HEIGHT);
  part.capacity = 0;
  return part;
}

/* The part through the curve; the frame of the camera takes it. */
static int expose(placido_u3v_camera *camera, const placido_frame *part) {
  placido_frame *exposed = &camera->exposed;
  const int status =
      placido_frame_resize(exposed, part->width_px, part->height_px, part->format, NULL);
  exposed->bits = part->bits;
  for (int y = 0; y < part->height_px && status == PLACIDO_OK; y++) {
    const uint8_t *from = part->data + (size_t)y * part->stride_bytes;
    uint8_t *to = exposed->data + (size_t)y * exposed->stride_bytes;
    for (int x = 0; x < part->width_px && part->format == PLACIDO_MONO8; x++) {
      to[x] = (uint8_t)camera->curve[from[x]];
    }
    for (int x = 0; x < part->width_px && part->format == PLACIDO_MONO16; x++) {
      const uint16_t level = ((const uint16_t *)(const void *)from)[x];
      ((uint16_t *)(void *)to)[x] = camera->curve[level & ((1u << part->bits) - 1)];
    }
  }
  return status;
}

static bool take_samples(placido_u3v_camera *camera, placido_u3v_picture *picture) {
  const placido_frame *seen = camera->view.look(camera->view.user, camera->exposure_start_ns);
  if (!seen || seen->width_px != camera->view.width_px ||
      seen->height_px != camera->view.height_px || seen->format == PLACIDO_RGB8) {
    return false;
  }
  placido_frame part = cut_out(camera, seen);
  if (make_curve(camera, part.bits)) {
    if (expose(camera, &part) != PLACIDO_OK) {
      return false;
    }
    part = camera->exposed;
    part.capacity = 0;
  }
  return placido_pixel_from_frame(picture->samples, placido_u3v_format(camera), &part, NULL) ==
         PLACIDO_OK;
}

static void describe(placido_u3v_camera *camera, placido_u3v_picture *picture, uint64_t id) {
  const uint32_t height_px = placido_u3v_feature(camera, PLACIDO_U3V_HEIGHT);
  picture->size = placido_u3v_payload_bytes(camera);
  picture->leader = (placido_u3v_leader){
      .frame_id = id,
      .payload_type = PLACIDO_U3V_PAYLOAD_IMAGE,
      .timestamp_ns = (uint64_t)(camera->exposure_start_ns - camera->power_up_ns),
      .pixel_format = placido_u3v_feature(camera, PLACIDO_U3V_PIXEL_FORMAT),
      .width_px = placido_u3v_feature(camera, PLACIDO_U3V_WIDTH),
      .height_px = height_px,
      .offset_x_px = placido_u3v_feature(camera, PLACIDO_U3V_OFFSET_X),
      .offset_y_px = placido_u3v_feature(camera, PLACIDO_U3V_OFFSET_Y),
  };
  picture->trailer = (placido_u3v_trailer){
      .frame_id = id, .payload_bytes = picture->size, .height_px = height_px};
  picture->has_leader = picture->has_trailer = true;
  picture->stalls = false;
  picture->ready_ns = camera->exposure_end_ns + camera->faults->slow_ms * INT64_C(1000000);
}

/* A picture has the first fault that is still to come. */
static void spoil(placido_u3v_camera *camera, placido_u3v_picture *picture) {
  if (placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_STALL)) {
    picture->stalls = true;
  } else if (placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_CORRUPT)) {
    memset(picture->samples + picture->size / 3, 0xAA, picture->size / 16);
    picture->trailer.status = 0xA100; /* data discarded */
  } else if (placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_TRUNCATE)) {
    picture->size /= 2;
    picture->trailer.payload_bytes = picture->size;
    picture->trailer.height_px /= 2;
  } else if (placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_MISNUMBER)) {
    picture->trailer.frame_id++;
  } else if (placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_LOST_START)) {
    picture->has_leader = false;
  } else if (placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_LOST_END)) {
    picture->has_trailer = false;
  }
}

/* Every picture has its number, sent or not. */
static void finish_exposure(placido_u3v_camera *camera) {
  const uint64_t id = camera->next_id++;
  placido_u3v_picture *picture = placido_u3v_stream_room(camera);
  camera->is_exposing = false;
  if (!picture || placido_u3v_fault(camera, PLACIDO_GADGET_FAULT_DROP) ||
      !take_samples(camera, picture)) {
    camera->statistics.dropped++;
  } else {
    describe(camera, picture, id);
    spoil(camera, picture);
    placido_u3v_stream_push(camera);
  }
  if (placido_u3v_feature(camera, PLACIDO_U3V_ACQUISITION_MODE) == PLACIDO_U3V_SINGLE_FRAME) {
    placido_u3v_sensor_stop(camera);
  }
}

/* The clock of the sensor does not run faster to make up for a computer that was held up. */
static void begin_when_due(placido_u3v_camera *camera) {
  const int64_t period_ns = llround(1e9 / placido_u3v_rate_hz(camera));
  const bool is_late = camera->now_ns - camera->next_ns > period_ns;
  const int64_t at_ns = is_late ? camera->now_ns : camera->next_ns;
  begin_exposure(camera, at_ns);
  camera->next_ns = at_ns + period_ns;
}

int64_t placido_u3v_sensor_tick(placido_u3v_camera *camera) {
  for (;;) {
    const bool is_triggered =
        placido_u3v_feature(camera, PLACIDO_U3V_TRIGGER) & PLACIDO_U3V_TRIGGER_ON;
    if (camera->is_exposing && camera->now_ns >= camera->exposure_end_ns) {
      finish_exposure(camera);
    } else if (camera->is_exposing) {
      return camera->exposure_end_ns;
    } else if (!camera->is_acquiring || is_triggered) {
      return INT64_MAX;
    } else if (camera->now_ns >= camera->next_ns) {
      begin_when_due(camera);
    } else {
      return camera->next_ns;
    }
  }
}
