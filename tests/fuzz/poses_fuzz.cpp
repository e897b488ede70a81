// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// ProbePose files, and the path through what was accepted.
#include <cmath>
#include <string_view>

#include "interface/pose_file.h"

using namespace lightwell;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = parse_poses({reinterpret_cast<const char*>(data), size}, "poses.csv");
  if (!file) {
    verify_bug(file.error().kind == ErrorKind::bad_input && !file.error().message.empty(),
               "a refusal that says nothing");
    return 0;
  }
  verify_bug(!file->poses.empty() && file->lines.size() == file->poses.size(), "poses without lines");
  const PoseTrack track(file->poses, {});
  const std::int64_t first = file->poses.front().time_ns, last = file->poses.back().time_ns;
  for (const std::int64_t time : {first - 1, first, first + (last - first) / 2, last, last + 1}) {
    const PoseTrack::At at = track.at(time, 0);
    verify_bug((at.known == PoseTrack::Known::outside) == (time < first || time > last),
               "a path that goes on beyond its ends");
    verify_bug(at.pose.position_m.allFinite() && std::abs(at.pose.world_from_probe.norm() - 1) < 1e-6,
               "a pose that is nowhere");
  }
  return 0;
}
