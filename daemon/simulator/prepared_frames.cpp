// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/prepared_frames.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "daemon/clock.h"

namespace lightwell::simulator {
namespace {

// A scene's next keyframe takes several frames' time to make (40 ms of clouds); the frames before it must last.
constexpr std::int64_t kAheadUs = 150'000;
constexpr std::int64_t kFewestAhead = 3;

std::int64_t real_now_us() {
  return utc_now_ns() / 1000;
}

}  // namespace

PreparedFrames::PreparedFrames(FrameGenerator generator, std::function<CameraSettings()> settings,
                               std::function<void(const SentFrame&)> sent)
    : generator_(std::move(generator)),
      settings_(std::move(settings)),
      sent_(std::move(sent)),
      thread_([this] { run(); }) {}

PreparedFrames::~PreparedFrames() {
  stop();
}

void PreparedFrames::stop() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  work_.notify_all();
  ready_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::uint64_t PreparedFrames::taken() const {
  const std::lock_guard lock(mutex_);
  return taken_;
}

void PreparedFrames::run() {
  std::unique_lock lock(mutex_);
  while (running_) {
    tell(lock);
    Slot* const free = slot_to_fill();
    if (free == nullptr) {
      work_.wait(lock);
      continue;
    }
    free->state = State::making;
    lock.unlock();
    make(*free);
    lock.lock();
    free->state = State::ready;
    ready_.notify_all();
  }
  tell(lock);
}

// A free slot, while fewer are taken than kAheadUs asks for, and one that is copied.
PreparedFrames::Slot* PreparedFrames::slot_to_fill() {
  const std::int64_t ahead = period_us_ > 0 ? std::max(kFewestAhead, kAheadUs / period_us_) : kFewestAhead;
  const auto taken =
      std::count_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.state != State::free; });
  if (taken > ahead) return nullptr;
  const auto free =
      std::find_if(slots_.begin(), slots_.end(), [](const Slot& s) { return s.state == State::free; });
  return free == slots_.end() ? nullptr : &*free;
}

void PreparedFrames::make(Slot& slot) {
  slot.settings = settings_();
  const std::int64_t period = std::max<std::int64_t>(slot.settings.period_us, 1);
  period_us_ = period;
  const std::int64_t next = real_now_us() / period * period + period;
  slot.due_real_us = std::max(last_due_us_ + period, next);
  // After a pause or a change of rate the schedule starts anew at the next whole period.
  if (slot.due_real_us % period != 0 ||
      slot.due_real_us > next + static_cast<std::int64_t>(slots_.size()) * period)
    slot.due_real_us = next;
  // The scene goes on with the clock while frames follow each other, and stands while nobody takes any.
  const std::int64_t passed = slot.due_real_us - last_due_us_;
  scene_s_ += 1e-6 * static_cast<double>(passed > 0 && passed <= 8 * period ? passed : period);
  last_due_us_ = slot.due_real_us;
  FrameFormat format = generator_.model().format;
  format.pixel_format = slot.settings.pixel_format;
  slot.bytes.resize(format.bytes());
  slot.truth =
      generator_.render(scene_s_, slot.settings.exposure_us, made_++, format.pixel_format, slot.bytes);
}

PreparedFrames::Slot* PreparedFrames::oldest_ready() {
  Slot* oldest = nullptr;
  for (Slot& slot : slots_)
    if (slot.state == State::ready && (oldest == nullptr || slot.due_real_us < oldest->due_real_us))
      oldest = &slot;
  return oldest;
}

// Frames for other settings, and frames whose successor is due already.
void PreparedFrames::drop_stale(const CameraSettings& wanted, std::int64_t now_real_us) {
  bool dropped = false;
  for (Slot& slot : slots_) {
    if (slot.state != State::ready) continue;
    if (slot.settings == wanted && slot.due_real_us + wanted.period_us > now_real_us) continue;
    slot.state = State::free;
    dropped = true;
  }
  if (dropped) work_.notify_all();
}

std::int64_t PreparedFrames::take(const CameraSettings& wanted, std::uint16_t frame_id,
                                  std::span<std::byte> out) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  std::unique_lock lock(mutex_);
  Slot* slot = nullptr;
  for (;;) {
    drop_stale(wanted, real_now_us());
    slot = oldest_ready();
    if (slot != nullptr || !running_) break;
    if (ready_.wait_until(lock, deadline) == std::cv_status::timeout) break;
  }
  if (slot == nullptr || slot->bytes.size() > out.size()) {
    std::fill(out.begin(), out.end(), std::byte{0});
    return 0;
  }
  slot->state = State::copying;
  lock.unlock();
  std::memcpy(out.data(), slot->bytes.data(), slot->bytes.size());
  lock.lock();
  // Triggered frames, and the first after a start, leave before the instant they were made for: their
  // exposure ends now.
  const std::int64_t late_us = std::max<std::int64_t>(0, real_now_us() - slot->due_real_us);
  SentFrame sent;
  sent.frame = taken_++;
  sent.frame_id = frame_id;
  sent.exposure_us = slot->settings.exposure_us;
  sent.mid_exposure_mono_ns = mono_now_ns() - 1000 * late_us - std::llround(sent.exposure_us * 500);
  sent.truth = std::move(slot->truth);
  const std::int64_t time_ns = sent.mid_exposure_mono_ns;
  to_tell_.push_back(std::move(sent));
  slot->state = State::free;
  work_.notify_all();
  return time_ns;
}

// Called and returns with the lock held, calls out without it.
void PreparedFrames::tell(std::unique_lock<std::mutex>& lock) {
  while (!to_tell_.empty()) {
    std::vector<SentFrame> now;
    now.swap(to_tell_);
    lock.unlock();
    for (const SentFrame& frame : now) sent_(frame);
    lock.lock();
  }
}

}  // namespace lightwell::simulator
