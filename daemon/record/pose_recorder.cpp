// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/pose_recorder.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace lightwell {
namespace {

constexpr double kSilence_s = 1;  // trackers send 24 poses a second and more

}  // namespace

Result<std::unique_ptr<PoseRecorder>> PoseRecorder::start(const TrackingOptions& options,
                                                          const std::filesystem::path& file, Remark remark) {
  auto receiver = TrackingReceiver::open(options);
  if (!receiver) return receiver.error();
  auto writer = PoseFileWriter::create(file, options.protocol == TrackingProtocol::opentrackio);
  if (!writer) return writer.error();
  return std::unique_ptr<PoseRecorder>(
      new PoseRecorder(*std::move(receiver), *std::move(writer), std::move(remark)));
}

PoseRecorder::PoseRecorder(TrackingReceiver receiver, PoseFileWriter writer, Remark remark)
    : receiver_(std::move(receiver)),
      writer_(std::move(writer)),
      remark_(remark ? std::move(remark) : [](const std::string&) {}),
      heard_(std::chrono::steady_clock::now()),
      thread_([this] { run(); }) {}

PoseRecorder::~PoseRecorder() {
  (void)stop();
}

Status PoseRecorder::stop() {
  running_ = false;
  if (thread_.joinable()) thread_.join();
  return written_;
}

void PoseRecorder::run() {
  constexpr std::chrono::milliseconds kLook{100};  // whether to go on
  while (running_ && written_) {
    const std::uint64_t before = stats_.poses;
    if (const auto arrival = receiver_.next(kLook)) written_ = take(*arrival);
    listen_for_silence(stats_.poses > before);
  }
  stats_.camera = receiver_.camera();
}

void PoseRecorder::listen_for_silence(bool pose_came) {
  const auto now = std::chrono::steady_clock::now();
  const std::chrono::duration<double> silence = now - heard_;
  stats_.longest_silence_s = std::max(stats_.longest_silence_s, silence.count());
  stats_.silence_at_end_s = pose_came ? 0 : silence.count();
  if (pose_came) {
    if (std::exchange(silent_, false)) {
      char text[80];
      std::snprintf(text, sizeof text, "poses come again, after %.1f s", silence.count());
      remark_(text);
    }
    heard_ = now;
  } else if (silence.count() > kSilence_s && !std::exchange(silent_, true)) {
    remark_(stats_.poses == 0 ? "no pose has come from the tracker yet"
                              : "the tracker sends no poses any more");
  }
}

// Networks may turn datagrams round, and a sample that was sent twice is one pose. Two in a row that are too early by more
// than any network takes are in order, by a clock that was set back.
bool PoseRecorder::comes_in_order(const TrackingArrival& arrival, const TrackedCamera& tracked) {
  constexpr std::int64_t kFarBack_ns = 100'000'000;
  if (last_arrived_ns_ && arrival.arrived_mono_ns <= *last_arrived_ns_) return false;
  if (!last_sampled_ns_ || !tracked.sampled_ns || *tracked.sampled_ns > *last_sampled_ns_) {
    earlier_sampled_ns_.reset();
    return true;
  }
  const std::int64_t back_ns = *last_sampled_ns_ - *tracked.sampled_ns;
  const std::optional<std::int64_t> before = std::exchange(earlier_sampled_ns_, std::nullopt);
  if (back_ns <= kFarBack_ns) return false;
  if (!before || *tracked.sampled_ns <= *before) {
    earlier_sampled_ns_ = tracked.sampled_ns;
    return false;
  }
  ++stats_.clock_steps;
  char text[120];
  std::snprintf(text, sizeof text, "the tracker's clock was set back by %.3f s after %llu poses",
                static_cast<double>(back_ns) * 1e-9, static_cast<unsigned long long>(stats_.poses));
  remark_(text);
  return true;
}

Status PoseRecorder::take(const TrackingArrival& arrival) {
  if (!arrival.camera) {
    ++stats_.malformed;
    if (!stats_.first_malformed)
      stats_.first_malformed = arrival.camera.error().message + " (from " + arrival.sender + ")";
    return {};
  }
  if (arrival.other_camera && stats_.other_cameras.insert(*arrival.other_camera).second)
    remark_("camera " + std::to_string(*arrival.other_camera) + " (from " + arrival.sender +
            ") is left out: camera " + std::to_string(receiver_.camera().value_or(0)) + " is followed");
  if (!*arrival.camera) return {};
  const TrackedCamera& tracked = **arrival.camera;
  if (!comes_in_order(arrival, tracked)) {
    ++stats_.out_of_order;
    return {};
  }
  last_arrived_ns_ = arrival.arrived_mono_ns;
  if (tracked.sampled_ns) last_sampled_ns_ = tracked.sampled_ns;
  if (Status written =
          writer_.write({arrival.arrived_mono_ns, pose_from_tracked(tracked)}, tracked.sampled_ns);
      !written)
    return written;
  ++stats_.poses;
  ++count_;
  return {};
}

}  // namespace lightwell
