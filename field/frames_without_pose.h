// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lightwell {

// When a take's frames had no pose.
class FramesWithoutPose {
 public:
  // Neighbours in the take, by their times from its first frame on.
  struct Span {
    double from_s = 0, to_s = 0;
    std::size_t frames = 0;
  };
  // Each frame of the take in its order.
  void add(std::int64_t frame_ns, bool has_pose);

  [[nodiscard]] const std::vector<Span>& spans() const { return spans_; }
  // "0.000 to 0.180 s (10 frames), 5.240 s (1 frame)"; the longest where there are many.
  [[nodiscard]] std::string text() const;

 private:
  std::int64_t first_ns_ = 0;
  bool any_ = false, in_span_ = false;
  std::vector<Span> spans_;
};

}  // namespace lightwell
