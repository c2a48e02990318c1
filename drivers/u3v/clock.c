/* The camera's clock read on ours: latched between two looks at ours, whose middle is taken. */
#include "drivers/u3v/clock.h"

#include "drivers/u3v/wire/registers.h"

#define LOOK_EVERY_NS 5000000000
#define FIRST_LOOKS 3
/* A look that took much longer than the one before tells less than is known already. */
#define SLACK_NS 1000000
/* A picture may have been exposed before the stream began, where that took a moment. */
#define EARLY_NS 1000000000

static int64_t now_ns(const placido_u3v_channel *channel) {
  return channel->calls->clock_ns(channel->calls->context);
}

/* One look at both clocks. Returns the channel's status. */
static int latch(placido_u3v_channel *channel, uint64_t *camera_ns, int64_t *middle_ns,
                 int64_t *trip_ns) {
  const int64_t before_ns = now_ns(channel);
  int status = placido_u3v_channel_write_u32(channel, PLACIDO_ABRM_TIMESTAMP_LATCH, 1, NULL);
  const int64_t after_ns = now_ns(channel);
  *trip_ns = after_ns - before_ns;
  *middle_ns = before_ns + *trip_ns / 2;
  return status ? status
                : placido_u3v_channel_read_u64(channel, PLACIDO_ABRM_TIMESTAMP, camera_ns, NULL);
}

/* Looks once; the offset is replaced where the look took at most `limit_ns`. */
static int look(placido_u3v_clock *clock, placido_u3v_channel *channel, int64_t limit_ns,
                placido_error *err) {
  uint64_t camera_ns = 0;
  int64_t middle_ns, trip_ns;
  const int status = latch(channel, &camera_ns, &middle_ns, &trip_ns);
  if (status == PLACIDO_GONE) {
    return placido_error_set(err, PLACIDO_GONE, "the camera was unplugged");
  }
  if (status || camera_ns == 0) {
    clock->is_absent = !clock->is_known;
  } else if (!clock->is_known || trip_ns <= limit_ns) {
    clock->is_known = true;
    clock->trip_ns = trip_ns;
    clock->offset_ns = (int64_t)((uint64_t)middle_ns - camera_ns);
  }
  return PLACIDO_OK;
}

int placido_u3v_clock_begin(placido_u3v_clock *clock, placido_u3v_channel *channel,
                            placido_error *err) {
  *clock = (placido_u3v_clock){.last_ns = clock->last_ns, .begin_ns = now_ns(channel)};
  int status = PLACIDO_OK;
  for (int i = 0; !status && i < FIRST_LOOKS && !clock->is_absent; i++) {
    status = look(clock, channel, clock->trip_ns, err);
  }
  clock->next_ns = now_ns(channel) + LOOK_EVERY_NS;
  return status;
}

int placido_u3v_clock_look(placido_u3v_clock *clock, placido_u3v_channel *channel,
                           placido_error *err) {
  if (clock->is_absent || now_ns(channel) < clock->next_ns) {
    return PLACIDO_OK;
  }
  const int status = look(clock, channel, 2 * clock->trip_ns + SLACK_NS, err);
  clock->next_ns = now_ns(channel) + LOOK_EVERY_NS;
  return status;
}

int64_t placido_u3v_clock_time(placido_u3v_clock *clock, uint64_t camera_ns, int64_t arrival_ns) {
  const int64_t mapped_ns = (int64_t)(camera_ns + (uint64_t)clock->offset_ns);
  const bool is_possible = clock->is_known && mapped_ns >= clock->begin_ns - EARLY_NS &&
                           mapped_ns <= arrival_ns + clock->trip_ns;
  int64_t time_ns = is_possible ? mapped_ns : arrival_ns;
  if (time_ns <= clock->last_ns) {
    time_ns = clock->last_ns + 1;
  }
  clock->last_ns = time_ns;
  return time_ns;
}
