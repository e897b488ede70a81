// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "interface/part_file.h"
#include "lighting/field/pose_track.h"
#include "lighting/result.h"

namespace lightwell {

// Poses of a probe beside its take, CSV: time_ns (CLOCK_MONOTONIC, as the frames' times), x, y, z (metres, world), and
// where the probe turns qx, qy, qz, qw (a unit quaternion, world from probe); sample_ns where the tracker stamps its
// samples by a clock of its own (docs/conventions.md).
struct PoseFile {
  std::vector<TimedPose> poses;   // one or more, times rising
  std::vector<int> lines;         // of the file, for messages
  bool has_turns = false;         // else all poses stand as the world does
  bool by_tracker_clock = false;  // times are the tracker's, brought to ours
  // A line each, without the file's name: a last line that was cut off, steps of the tracker's clock.
  std::vector<std::string> remarks;
};

// bad_input that names file, line, column, value and range: no poses, a column missing, numbers that are none or out of
// range, times that do not rise, a quaternion that is no turn.
// A last line without a line end was cut off in writing: it is left out and said, but for a file's only pose.
// With sample_ns in every line, times are the tracker's own, moved by the least delay with which poses arrived around
// them (±5 s): the network's delays vary, the tracker's sampling does not. Where the tracker's clock was set, that begins
// anew and is said; where it was set too often it is no clock, and times are those of arrival.
Result<PoseFile> read_poses(const std::filesystem::path& file);
Result<PoseFile> parse_poses(std::string_view text, const std::string& file);

// take.poses.csv of take.mkv.
std::filesystem::path poses_beside(const std::filesystem::path& take);

// Writes poses as they come, flushed line by line, under a hidden name beside the file until they are kept: a take that
// comes to nothing leaves nothing that stands in the way of the next, and where the program is killed all of them are there.
class PoseFileWriter {
 public:
  // failed: the file exists (it is not overwritten), or cannot be written.
  static Result<PoseFileWriter> create(const std::filesystem::path& file, bool with_sample_ns);
  Status write(const TimedPose& pose, std::optional<std::int64_t> sample_ns = std::nullopt);
  // Ends it; what is not kept goes away. failed: the file has come to be meanwhile, or cannot be made; the poses stay under
  // their hidden name, which the message has.
  Status keep();
  [[nodiscard]] const std::filesystem::path& hidden() const { return part_->path(); }

 private:
  struct Close {
    void operator()(std::FILE* f) const { std::fclose(f); }
  };
  PoseFileWriter(std::filesystem::path file, std::unique_ptr<PartFile> part, std::FILE* stream,
                 bool with_sample_ns)
      : file_(std::move(file)), part_(std::move(part)), stream_(stream), with_sample_ns_(with_sample_ns) {}
  std::filesystem::path file_;
  std::unique_ptr<PartFile> part_;
  std::unique_ptr<std::FILE, Close> stream_;
  bool with_sample_ns_;
};

}  // namespace lightwell
