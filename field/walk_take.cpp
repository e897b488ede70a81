// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/walk_take.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "field/field_state.h"
#include "field/frame_developer.h"
#include "interface/calibration_io.h"
#include "interface/pose_file.h"
#include "interface/recording.h"

namespace lightwell {
namespace {

struct RawFrame {
  RecordedFrame info;
  std::vector<std::byte> codes;
};

Error bad(const std::filesystem::path& file, const std::string& what) {
  return {ErrorKind::bad_input, file.string() + ": " + what};
}

std::string seconds(std::int64_t ns) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3f s", static_cast<double>(ns) * 1e-9);
  return text;
}

}  // namespace

// The take's whole frames in their order. Threads ask for frames nearly in order: those that one thread passes on its way
// wait for the others.
class WalkTake::Frames {
 public:
  static Result<std::shared_ptr<Frames>> open(const std::filesystem::path& take) {
    auto reader = RecordingReader::open(take);
    if (!reader) return reader.error();
    return std::make_shared<Frames>(take, *std::move(reader));
  }
  Frames(std::filesystem::path take, std::unique_ptr<RecordingReader> reader)
      : take_(std::move(take)), reader_(std::move(reader)) {}

  [[nodiscard]] RecordingReader& reader() { return *reader_; }

  // The next whole frame, nothing at the end; places that are damaged are passed and counted.
  Result<std::optional<RawFrame>> next() {
    RawFrame frame;
    frame.codes.resize(reader_->header().format.bytes());
    for (;;) {
      auto read = reader_->read(frame.codes);
      if (!read) {
        if (++damaged_ > kMostDamaged) return read.error();
        continue;
      }
      if (!*read) return std::optional<RawFrame>();
      frame.info = **read;
      ++next_;
      if (!(frame.info.exposure_us > 0))
        return bad(take_, "frame " + std::to_string(next_ - 1) + ": exposure_us is " +
                              std::to_string(frame.info.exposure_us) + ", allowed above 0");
      return std::optional<RawFrame>(std::move(frame));
    }
  }
  [[nodiscard]] std::size_t damaged() const { return damaged_; }

  // A frame by its number; needed: all that will be asked for, rising.
  Result<RawFrame> at(std::size_t number, const std::function<bool(std::size_t)>& needed) {
    const std::scoped_lock lock(mutex_);
    if (const auto found = passed_.find(number); found != passed_.end()) {
      RawFrame frame = std::move(found->second);
      passed_.erase(found);
      return frame;
    }
    if (number < next_) {
      if (const Status again = reader_->rewind(); !again) return again.error();
      next_ = 0;
      passed_.clear();
    }
    for (;;) {
      const std::size_t here = next_;
      auto frame = next();
      if (!frame) return frame.error();
      if (!*frame) return bad(take_, "frame " + std::to_string(number) + " is gone: has the take changed?");
      if (here == number) return *std::move(*frame);
      if (!needed(here)) continue;
      passed_[here] = *std::move(*frame);
      if (passed_.size() > kMostPassed) passed_.erase(passed_.begin());  // read again where it is asked for
    }
  }

 private:
  static constexpr std::size_t kMostDamaged =
      100000;  // a reader that made no headway would be a fault of ours
  static constexpr std::size_t kMostPassed = 32;
  std::filesystem::path take_;
  std::unique_ptr<RecordingReader> reader_;
  std::mutex mutex_;
  std::size_t next_ = 0, damaged_ = 0;
  std::map<std::size_t, RawFrame> passed_;
};

// One a thread, made when a thread first needs one.
class WalkTake::Developers {
 public:
  Developers(const Calibration& calibration, const FrameFormat& format)
      : calibration_(calibration), format_(format) {}

  Result<LatLongImage> develop(const RawFrame& frame, const ProbePose& pose) {
    std::unique_ptr<FrameDeveloper> developer;
    {
      const std::scoped_lock lock(mutex_);
      if (!free_.empty()) {
        developer = std::move(free_.back());
        free_.pop_back();
      }
    }
    if (!developer) {
      auto made = FrameDeveloper::create(calibration_, format_);
      if (!made) return made.error();
      developer = std::make_unique<FrameDeveloper>(*std::move(made));
    }
    auto developed = developer->develop(frame.codes, frame.info.exposure_us, pose.world_from_probe);
    const std::scoped_lock lock(mutex_);
    free_.push_back(std::move(developer));
    return std::move(developed.picture);
  }

 private:
  Calibration calibration_;
  FrameFormat format_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<FrameDeveloper>> free_;
};

Result<std::shared_ptr<WalkTake>> WalkTake::open(
    const WalkOptions& options, const std::function<void(std::size_t, std::size_t)>& progress) {
  const std::shared_ptr<WalkTake> walk(new WalkTake(options));
  if (walk->options_.poses.empty()) walk->options_.poses = poses_beside(options.take);
  if (const Status read = walk->read_inputs(); !read) return read.error();
  if (const Status chosen = walk->choose_frames(progress); !chosen) return chosen.error();
  return walk;
}

Status WalkTake::read_inputs() {
  auto frames = Frames::open(options_.take);
  if (!frames) return frames.error();
  frames_ = *std::move(frames);
  auto file = read_poses(options_.poses);
  if (!file) return file.error();
  track_ = std::make_unique<PoseTrack>(file->poses, options_.track);
  remark_on(*file);
  const RecordingHeader& header = frames_->reader().header();
  if (options_.calibration.empty() && header.calibration_json.empty())
    return bad(options_.take, "has no calibration attached: allowed with --calibration DIR");
  auto calibration = options_.calibration.empty()
                         ? calibration_from_json(header.calibration_json,
                                                 options_.take.string() + " (attached calibration.json)")
                         : read_calibration(options_.calibration);
  if (!calibration) return calibration.error();
  calibration_ = *std::move(calibration);
  developers_ = std::make_shared<Developers>(calibration_, header.format);
  return {};
}

void WalkTake::remark_on(const PoseFile& file) {
  const std::string name = options_.poses.string() + ": ";
  for (const std::string& remark : file.remarks) pose_remarks_.push_back(name + remark);
  const auto step = [&](const PoseTrack::Jump& jump) {
    char text[240];
    std::snprintf(text, sizeof text,
                  "line %d is %.3g m and %.3g degrees from line %d, %.3g s earlier: allowed "
                  "up to %g m/s and %.4g degrees/s",
                  file.lines[jump.to], jump.metres, jump.radians * 180 / kPi, file.lines[jump.from],
                  jump.seconds, options_.track.most_speed_m_s, options_.track.most_turn_rad_s * 180 / kPi);
    return std::string(text);
  };
  if (const auto& outlier = track_->first_outlier())
    pose_remarks_.push_back(name + std::to_string(track_->outliers().size()) + " of " +
                            std::to_string(file.poses.size()) +
                            " poses are outliers and are left out, the first: " + step(*outlier));
  if (const auto jump = track_->first_jump())
    pose_remarks_.push_back(name + step(*jump) + "; frames between are left out");
}

Status WalkTake::choose_frames(const std::function<void(std::size_t, std::size_t)>& progress) {
  auto total = frames_->reader().frame_count();
  auto developer = FrameDeveloper::create(calibration_, frames_->reader().header().format);
  if (!developer) return developer.error();
  const bool compare = options_.redundant.most_difference > 0;
  RedundancyFilter filter(options_.redundant);
  std::optional<DirectionBins> bins;
  std::vector<Frame> posed;
  double most_tilt_rad = 0;
  std::int64_t first_ns = 0, last_ns = 0;
  for (auto frame = frames_->next();; frame = frames_->next()) {
    if (!frame) return frame.error();
    if (!*frame) break;
    const RawFrame& raw = **frame;
    if (counts_.frames == 0) first_ns = raw.info.capture_mono_ns;
    last_ns = raw.info.capture_mono_ns;
    const std::size_t number = counts_.frames++;
    if (progress && total && *total > 0)
      progress(counts_.frames, std::max<std::size_t>(*total, counts_.frames));
    const PoseTrack::At at = track_->at(raw.info.capture_mono_ns, options_.lag_s);
    without_pose_.add(raw.info.capture_mono_ns, at.known == PoseTrack::Known::yes);
    const bool outside = at.known == PoseTrack::Known::outside;
    counts_.outside += outside ? 1 : 0;
    counts_.after_last +=
        outside && raw.info.capture_mono_ns + std::llround(options_.lag_s * 1e9) > track_->last_ns() ? 1 : 0;
    counts_.in_gap += at.known == PoseTrack::Known::in_gap ? 1 : 0;
    counts_.in_jump += at.known == PoseTrack::Known::in_jump ? 1 : 0;
    if (at.known != PoseTrack::Known::yes) continue;
    posed.push_back({number, at.pose});
    most_tilt_rad = std::max(
        most_tilt_rad, std::acos(std::clamp((at.pose.world_from_probe * Vec3d::UnitY()).y(), -1.0, 1.0)));
    const auto developed = developer->develop(raw.codes, raw.info.exposure_us, at.pose.world_from_probe);
    counts_.clipped_frames += developed.clipped_pixels > 0 ? 1 : 0;
    counts_.most_clipped_pixels = std::max(counts_.most_clipped_pixels, developed.clipped_pixels);
    if (!compare) continue;
    if (!bins)
      bins.emplace(LatLongProbe{}, developed.picture.width, developed.picture.height, options_.cells, 1);
    std::vector<Rgb> seen(bins->directions().size());
    bins->mean_radiance(developed.picture.pixels, seen);
    filter.add(at.pose.position_m, std::move(seen));
  }
  counts_.damaged = frames_->damaged();
  if (counts_.frames == 0) return bad(options_.take, "has no whole frame");
  if (posed.empty()) return no_pose(first_ns, last_ns);
  for (std::size_t i = 0; i < posed.size(); ++i)
    if (!compare || filter.kept()[i]) kept_.push_back(posed[i]);
  counts_.kept = kept_.size();
  counts_.redundant = posed.size() - kept_.size();
  theta_max_rad_ = std::min(kPi, developer->theta_max_rad() + most_tilt_rad);
  return {};
}

Error WalkTake::no_pose(std::int64_t first_ns, std::int64_t last_ns) const {
  std::string jumps;
  if (counts_.in_jump > 0)
    jumps = "; " + std::to_string(counts_.in_jump) + " frames are among outliers or in jumps" +
            (pose_remarks_.empty() ? "" : ", " + pose_remarks_.back());
  return bad(options_.poses, "no frame of " + options_.take.string() + " has a pose: frames are from " +
                                 seconds(first_ns) + " to " + seconds(last_ns) + ", poses from " +
                                 seconds(track_->first_ns()) + " to " + seconds(track_->last_ns()) +
                                 " at a lag of " + std::to_string(options_.lag_s * 1e3) +
                                 " ms, both by CLOCK_MONOTONIC" + jumps);
}

std::vector<std::string> WalkTake::remarks() const {
  std::vector<std::string> lines;
  const std::string take = options_.take.string() + ": ";
  if (const std::size_t without = counts_.outside + counts_.in_gap + counts_.in_jump; without > 0) {
    char text[240];
    std::snprintf(
        text, sizeof text,
        "%zu of %zu frames have no pose and are left out: %zu before the first, %zu after the last, %zu in "
        "gaps above %g s, %zu in jumps; of the take: ",
        without, counts_.frames, counts_.outside - counts_.after_last, counts_.after_last, counts_.in_gap,
        options_.track.most_gap_s, counts_.in_jump);
    lines.push_back(take + text + without_pose_.text());
  }
  lines.insert(lines.end(), pose_remarks_.begin(), pose_remarks_.end());
  if (counts_.damaged > 0)
    lines.push_back(take + "damaged in " + std::to_string(counts_.damaged) +
                    " places, whose frames are left out");
  if (counts_.clipped_frames > 0)
    lines.push_back(take + std::to_string(counts_.clipped_frames) + " frames have saturated pixels, up to " +
                    std::to_string(counts_.most_clipped_pixels) +
                    " of one frame: light there is brighter than the field says");
  return lines;
}

std::string WalkTake::origin() const {
  std::error_code absent;
  const auto size = std::filesystem::file_size(options_.take, absent);
  const auto time = std::filesystem::last_write_time(options_.take, absent).time_since_epoch().count();
  std::uint64_t mark = fnv1a(calibration_.id);
  for (const Frame& frame : kept_) {
    const Vec3d& at = frame.pose.position_m;
    const Eigen::Quaterniond& q = frame.pose.world_from_probe;
    char text[200];
    std::snprintf(text, sizeof text, "%zu %.17g %.17g %.17g %.17g %.17g %.17g %.17g ", frame.number, at.x(),
                  at.y(), at.z(), q.x(), q.y(), q.z(), q.w());
    mark = fnv1a(text, mark);
  }
  char text[120];
  std::snprintf(text, sizeof text, " of %ju bytes, time %jd, walk %016jx", static_cast<std::uintmax_t>(size),
                static_cast<std::intmax_t>(time), static_cast<std::uintmax_t>(mark));
  return options_.take.string() + text;
}

Result<LatLongImage> WalkTake::picture(std::size_t kept) {
  const auto needed = [this](std::size_t number) {
    const auto found = std::lower_bound(kept_.begin(), kept_.end(), number,
                                        [](const Frame& f, std::size_t n) { return f.number < n; });
    return found != kept_.end() && found->number == number;
  };
  auto raw = frames_->at(kept_[kept].number, needed);
  if (!raw) return raw.error();
  return developers_->develop(*raw, kept_[kept].pose);
}

ProbeTake WalkTake::probes(const std::shared_ptr<WalkTake>& walk) {
  ProbeTake take;
  for (const Frame& frame : walk->kept_) take.positions.push_back(frame.pose.position_m);
  take.picture = [walk](std::size_t i) { return walk->picture(i); };
  take.name = [walk](std::size_t i) {
    return walk->options_.take.string() + ": frame " + std::to_string(walk->kept_[i].number);
  };
  return take;
}

}  // namespace lightwell
