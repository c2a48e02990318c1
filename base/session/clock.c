/* What the times and counters of a session's frames tell: gaps, rate and jitter. */
#include "base/session/clock.h"

#include "base/memory.h"

#include <math.h>

#define NS_PER_S 1e9
#define NS_PER_MS 1e6

typedef struct placido_tick {
  int64_t index, t_ns;
  uint64_t seq;
} placido_tick;

int placido_clock_add(placido_clock *clock, const placido_frame_info *frame, placido_error *err) {
  placido_tick *grown = clock->ticks;
  if ((clock->count & (clock->count - 1)) == 0) { /* room for 1, 2, 4, 8 ... */
    const size_t room = clock->count ? 2 * clock->count : 1;
    grown = placido_memory_grow(clock->ticks, room, sizeof *grown, err);
  }
  if (!grown) {
    return PLACIDO_MEMORY;
  }
  clock->ticks = grown;
  clock->ticks[clock->count++] =
      (placido_tick){.index = frame->index, .t_ns = frame->t_ns, .seq = frame->seq};
  return PLACIDO_OK;
}

static int count_gaps(placido_clock_figures *figures, const placido_clock *clock,
                      placido_ranges *gaps, placido_error *err) {
  int status = PLACIDO_OK;
  for (size_t i = 1; !status && i < clock->count; i++) {
    const placido_tick *last = &clock->ticks[i - 1], *tick = &clock->ticks[i];
    const uint64_t passed = (uint64_t)(tick->index - last->index);
    if (tick->seq <= last->seq) {
      figures->restarts++;
    } else if (tick->seq - last->seq > passed) {
      const int64_t left_out = (int64_t)(tick->seq - last->seq - passed);
      figures->missing =
          left_out < INT64_MAX - figures->missing ? figures->missing + left_out : INT64_MAX;
      status = gaps ? placido_ranges_add(gaps, tick->index, err) : PLACIDO_OK;
    }
  }
  return status;
}

/* Frames of the camera's from one tick to the next; 1 where its counter does not tell. */
static double steps_between(const placido_tick *last, const placido_tick *tick) {
  return tick->seq > last->seq ? (double)(tick->seq - last->seq) : 1.0;
}

static void measure(placido_clock_figures *figures, const placido_clock *clock) {
  double steps = 0, squares = 0, longest_ns = 0;
  for (size_t i = 1; i < clock->count; i++) {
    const placido_tick *last = &clock->ticks[i - 1], *tick = &clock->ticks[i];
    const double step_ns = (double)(tick->t_ns - last->t_ns);
    figures->backwards += step_ns <= 0;
    longest_ns = fmax(longest_ns, step_ns);
    steps += steps_between(last, tick);
  }
  const double span_ns = (double)(clock->ticks[clock->count - 1].t_ns - clock->ticks[0].t_ns);
  for (size_t i = 1; i < clock->count; i++) {
    const placido_tick *last = &clock->ticks[i - 1], *tick = &clock->ticks[i];
    const double expected_ns = span_ns / steps * steps_between(last, tick);
    squares += pow((double)(tick->t_ns - last->t_ns) - expected_ns, 2);
  }
  figures->seconds = span_ns / NS_PER_S;
  figures->rate_hz = span_ns > 0 ? steps * NS_PER_S / span_ns : NAN;
  figures->jitter_ms = sqrt(squares / (double)(clock->count - 1)) / NS_PER_MS;
  figures->longest_ms = longest_ns / NS_PER_MS;
}

int placido_clock_read(placido_clock_figures *figures, const placido_clock *clock,
                       placido_ranges *gaps, placido_error *err) {
  *figures = (placido_clock_figures){
      .seconds = NAN, .rate_hz = NAN, .jitter_ms = NAN, .longest_ms = NAN};
  bool known = false;
  for (size_t i = 0; i < clock->count; i++) {
    known = known || clock->ticks[i].t_ns != 0;
  }
  if (clock->count > 1 && known) {
    measure(figures, clock);
  }
  return count_gaps(figures, clock, gaps, err);
}

void placido_clock_free(placido_clock *clock) {
  placido_memory_free(clock->ticks);
  *clock = (placido_clock){0};
}
