// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/gpio_sync.h"

#include <pthread.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "daemon/clock.h"

namespace lightwell {
namespace {

constexpr auto kTurn = std::chrono::milliseconds(20);
constexpr int kTurnsUntilRetry = 15;
constexpr std::int64_t kLongestExposureNs = 1'000'000'000;  // of a camera that runs by itself

}  // namespace

GpioSync::GpioSync(GpioOptions options, StrobeRing& strobes)
    : options_(std::move(options)), strobes_(strobes) {
  view_.state = BoardState::no_device;
  view_.description = "not looked for yet";
  thread_ = std::thread([this] { run(); });
}

GpioSync::~GpioSync() {
  stopping_ = true;
  thread_.join();
}

BoardView GpioSync::view() const {
  const std::scoped_lock lock(mutex_);
  return view_;
}

std::string GpioSync::description(bool real_time) const {
  std::string text = "GPIO " + options_.chip + ": ";
  if (!options_.trigger_line.empty())
    text += "triggers on line " + options_.trigger_line +
            (real_time ? ", " : " without real-time priority (CAP_SYS_NICE gives it), ");
  if (!options_.strobe_line.empty()) text += "strobes on line " + options_.strobe_line + ", ";
  return text + "no reference, timecode, flicker, gravity or temperature: a sync board has these";
}

void GpioSync::run() {
  pthread_setname_np(pthread_self(), "gpio-sync");
  while (!stopping_) {
    const Status ended = work();
    if (!ended) {
      const std::scoped_lock lock(mutex_);
      BoardView none;
      none.state = BoardState::no_device;
      none.description = ended.error().message;
      none.reconnects = view_.reconnects;
      view_ = none;
    }
    for (int i = 0; i < kTurnsUntilRetry && !stopping_; ++i) std::this_thread::sleep_for(kTurn);
  }
}

Status GpioSync::work() {
  std::unique_ptr<GpioInput> strobe;
  std::unique_ptr<GpioTrigger> trigger;
  if (!options_.strobe_line.empty()) {
    auto opened = open_gpio_input({options_.chip, options_.strobe_line});
    if (!opened) return opened.error();
    strobe = std::move(*opened);
  }
  if (!options_.trigger_line.empty()) {
    auto opened = open_gpio_output({options_.chip, options_.trigger_line});
    if (!opened) return opened.error();
    trigger = std::make_unique<GpioTrigger>(std::move(*opened), options_.pulses);
  }
  StrobePairing pairing(trigger ? options_.pulses.period_ns() : kLongestExposureNs);
  std::array<GpioEdge, 16> edges{};
  while (!stopping_) {
    if (strobe) {
      const auto size = strobe->read(edges, kTurn);
      if (!size) return size.error();
      take_edges(std::span(edges).first(*size), trigger.get(), pairing);
    } else {
      std::this_thread::sleep_for(kTurn);
    }
    if (trigger && trigger->view().failed)
      return Error{ErrorKind::failed, options_.chip + ": line " + options_.trigger_line + " is gone"};
    publish(trigger.get(), pairing);
  }
  return {};
}

void GpioSync::take_edges(std::span<const GpioEdge> edges, GpioTrigger* trigger, StrobePairing& pairing) {
  while (const auto made = trigger != nullptr ? trigger->next() : std::nullopt)
    pairing.trigger(made->n, made->mono_ns);
  for (const GpioEdge& edge : edges) {
    if (trigger == nullptr && edge.rises) pairing.trigger(free_strobes_++, edge.mono_ns);
    if (const auto exposure = pairing.edge(edge.rises, edge.mono_ns)) strobes_.push(*exposure);
  }
}

void GpioSync::publish(const GpioTrigger* trigger, const StrobePairing& pairing) {
  const GpioTrigger::View made = trigger != nullptr ? trigger->view() : GpioTrigger::View{};
  sync_status status{};
  status.t_board_ns = static_cast<std::uint64_t>(mono_now_ns());  // the board's clock is the host's
  status.lock = SYNC_LOCK_FREE;
  status.phase_error_ns = made.late_ns;
  status.phase_rms_ns = static_cast<std::uint32_t>(std::min(made.late_rms_ns, 4e9));
  status.triggers = made.made;
  status.late_triggers = made.late;
  status.strobes = pairing.strobes();
  status.stray_strobes = pairing.strays();
  status.unanswered_triggers = trigger != nullptr && !options_.strobe_line.empty() ? pairing.unanswered() : 0;
  const std::scoped_lock lock(mutex_);
  if (view_.state != BoardState::connected && std::exchange(worked_before_, true)) ++view_.reconnects;
  view_.state = BoardState::connected;
  view_.description = description(made.real_time);
  if (trigger != nullptr && !view_.configuration) {
    sync_configuration& c = view_.configuration.emplace();
    c.trigger_on = 1;
    c.rate_numerator = options_.pulses.rate_numerator;
    c.rate_denominator = options_.pulses.rate_denominator;
    c.pulse_ns = options_.pulses.pulse_ns;
  }
  view_.status = status;
}

}  // namespace lightwell
