// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board.h"

#include "firmware/core/board_requests.h"
#include "firmware/core/flicker_advice.h"
#include "firmware/core/settings.h"
#include "firmware/core/settings_store.h"

enum {
  kStatusMs = 1000,
  kImuEvery = 8,           // of 208 a second: the host turns a frame, not a joystick
  kConfirmAfterMs = 10000  // of talking to a host: the image works
};

void board_init(board* self, const board_facts* facts, uint32_t counter) {
  self->facts = facts;
  board_time_init(&self->time, counter);
  for (unsigned i = 0; i < (unsigned)BOARD_LINKS; ++i) frame_receiver_init(&self->receiver[i]);
  self->link = 0;
  outbox_init(&self->out);
  self->settings = settings_default();
  self->stored = facts->memory != NULL && settings_load(facts->memory, &self->settings);
  self->safe = false;
  self->host_state = SYNC_HOST_IDLE;
  pulses_init(&self->train, facts->tick_hz, self->time.now);
  timecode_init(&self->code, facts->tick_hz);
  flicker_init(&self->light, (float)facts->sample_hz, 0.0f, facts->highest_code);
  gravity_init(&self->up);
  self->last_imu = self->time.now;
  self->imu_skipped = 0;
  for (unsigned i = 0; i < (unsigned)BOARD_SENSORS; ++i) temperature_init(&self->sensors[i]);
  button_init(&self->record, board_ms(self));
  update_init(&self->images, facts->memory, facts->verifier, facts->image_region_size,
              facts->slot == 0u ? FLASH_IMAGE_A : FLASH_IMAGE_B);
  self->confirmed = false;
  self->greeted = false;
  self->status_ms = board_ms(self);
  self->overruns = 0;
  board_apply(self);
}

static void send_strobe(board* self, const strobe_report* report) {
  if (report->paired) camera_guard_answered(&self->camera, board_ms(self));
  const sync_message message = {
      .type = SYNC_STROBE,
      .strobe = {.n = report->n,
                 .t_rise_board_ns = board_ns(self, report->rise),
                 .t_fall_board_ns = report->no_fall ? 0u : board_ns(self, report->fall),
                 .flags = (uint8_t)((report->paired ? SYNC_STROBE_PAIRED : 0) |
                                    (report->no_fall ? SYNC_STROBE_NO_FALL : 0) |
                                    (report->bounced ? SYNC_STROBE_DOUBLE : 0))}};
  board_send(self, &message);
}

static void watch_host(board* self) {
  if (self->safe || !host_guard_silent(&self->host, board_ms(self))) return;
  self->settings = settings_safe(&self->settings);
  self->safe = true;
  self->host_state = SYNC_HOST_IDLE;
  self->stored = false;
  pulses_configure(&self->train, &self->settings, self->time.now);
  self->restart_train = true;
}

static void confirm_image(board* self) {
  if (self->confirmed || !self->greeted || self->facts->memory == NULL) return;
  if (board_ms(self) - self->hello_ms < (uint32_t)kConfirmAfterMs || self->safe) return;
  self->confirmed = update_confirm(&self->images);
}

void board_poll(board* self, uint32_t counter) {
  strobe_report report;
  (void)board_time_update(&self->time, counter);
  pulses_advance(&self->train, self->time.now);
  if (strobe_poll(&self->camera_strobe, self->time.now, &report)) send_strobe(self, &report);
  watch_host(self);
  confirm_image(self);
  if (board_ms(self) - self->status_ms >= (uint32_t)kStatusMs) {
    self->status_ms = board_ms(self);
    board_send_status(self);
  }
}

void board_byte(board* self, uint8_t link, uint8_t byte, uint32_t counter) {
  frame_view frame;
  (void)board_time_update(&self->time, counter);
  if (!frame_receive(&self->receiver[link], byte, &frame)) return;
  if (link != self->link) {
    if (!board_is_hello(&frame)) return;
    outbox_clear(&self->out);  // what was for the host at the other end
    self->link = link;
  }
  host_guard_heard(&self->host, board_ms(self));
  board_answer(self, &frame);
}

static void take_timecode(board* self, uint64_t tick) {
  timecode_word word;
  if (!timecode_edge(&self->code, tick, &word)) return;
  if (self->settings.reference == SYNC_REFERENCE_TIMECODE) servo_edge(&self->train.reference, word.start);
  const sync_message message = {
      .type = SYNC_TIMECODE,
      .timecode = {.t_board_ns = board_ns(self, word.start),
                   .hours = word.hours,
                   .minutes = word.minutes,
                   .seconds = word.seconds,
                   .frames = word.frames,
                   .flags = (uint8_t)((word.drop_frame ? SYNC_TIMECODE_DROP_FRAME : 0) |
                                      (word.colour_frame ? SYNC_TIMECODE_COLOUR_FRAME : 0)),
                   .user_bits = word.user_bits}};
  board_send(self, &message);
}

void board_edge(board* self, board_input input, uint32_t stamp) {
  const uint64_t tick = board_time_of(&self->time, stamp);
  strobe_report report;
  switch (input) {
    case BOARD_STROBE_RISE:
    case BOARD_STROBE_FALL:
      if (strobe_poll(&self->camera_strobe, tick, &report)) send_strobe(self, &report);
      if (strobe_edge(&self->camera_strobe, tick,
                      (input == BOARD_STROBE_RISE) != (self->settings.strobe_active_low != 0u), &report))
        send_strobe(self, &report);
      break;
    case BOARD_REFERENCE:
      if (self->settings.reference == SYNC_REFERENCE_PULSE) servo_edge(&self->train.reference, tick);
      break;
    default:
      take_timecode(self, tick);
      break;
  }
}

bool board_take_pulse(board* self, uint32_t* rise, uint32_t* fall) {
  pulse next;
  if (!pulses_take(&self->train, self->time.now, &next)) return false;
  // Told now: its strobe may be captured before the loop hears that the pulse was made.
  strobe_trigger(&self->camera_strobe, next.n, next.tick);
  *rise = (uint32_t)next.tick;
  *fall = (uint32_t)(next.tick + self->train.length);
  return true;
}

void board_pulse_done(board* self, bool made) {
  pulse done;
  if (!pulses_done(&self->train, made, &done)) return;
  if (!made) {
    strobe_no_trigger(&self->camera_strobe, done.n);
    return;
  }
  const sync_message message = {.type = SYNC_TRIGGER,
                                .trigger = {.n = done.n,
                                            .t_board_ns = board_ns(self, done.tick),
                                            .phase_ns = done.phase_ns,
                                            .flags = done.flags}};
  board_send(self, &message);
}

bool board_forgets_pulses(board* self) {
  const bool forgets = self->restart_train;
  self->restart_train = false;
  return forgets;
}

static uint32_t rounded(float value, float most) {
  if (!(value > 0.0f)) return 0;
  return (uint32_t)((value < most ? value : most) + 0.5f);
}

static const float kMost = 4294967040.0f;  // the largest float that a uint32_t holds

static void send_light(board* self, const flicker_result* light) {
  const sync_configuration* s = &self->settings;
  const flicker_advice advice = flicker_advise(light, (float)s->rate_numerator / (float)s->rate_denominator,
                                               (float)s->exposure_ns * 1e-9f);
  sync_message message = {.type = SYNC_PHOTODIODE};
  sync_photodiode* said = &message.photodiode;
  said->t_board_ns = board_ns(self, self->time.now);
  said->span_us = (uint32_t)((uint64_t)FLICKER_SAMPLES * 1000000u / self->facts->sample_hz);
  said->level_mlx = rounded(light->level * (float)s->photodiode_ulx * 1e-3f, kMost);
  said->flags = (uint8_t)(SYNC_PHOTODIODE_ADVICE | (light->clipped ? SYNC_PHOTODIODE_CLIPPED : 0));
  said->frequencies = (uint8_t)light->tones;
  for (unsigned i = 0; i < light->tones; ++i) {
    said->frequency_mhz[i] = rounded(light->tone[i].hz * 1000.0f, kMost);
    said->depth_ppm[i] = rounded(light->tone[i].depth * 1e6f, kMost);
  }
  said->rate_mhz = rounded(advice.rate_hz * 1000.0f, kMost);
  said->exposure_ns = rounded(advice.exposure_s * 1e9f, kMost);
  said->beat_ppm = rounded(advice.beat * 1e6f, kMost);
  board_send(self, &message);
}

void board_sample(board* self, uint16_t code) {
  flicker_result light;
  if (flicker_sample(&self->light, code, &light)) send_light(self, &light);
}

static int32_t millionths(float value) {
  const float scaled = value * 1e6f;
  const float most = 2.147e9f;
  const float held = scaled > most ? most : scaled < -most ? -most : scaled;
  return (int32_t)(held + (held < 0.0f ? -0.5f : 0.5f));
}

void board_imu(board* self, const float acceleration[3], const float rate[3], uint32_t counter) {
  const uint64_t tick = board_time_of(&self->time, counter);
  const float dt = (float)(tick - self->last_imu) / (float)self->facts->tick_hz;
  self->last_imu = tick;
  gravity_sample(&self->up, acceleration, rate, dt < 0.1f ? dt : 0.1f);
  ++self->imu_skipped;
  if (!self->up.started || self->imu_skipped < (uint32_t)kImuEvery) return;
  self->imu_skipped = 0;
  sync_message message = {.type = SYNC_IMU,
                          .imu = {.t_board_ns = board_ns(self, tick),
                                  .flags = (uint8_t)(gravity_steady(&self->up) ? SYNC_IMU_STEADY : 0)}};
  for (unsigned i = 0; i < 3u; ++i) {
    message.imu.up_um_s2[i] = millionths(self->up.up[i]);
    message.imu.rate_urad_s[i] = millionths(rate[i] - self->up.bias[i]);
  }
  board_send(self, &message);
}

void board_temperature(board* self, uint8_t sensor, int32_t reading_mc) {
  int32_t filtered;
  if (sensor >= (uint8_t)BOARD_SENSORS || !temperature_sample(&self->sensors[sensor], reading_mc, &filtered))
    return;
  const sync_message message = {
      .type = SYNC_TEMPERATURE,
      .temperature = {
          .t_board_ns = board_ns(self, self->time.now), .sensor = sensor, .temperature_mc = filtered}};
  board_send(self, &message);
}

void board_button(board* self, bool pressed) {
  sync_press press;
  const uint32_t now_ms = board_ms(self);
  if (!button_sample(&self->record, pressed, now_ms, &press)) return;
  const uint64_t ago = (uint64_t)(now_ms - self->record.pressed_ms) * (self->facts->tick_hz / 1000u);
  const sync_message message = {
      .type = SYNC_BUTTON,
      .button = {.t_board_ns = board_ns(self, self->time.now - ago), .press = (uint8_t)press}};
  board_send(self, &message);
}

bool board_led(const board* self) {
  lamp shows = LAMP_ALONE;
  if (self->greeted && !self->safe) shows = (lamp)((unsigned)LAMP_IDLE + self->host_state);
  return lamp_is_lit(shows, board_ms(self));
}
