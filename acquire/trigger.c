/* When a burst begins and ends: idle, warming up, in a burst, and idle again. */
#include "acquire/trigger.h"

#define NS_PER_S 1e9

const char *placido_trigger_name(unsigned source) {
  return source == PLACIDO_TRIGGER_KEY ? "key" : source == PLACIDO_TRIGGER_PEDAL ? "pedal" : "auto";
}

void placido_trigger_start(placido_trigger *trigger, const placido_trigger_settings *settings) {
  *trigger = (placido_trigger){.settings = *settings};
}

/* Follows the score, in a burst as well: whoever holds still through it need not begin anew. */
static void follow_score(placido_trigger *trigger, int64_t t_ns, double score) {
  const bool is_good = score >= trigger->settings.score_min; /* false for NaN */
  if (is_good && !trigger->is_good) {
    trigger->good_since_ns = t_ns;
  }
  trigger->is_good = is_good;
}

static bool is_held(const placido_trigger *trigger, int64_t t_ns) {
  const double held_s = (double)(t_ns - trigger->good_since_ns) / NS_PER_S;
  const bool rests = trigger->rests && t_ns < trigger->rests_until_ns;
  return trigger->is_good && !rests && held_s >= trigger->settings.hold_s;
}

/* The source that starts a burst now, 0: none. A person goes before the automaton. */
static unsigned choose_source(const placido_trigger *trigger, int64_t t_ns, unsigned fired) {
  const unsigned wanted = trigger->settings.sources;
  const unsigned by_hand = fired & wanted & (PLACIDO_TRIGGER_KEY | PLACIDO_TRIGGER_PEDAL);
  if (by_hand) {
    return by_hand & PLACIDO_TRIGGER_KEY ? PLACIDO_TRIGGER_KEY : PLACIDO_TRIGGER_PEDAL;
  }
  return wanted & PLACIDO_TRIGGER_AUTO && is_held(trigger, t_ns) ? PLACIDO_TRIGGER_AUTO : 0;
}

static bool is_finished(const placido_trigger *trigger) {
  return trigger->settings.bursts > 0 && trigger->bursts_done >= trigger->settings.bursts;
}

static placido_trigger_action stay_idle(placido_trigger *trigger, int64_t t_ns, unsigned fired) {
  placido_trigger_action action = {.finished = is_finished(trigger)};
  if (action.finished) {
    return action;
  }
  action.source = choose_source(trigger, t_ns, fired);
  if (action.source) {
    action.light_on = trigger->is_lit = true;
    trigger->warm_left = trigger->settings.warm_up;
    trigger->burst_left = trigger->settings.burst;
  }
  return action;
}

static placido_trigger_action go_on(placido_trigger *trigger, int64_t t_ns) {
  if (trigger->warm_left > 0) {
    trigger->warm_left--;
    return (placido_trigger_action){0};
  }
  placido_trigger_action action = {.take = true,
                                   .first = trigger->burst_left == trigger->settings.burst};
  if (--trigger->burst_left == 0) {
    action.last = action.light_off = true;
    trigger->is_lit = false;
    trigger->bursts_done++;
    trigger->rests = true;
    trigger->rests_until_ns = t_ns + (int64_t)(trigger->settings.rest_s * NS_PER_S);
    action.finished = is_finished(trigger);
  }
  return action;
}

placido_trigger_action placido_trigger_frame(placido_trigger *trigger, int64_t t_ns, double score,
                                             unsigned fired) {
  follow_score(trigger, t_ns, score);
  return trigger->burst_left > 0 ? go_on(trigger, t_ns) : stay_idle(trigger, t_ns, fired);
}
