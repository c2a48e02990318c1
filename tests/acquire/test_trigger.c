/* The trigger: what starts a burst, how long it lasts, when the light is on. Every sequence of
 * events up to a length is tried against what must hold of all of them. */
#include "acquire/trigger.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
#include <math.h>

#define FRAME_NS 100000000LL /* ten frames a second */
#define ALL (PLACIDO_TRIGGER_KEY | PLACIDO_TRIGGER_PEDAL | PLACIDO_TRIGGER_AUTO)

static const placido_trigger_settings plain = {
    .sources = ALL, .burst = 3, .warm_up = 2, .score_min = 0.5, .hold_s = 0.2, .rest_s = 1.0};

/* A trigger with its own count of frames. */
struct run {
  placido_trigger trigger;
  int64_t t_ns;
};

static struct run start(const placido_trigger_settings *settings) {
  struct run run = {.t_ns = 5000000000LL};
  placido_trigger_start(&run.trigger, settings);
  return run;
}

static placido_trigger_action step(struct run *run, double score, unsigned fired) {
  run->t_ns += FRAME_NS;
  return placido_trigger_frame(&run->trigger, run->t_ns, score, fired);
}

static void assert_quiet(placido_trigger_action action) {
  assert_false(action.light_on || action.light_off || action.take || action.finished);
}

/* Light on, warm_up frames, burst frames, light off. */
static void assert_burst(struct run *run, double score) {
  const int warm_up = run->trigger.settings.warm_up, burst = run->trigger.settings.burst;
  for (int i = 0; i < warm_up; i++) {
    assert_quiet(step(run, score, 0));
    assert_true(run->trigger.is_lit);
  }
  for (int i = 0; i < burst; i++) {
    const placido_trigger_action action = step(run, score, 0);
    assert_true(action.take);
    assert_int_equal(action.first, i == 0);
    assert_int_equal(action.last, i == burst - 1);
    assert_int_equal(action.light_off, i == burst - 1);
    assert_int_equal(run->trigger.is_lit, i < burst - 1);
  }
}

static void test_nothing_comes_of_nothing(void **state) {
  (void)state;
  struct run run = start(&plain);
  for (int i = 0; i < 100; i++) {
    assert_quiet(step(&run, NAN, 0));
  }
}

static void test_key_and_pedal_start_a_burst(void **state) {
  (void)state;
  const unsigned sources[] = {PLACIDO_TRIGGER_KEY, PLACIDO_TRIGGER_PEDAL};
  for (int i = 0; i < 2; i++) {
    struct run run = start(&plain);
    assert_quiet(step(&run, NAN, 0));
    const placido_trigger_action action = step(&run, NAN, sources[i]);
    assert_true(action.light_on);
    assert_false(action.take); /* it was exposed before the light came on */
    assert_int_equal(action.source, sources[i]);
    assert_burst(&run, NAN);
    assert_quiet(step(&run, NAN, 0));
  }
}

static void test_a_source_not_asked_for_is_ignored(void **state) {
  (void)state;
  placido_trigger_settings settings = plain;
  settings.sources = PLACIDO_TRIGGER_PEDAL;
  struct run run = start(&settings);
  for (int i = 0; i < 20; i++) {
    assert_quiet(step(&run, 1.0, PLACIDO_TRIGGER_KEY));
  }
  assert_true(step(&run, 1.0, PLACIDO_TRIGGER_KEY | PLACIDO_TRIGGER_PEDAL).light_on);
}

static void test_automatic_wants_the_score_held(void **state) {
  (void)state;
  struct run run = start(&plain);
  assert_quiet(step(&run, 0.5, 0)); /* 0 s: just good enough counts */
  assert_quiet(step(&run, 0.6, 0)); /* 0.1 s */
  assert_quiet(step(&run, 0.49, 0));
  assert_quiet(step(&run, 0.9, 0));
  assert_quiet(step(&run, NAN, 0)); /* not known: begins anew */
  assert_quiet(step(&run, 0.9, 0));
  assert_quiet(step(&run, 0.9, 0));
  const placido_trigger_action action = step(&run, 0.9, 0); /* 0.2 s */
  assert_true(action.light_on);
  assert_int_equal(action.source, PLACIDO_TRIGGER_AUTO);
  assert_burst(&run, 0.9);
}

/* The key does not wait for the rest to be over. */
static void test_automatic_rests_after_a_burst(void **state) {
  (void)state;
  struct run run = start(&plain);
  step(&run, NAN, PLACIDO_TRIGGER_KEY);
  assert_burst(&run, 0.9);
  for (int i = 0; i < 9; i++) {
    assert_quiet(step(&run, 0.9, 0));
  }
  assert_int_equal(step(&run, 0.9, 0).source, PLACIDO_TRIGGER_AUTO); /* 1.0 s */
  assert_burst(&run, 0.9);
  assert_int_equal(step(&run, 0.9, PLACIDO_TRIGGER_KEY).source, PLACIDO_TRIGGER_KEY);
}

static void test_bursts_are_counted(void **state) {
  (void)state;
  placido_trigger_settings settings = plain;
  settings.bursts = 2;
  settings.warm_up = 0;
  struct run run = start(&settings);
  step(&run, NAN, PLACIDO_TRIGGER_KEY);
  step(&run, NAN, PLACIDO_TRIGGER_KEY); /* while one runs: ignored */
  step(&run, NAN, PLACIDO_TRIGGER_KEY);
  assert_false(step(&run, NAN, 0).finished);
  assert_quiet(step(&run, NAN, 0));
  step(&run, NAN, PLACIDO_TRIGGER_KEY);
  step(&run, NAN, 0);
  step(&run, NAN, 0);
  const placido_trigger_action last = step(&run, NAN, 0);
  assert_true(last.last && last.light_off && last.finished);
  const placido_trigger_action after = step(&run, NAN, ALL);
  assert_true(after.finished);
  assert_false(after.light_on || after.take);
}

static void test_one_frame_is_first_and_last(void **state) {
  (void)state;
  placido_trigger_settings settings = plain;
  settings.burst = 1;
  settings.warm_up = 0;
  struct run run = start(&settings);
  step(&run, NAN, PLACIDO_TRIGGER_KEY);
  const placido_trigger_action action = step(&run, NAN, 0);
  assert_true(action.take && action.first && action.last && action.light_off);
}

/* What a frame may bring, of which every sequence of DEPTH is tried. */
static const struct {
  unsigned fired;
  double score;
} inputs[] = {{0, NAN}, {PLACIDO_TRIGGER_KEY, 0.2}, {PLACIDO_TRIGGER_PEDAL, 0.7}, {0, 0.7}};
enum { DEPTH = 8, INPUTS = sizeof inputs / sizeof *inputs };

/* What must hold in any case: the light goes on and off in turn, frames are taken with it on only,
 * and after the last warm-up frame without a gap until the burst is whole. */
struct audit {
  bool is_lit;
  int warm_left, taken, bursts;
};

static void check(struct audit *audit, const placido_trigger_settings *settings,
                  placido_trigger_action action, bool is_lit) {
  const bool in_burst = audit->is_lit;
  assert_int_equal(action.take, in_burst && audit->warm_left == 0);
  assert_false(action.light_on && in_burst);
  assert_false(action.light_on && action.finished);
  assert_int_equal(action.light_on, action.source != 0);
  if (in_burst && !action.take) {
    audit->warm_left--;
  }
  if (action.take) {
    assert_int_equal(action.first, audit->taken == 0);
    audit->taken++;
    assert_int_equal(action.last, audit->taken == settings->burst);
  }
  assert_int_equal(action.light_off, action.last);
  if (action.light_on) {
    *audit = (struct audit){.is_lit = true, .warm_left = settings->warm_up,
                            .bursts = audit->bursts};
  }
  if (action.last) {
    audit->is_lit = false;
    audit->bursts++;
  }
  assert_int_equal(is_lit, audit->is_lit);
  assert_int_equal(action.finished, settings->bursts > 0 && audit->bursts >= settings->bursts &&
                                        !audit->is_lit);
}

static void try_sequence(const placido_trigger_settings *settings, unsigned sequence) {
  struct run run = start(settings);
  struct audit audit = {0};
  for (int i = 0; i < DEPTH; i++, sequence /= INPUTS) {
    const unsigned input = sequence % INPUTS;
    const placido_trigger_action action = step(&run, inputs[input].score, inputs[input].fired);
    check(&audit, settings, action, run.trigger.is_lit);
    if (inputs[input].fired & settings->sources && !audit.is_lit && !action.take) {
      assert_true(action.finished); /* a person is only refused when no burst is left */
    }
  }
  assert_int_equal(run.trigger.bursts_done, audit.bursts);
}

static void test_every_sequence_keeps_the_rules(void **state) {
  (void)state;
  unsigned sequences = 1;
  for (int i = 0; i < DEPTH; i++) {
    sequences *= INPUTS;
  }
  for (unsigned variant = 0; variant < 16; variant++) {
    const placido_trigger_settings settings = {
        .sources = variant & 1 ? ALL : PLACIDO_TRIGGER_KEY | PLACIDO_TRIGGER_AUTO,
        .burst = variant & 2 ? 1 : 2,
        .warm_up = variant & 4 ? 0 : 1,
        .score_min = 0.5,
        .hold_s = 0.1,
        .rest_s = variant & 1 ? 0.0 : 0.3,
        .bursts = variant & 8 ? 2 : 0};
    for (unsigned sequence = 0; sequence < sequences; sequence++) {
      try_sequence(&settings, sequence);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_nothing_comes_of_nothing),
      cmocka_unit_test(test_key_and_pedal_start_a_burst),
      cmocka_unit_test(test_a_source_not_asked_for_is_ignored),
      cmocka_unit_test(test_automatic_wants_the_score_held),
      cmocka_unit_test(test_automatic_rests_after_a_burst),
      cmocka_unit_test(test_bursts_are_counted),
      cmocka_unit_test(test_one_frame_is_first_and_last),
      cmocka_unit_test(test_every_sequence_keeps_the_rules),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
