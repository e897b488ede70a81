// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/record/pose_recorder.h"

#include <chrono>
#include <utility>

namespace lightwell {

Result<std::unique_ptr<PoseRecorder>> PoseRecorder::start(const TrackingOptions& options,
                                                          const std::filesystem::path& file) {
  auto receiver = TrackingReceiver::open(options);
  if (!receiver) return receiver.error();
  auto writer = PoseFileWriter::create(file, options.protocol == TrackingProtocol::opentrackio);
  if (!writer) return writer.error();
  return std::unique_ptr<PoseRecorder>(new PoseRecorder(*std::move(receiver), *std::move(writer)));
}

PoseRecorder::PoseRecorder(TrackingReceiver receiver, PoseFileWriter writer)
    : receiver_(std::move(receiver)), writer_(std::move(writer)), thread_([this] { run(); }) {}

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
  while (running_ && written_)
    if (const auto arrival = receiver_.next(kLook)) written_ = take(*arrival);
}

Status PoseRecorder::take(const TrackingArrival& arrival) {
  if (!arrival.camera) {
    ++stats_.malformed;
    if (!stats_.first_malformed)
      stats_.first_malformed = arrival.camera.error().message + " (from " + arrival.sender + ")";
    return {};
  }
  if (!*arrival.camera) return {};
  const TrackedCamera& tracked = **arrival.camera;
  // Networks may turn datagrams round; a sample that was sent twice is one pose.
  const bool later = !last_arrived_ns_ || arrival.arrived_mono_ns > *last_arrived_ns_;
  const bool newer = !last_sampled_ns_ || !tracked.sampled_ns || *tracked.sampled_ns > *last_sampled_ns_;
  if (!later || !newer) {
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
