// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Packets of camera trackers: FreeD's, and OpenTrackIO's in the segments that the input's first byte says, with the
// checksums made right, so that what lies behind them is reached as well.
#include <algorithm>
#include <cmath>
#include <vector>

#include "interface/freed_packet.h"
#include "interface/opentrackio_packet.h"

using namespace lightwell;

namespace {

void expect_camera(const TrackedCamera& tracked) {
  const ProbePose pose = pose_from_tracked(tracked);
  verify_bug(pose.position_m.allFinite() && std::abs(pose.world_from_probe.norm() - 1) < 1e-9,
             "a pose that was accepted is nowhere");
  const Eigen::Matrix3d& r = tracked.stage_from_camera;
  verify_bug((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-9,
             "a pose that was accepted is no rotation");
  verify_bug(tracked.focal_length_mm.value_or(1) > 0 && tracked.sensor_height_mm.value_or(1) > 0,
             "a field of view that no lens has");
  const PanTiltRoll turn = pan_tilt_roll_from(r);
  verify_bug((rotation_from_pan_tilt_roll(turn.pan_deg, turn.tilt_deg, turn.roll_deg) - r).norm() < 1e-6,
             "angles that are another turn");
}

void expect_refusal(const Error& error) {
  verify_bug(error.kind == ErrorKind::bad_input && error.message.size() < 2000,
             "a refusal that says nothing");
}

void freed(std::vector<std::uint8_t> bytes) {
  for (const bool right : {false, true}) {
    if (right && !bytes.empty()) {
      std::uint8_t checksum = 0x40;
      for (std::size_t i = 0; i + 1 < bytes.size(); ++i)
        checksum = static_cast<std::uint8_t>(checksum - bytes[i]);
      bytes.back() = checksum;
    }
    if (const auto packet = parse_freed(bytes))
      expect_camera(packet->camera);
    else
      expect_refusal(packet.error());
  }
}

void take(OpenTrackIoReader& reader, const std::vector<std::uint8_t>& datagram) {
  const auto taken = reader.take(datagram);
  if (!taken)
    expect_refusal(taken.error());
  else if (*taken)
    expect_camera(**taken);
}

// The bytes as a payload, in this many segments.
void segments(std::span<const std::uint8_t> payload, std::size_t count, std::uint8_t encoding) {
  OpenTrackIoReader reader;
  const std::size_t step = std::max<std::size_t>(payload.size() / count, 1);
  for (std::size_t at = 0; at < payload.size(); at += step) {
    const auto part = payload.subspan(at, std::min({step, payload.size() - at, std::size_t{0x7FFF}}));
    const bool last = at + step >= payload.size();
    std::vector<std::uint8_t> bytes = {'O', 'T', 'r', 'k', 0, encoding, 0, 0};
    for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(at >> shift & 255));
    const std::size_t length = part.size() | (last ? 0x8000u : 0u);
    bytes.push_back(static_cast<std::uint8_t>(length >> 8));
    bytes.push_back(static_cast<std::uint8_t>(length & 255));
    const std::uint16_t sum = fletcher16(part, fletcher16(bytes));
    bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
    bytes.push_back(static_cast<std::uint8_t>(sum & 255));
    bytes.insert(bytes.end(), part.begin(), part.end());
    take(reader, bytes);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::vector<std::uint8_t> bytes(data + 1, data + size);
  freed(bytes);
  OpenTrackIoReader reader;
  take(reader, bytes);
  for (const std::uint8_t encoding : {std::uint8_t{1}, std::uint8_t{2}})
    segments(bytes, 1 + data[0] % 4u, encoding);
  return 0;
}
