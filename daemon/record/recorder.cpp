// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/recorder.h"

#include <algorithm>
#include <utility>

#include "daemon/record/recording_session.h"
#include "daemon/record/take_name.h"

namespace lightwell {

RecordedFrame recorded_frame(const FrameInfo& info) {
  return {.sequence = info.sequence,
          .capture_mono_ns = info.capture_mono_ns,
          .received_mono_ns = info.received_mono_ns,
          .capture_utc_ns = info.capture_utc_ns,
          .exposure_us = info.exposure_us,
          .gain_db = info.gain_db,
          .temperature_c = info.temperature_c,
          .timecode = info.timecode};
}

Recorder::Recorder(std::filesystem::path directory, std::size_t ring_bytes)
    : directory_(std::move(directory)), ring_bytes_(ring_bytes) {}

Recorder::~Recorder() = default;

std::shared_ptr<Recorder::Session> Recorder::session() const {
  const std::lock_guard lock(session_mutex_);
  return session_;
}

Status Recorder::start(const std::string& file, const RecordingHeader& header) {
  if (Status status = check_take_name(file); !status) return status;
  return start_at(directory_ / file, header);
}

Status Recorder::start_at(const std::filesystem::path& path, const RecordingHeader& header) {
  const std::lock_guard one_at_a_time(control_);
  auto previous = session();
  if (previous && previous->active())
    return Error{ErrorKind::failed, "recording: " + previous->file() + " is being written; stop it first"};
  auto writer = RecordingWriter::create(path, header);
  if (!writer) return writer.error();
  constexpr std::size_t kFewest = 4, kMost = 256;
  const std::size_t frames = std::clamp(ring_bytes_ / header.format.bytes(), kFewest, kMost);
  auto next = std::make_shared<Session>(path.filename().string(), header.format, frames, std::move(*writer));
  {
    const std::lock_guard lock(session_mutex_);
    session_ = next;
  }
  const std::lock_guard lock(live_mutex_);
  live_.swap(next);  // the last take's memory goes here, not on the frame path
  return {};
}

Status Recorder::stop() {
  const std::lock_guard one_at_a_time(control_);
  const auto ending = session();
  if (!ending) return Error{ErrorKind::failed, "recording: none is being written"};
  return ending->finish();
}

void Recorder::offer(const FrameInfo& info, std::span<const std::byte> codes) noexcept {
  if (!info.complete) return;
  const std::unique_lock lock(live_mutex_, std::try_to_lock);
  if (lock && live_) live_->offer(info, codes);
}

Recorder::Stats Recorder::stats() const {
  const auto current = session();
  return current ? current->stats() : Stats();
}

}  // namespace lightwell
