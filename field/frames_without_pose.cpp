// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/frames_without_pose.h"

#include <algorithm>
#include <cstdio>

namespace lightwell {

void FramesWithoutPose::add(std::int64_t frame_ns, bool has_pose) {
  if (!any_) first_ns_ = frame_ns;
  any_ = true;
  if (!has_pose) {
    const double at_s = static_cast<double>(frame_ns - first_ns_) * 1e-9;
    if (!in_span_) spans_.push_back({at_s, at_s, 0});
    spans_.back().to_s = at_s;
    ++spans_.back().frames;
  }
  in_span_ = !has_pose;
}

std::string FramesWithoutPose::text() const {
  constexpr std::size_t kMost = 6;
  std::vector<Span> shown = spans_;
  if (shown.size() > kMost) {
    std::stable_sort(shown.begin(), shown.end(),
                     [](const Span& a, const Span& b) { return a.frames > b.frames; });
    shown.resize(kMost);
    std::sort(shown.begin(), shown.end(), [](const Span& a, const Span& b) { return a.from_s < b.from_s; });
  }
  std::string out;
  for (const Span& span : shown) {
    char text[80];
    if (span.frames == 1)
      std::snprintf(text, sizeof text, "%.3f s (1 frame)", span.from_s);
    else
      std::snprintf(text, sizeof text, "%.3f to %.3f s (%zu frames)", span.from_s, span.to_s, span.frames);
    out += (out.empty() ? "" : ", ") + std::string(text);
  }
  if (shown.size() < spans_.size())
    out += ", and " + std::to_string(spans_.size() - shown.size()) + " shorter times";
  return out;
}

}  // namespace lightwell
