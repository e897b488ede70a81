// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "field/field_builder.h"
#include "field/frames_without_pose.h"
#include "interface/pose_file.h"
#include "lighting/calibration.h"
#include "lighting/field/pose_track.h"
#include "lighting/field/redundancy.h"

namespace lightwell {

struct WalkOptions {
  std::filesystem::path take;         // a recording
  std::filesystem::path poses;        // interface/pose_file.h; empty: beside the take
  std::filesystem::path calibration;  // a folder; empty: the one attached to the take
  double lag_s = 0;                   // by how much the poses come late (PoseTrack::at)
  PoseTrack::Limits track;
  RedundancyFilter::Limits redundant;  // most_difference 0: all frames are kept
  int cells = 3072;                    // directions of the pictures that are compared
};

// What became of a take's frames: their sum is `frames`.
struct WalkCounts {
  std::size_t frames = 0;                            // whole ones
  std::size_t outside = 0, in_gap = 0, in_jump = 0;  // without a pose (PoseTrack::Known)
  std::size_t after_last = 0;                        // of those outside
  std::size_t redundant = 0;
  std::size_t kept = 0;
  std::size_t damaged = 0;         // places of the file where frames are lost, beside `frames`
  std::size_t clipped_frames = 0;  // of those with a pose: with pixels that are too bright for the sensor
  std::uint32_t most_clipped_pixels = 0;  // of one frame
};

// A recording made while a probe was carried about, as pictures from known places: frames are read, developed and turned
// into the world when they are asked for, and nothing of the take stays in memory.
class WalkTake {
 public:
  // Goes through the take once, to choose the frames. progress: frames done of all.
  // bad_input: the files, a take without calibration, frames that no pose belongs to.
  static Result<std::shared_ptr<WalkTake>> open(
      const WalkOptions& options, const std::function<void(std::size_t, std::size_t)>& progress = {});

  [[nodiscard]] const WalkCounts& counts() const { return counts_; }
  [[nodiscard]] const FramesWithoutPose& without_pose() const { return without_pose_; }
  [[nodiscard]] const PoseTrack& track() const { return *track_; }
  [[nodiscard]] const std::filesystem::path& poses_file() const { return options_.poses; }
  [[nodiscard]] const std::string& calibration_id() const { return calibration_.id; }
  [[nodiscard]] const RedundancyFilter::Limits& redundant() const { return options_.redundant; }
  // One line: take, poses and calibration as they are now, and the frames that are kept.
  [[nodiscard]] std::string origin() const;
  // A line each: frames without a pose, when and why, what is wrong with the poses, saturated frames, damage.
  [[nodiscard]] std::vector<std::string> remarks() const;

  // Of the pictures: what lies below what any of them sees is not among the field's directions.
  [[nodiscard]] LatLongProbe projection() const { return {theta_max_rad_}; }
  // The frames that are kept; shares this. Several threads may ask for pictures; in the take's order, or nearly, each
  // frame is read once.
  static ProbeTake probes(const std::shared_ptr<WalkTake>& walk);

 private:
  struct Frame {
    std::size_t number = 0;  // of the take's whole frames
    ProbePose pose;
  };
  class Frames;
  class Developers;
  explicit WalkTake(const WalkOptions& options) : options_(options) {}
  Status read_inputs();
  Status choose_frames(const std::function<void(std::size_t, std::size_t)>& progress);
  void remark_on(const PoseFile& file);
  [[nodiscard]] Error no_pose(std::int64_t first_ns, std::int64_t last_ns) const;
  Result<LatLongImage> picture(std::size_t kept);

  WalkOptions options_;
  Calibration calibration_;
  std::unique_ptr<PoseTrack> track_;
  std::vector<std::string> pose_remarks_;
  WalkCounts counts_;
  FramesWithoutPose without_pose_;
  std::vector<Frame> kept_;
  double theta_max_rad_ = kPi;
  std::shared_ptr<Frames> frames_;
  std::shared_ptr<Developers> developers_;
};

}  // namespace lightwell
