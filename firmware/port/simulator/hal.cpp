// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/hal/hal.h"

#include "firmware/port/simulator/simulator.h"

namespace lightwell::sync_simulator {
namespace {

Simulator* running = nullptr;  // the functions below have no context: one board a process

template <typename T>
bool take(std::deque<T>& queue, T& value) {
  if (queue.empty()) return false;
  value = queue.front();
  queue.pop_front();
  return true;
}

}  // namespace

Simulator::Simulator(const WorldOptions& options) : world(options) {
  for (auto& region : flash_) region.assign(kFlashRegion, FLASH_ERASED);
  driver_.context = this;
  driver_.erase = [](void* self, std::uint32_t region) {
    auto& bytes = static_cast<Simulator*>(self)->flash_.at(region);
    std::fill(bytes.begin(), bytes.end(), std::uint8_t{FLASH_ERASED});
    return true;
  };
  driver_.write = [](void* self, std::uint32_t region, std::uint32_t offset, const std::uint8_t* from,
                     std::uint32_t size) {
    auto& bytes = static_cast<Simulator*>(self)->flash_.at(region);
    if (offset + size > bytes.size()) return false;
    for (std::uint32_t i = 0; i < size; ++i) bytes[offset + i] &= from[i];  // bits only ever fall
    return true;
  };
  driver_.read = [](void* self, std::uint32_t region, std::uint32_t offset, std::uint8_t* to,
                    std::uint32_t size) {
    const auto& bytes = static_cast<Simulator*>(self)->flash_.at(region);
    for (std::uint32_t i = 0; i < size; ++i) to[i] = offset + i < bytes.size() ? bytes[offset + i] : 0;
  };
  verifier_.verify = update_verify_none;
  facts_ = {.tick_hz = World::kTickHz,
            .capabilities = SYNC_CAN_TRIGGER | SYNC_CAN_STROBE | SYNC_CAN_REFERENCE | SYNC_CAN_TIMECODE |
                            SYNC_CAN_PHOTODIODE | SYNC_CAN_IMU | SYNC_CAN_TEMPERATURE | SYNC_CAN_BUTTON |
                            SYNC_CAN_CAMERA_POWER | SYNC_CAN_STORE,
            .serial = {0x53494D55, 0x4C41544F, options.seed},
            .slot = 0,
            .sample_hz = World::kSampleHz,
            .highest_code = 4095,
            .memory = &driver_,
            .verifier = &verifier_,
            .image_region_size = kFlashRegion};
  running = this;
}

Simulator::~Simulator() {
  running = nullptr;
}

}  // namespace lightwell::sync_simulator

using lightwell::sync_simulator::running;

extern "C" {

const board_facts* hal_init() {
  return &running->facts();
}
uint32_t hal_ticks() {
  return running->world.ticks();
}

bool hal_link_read(uint8_t link, uint8_t* byte) {
  return link == 0 && lightwell::sync_simulator::take(running->from_host, *byte);
}
bool hal_link_ready(uint8_t link) {
  return link == 0 && running->to_host.size() < lightwell::sync_simulator::Simulator::kLinkBytes;
}
void hal_link_write(uint8_t /*link*/, uint8_t byte) {
  running->to_host.push_back(byte);
}

void hal_pulse(uint32_t rise, uint32_t fall) {
  running->world.pulse(rise, fall);
}
bool hal_pulse_done(bool* made) {
  return running->world.pulse_done(made);
}
void hal_pulses_forget() {
  running->world.forget_pulses();
}

bool hal_edge(hal_edge_event* event) {
  return lightwell::sync_simulator::take(running->world.edges, *event);
}
bool hal_sample(uint16_t* code) {
  return lightwell::sync_simulator::take(running->world.samples, *code);
}

bool hal_imu(float acceleration[3], float rate[3], uint32_t* stamp) {
  lightwell::sync_simulator::World::Inertial sample;
  if (!lightwell::sync_simulator::take(running->world.inertial, sample)) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    acceleration[i] = sample.acceleration[i];
    rate[i] = sample.rate[i];
  }
  *stamp = sample.stamp;
  return true;
}

bool hal_temperature(uint8_t* sensor, int32_t* reading_mc) {
  *sensor = SYNC_SENSOR_BOARD;
  return lightwell::sync_simulator::take(running->world.temperatures, *reading_mc);
}

bool hal_button() {
  return running->world.pressed;
}
void hal_led(bool lit) {
  running->lit = lit;
}
void hal_camera_power(bool on) {
  running->world.camera_power(on);
}
uint32_t hal_overruns() {
  return 0;
}
void hal_watchdog() {}
}
