// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/board_state.h"

enum { kBounceUs = 50 };

uint32_t board_ms(const board* self) {
  return (uint32_t)(self->time.now / (self->facts->tick_hz / 1000u));
}

uint64_t board_ns(const board* self, uint64_t ticks) {
  return ticks_to_ns(ticks, self->facts->tick_hz);
}

void board_send(board* self, const sync_message* message) {
  (void)outbox_send(&self->out, message);
}

void board_apply(board* self) {
  const sync_configuration* s = &self->settings;
  const uint32_t tick_hz = self->facts->tick_hz;
  pulses_configure(&self->train, s, self->time.now);
  self->restart_train = true;
  strobe_init(&self->camera_strobe, (uint64_t)ns_to_ticks(s->strobe_window_ns, tick_hz),
              self->train.next.period, (uint64_t)kBounceUs * tick_hz / 1000000u);
  self->light.dark = (float)s->photodiode_dark / 16.0f;
  host_guard_init(&self->host, s->heartbeat_ms, board_ms(self));
  camera_guard_init(&self->camera, s->camera_on != 0u, s->camera_watchdog_ms, s->camera_off_ms,
                    board_ms(self));
}

void board_send_status(board* self) {
  const servo* reference = &self->train.reference;
  sync_message message = {.type = SYNC_STATUS};
  sync_status* s = &message.status;
  s->t_board_ns = board_ns(self, self->time.now);
  s->lock = (uint8_t)reference->state;
  s->phase_error_ns = servo_error_ns(reference);
  s->phase_rms_ns = servo_rms_ns(reference);
  s->frequency_ppb = servo_frequency_ppb(reference);
  if (reference->state == SYNC_LOCK_HOLDOVER)
    s->holdover_s = (uint32_t)((self->time.now - reference->held.last_edge) / self->facts->tick_hz);
  s->triggers = self->train.sent;
  s->late_triggers = self->train.next.late + self->train.missed;
  s->strobes = self->camera_strobe.paired;
  s->unanswered_triggers = self->camera_strobe.unanswered;
  s->stray_strobes = self->camera_strobe.stray;
  s->double_edges = self->camera_strobe.doubled;
  s->reference_edges = reference->edges;
  s->refused_edges = reference->refused;
  s->overruns = self->overruns;
  s->link_good = self->receiver[self->link].good;
  s->link_damaged = self->receiver[self->link].damaged;
  s->link_dropped = self->out.dropped;
  s->power_cycles = self->camera.cycles;
  s->camera_on = board_camera_power(self) ? 1u : 0u;
  s->safe = self->safe ? 1u : 0u;
  board_send(self, &message);
}

bool board_camera_power(board* self) {
  return camera_guard_power(&self->camera, self->train.running, board_ms(self));
}
