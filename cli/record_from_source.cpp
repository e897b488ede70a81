// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <memory>
#include <optional>

#include "cli/progress.h"
#include "cli/record.h"
#include "daemon/capture/capture_source.h"
#include "daemon/capture/recording_source.h"
#include "daemon/capture/simulated_source.h"
#include "daemon/record/pose_recorder.h"
#include "daemon/record/recorder.h"
#include "interface/calibration_io.h"
#include "interface/part_file.h"

namespace lightwell::cli {
namespace {

using Clock = std::chrono::steady_clock;

Error failed(const RecordOptions& options, const std::string& what) {
  return {ErrorKind::failed, options.out.string() + ": " + what};
}

// The folder's, or the one that the source knows: attached to a take, a simulated camera's own; empty: none.
Result<std::string> calibration_text(const RecordOptions& options) {
  constexpr std::string_view kRecording = "recording:", kSimulated = "simulated:";
  if (!options.calibration.empty()) {
    const auto calibration = read_calibration(options.calibration);
    if (!calibration) return calibration.error();
    return calibration_to_json(*calibration);
  }
  if (options.source.starts_with(kRecording)) {
    const auto reader = RecordingReader::open(options.source.substr(kRecording.size()));
    if (!reader) return reader.error();
    return (*reader)->header().calibration_json;
  }
  if (options.source.starts_with(kSimulated)) {
    const auto calibration = simulated_calibration(options.source.substr(kSimulated.size()), {});
    if (!calibration) return calibration.error();
    return calibration_to_json(*calibration);
  }
  return std::string();
}

Status check_out(const std::filesystem::path& out) {
  const std::filesystem::path folder = out.has_parent_path() ? out.parent_path() : ".";
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored))
    return Error{ErrorKind::failed, out.string() + ": the folder " + folder.string() + " does not exist"};
  if (std::filesystem::exists(std::filesystem::symlink_status(out, ignored)))
    return Error{ErrorKind::failed, out.string() + ": exists already and is not overwritten"};
  return {};
}

RecordingHeader header_for(const FrameInfo& first, const CaptureSource& source, const RecordOptions& options,
                           std::string calibration) {
  return {.format = first.format,
          .codec = options.codec,
          .rate_hz = source.rate_hz(),
          .source = options.source,
          .calibration_json = std::move(calibration),
          .start_utc_ns = first.capture_utc_ns};
}

// A camera may take a while to answer; a recording that ends without a frame never will.
Result<FrameLease> first_frame(CaptureSource& source, const RecordOptions& options,
                               const std::atomic<bool>& interrupted) {
  constexpr std::chrono::seconds kPatience{15};
  const auto deadline = Clock::now() + kPatience;
  while (!interrupted && Clock::now() < deadline && source.state() != SourceState::ended)
    if (FrameLease lease = source.wait(std::chrono::milliseconds(100))) return lease;
  return failed(options, "nothing recorded, no frame came: " + source.describe());
}

// The exact poses of frames whose source knows them, beside the take.
class KnownPoses {
 public:
  static Result<KnownPoses> create(const FrameInfo& first, const RecordOptions& options) {
    KnownPoses poses;
    if (!first.probe_position_m || !options.tracking.empty()) return poses;
    auto writer = PoseFileWriter::create(poses_beside(options.out), false);
    if (!writer) return writer.error();
    poses.writer_ = *std::move(writer);
    return poses;
  }
  void add(const FrameInfo& frame) {
    if (!writer_ || !frame.probe_position_m || !written_) return;
    written_ =
        writer_->write({frame.capture_mono_ns, {*frame.probe_position_m, Eigen::Quaterniond::Identity()}});
    if (written_) ++count_;
  }
  // With the take they belong to.
  Status keep() {
    if (!writer_) return {};
    const Status kept = writer_->keep();
    return written_ ? kept : written_;
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  std::optional<PoseFileWriter> writer_;
  Status written_;
  std::uint64_t count_ = 0;
};

void take_frames(CaptureSource& source, Recorder& recorder, KnownPoses& poses, const RecordOptions& options,
                 const std::atomic<bool>& interrupted) {
  const auto begin = Clock::now();
  const auto end =
      begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.seconds));
  Progress progress(static_cast<std::size_t>(options.seconds * 1000));
  for (auto now = begin; now < end; now = Clock::now()) {
    if (interrupted || source.state() == SourceState::ended || !recorder.stats().active) return;
    progress.done(
        static_cast<std::size_t>(std::chrono::duration_cast<std::chrono::milliseconds>(now - begin).count()));
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - now);
    if (const FrameLease lease = source.wait(std::min(left, std::chrono::milliseconds(100)))) {
      recorder.offer(lease.info(), lease.bytes());
      poses.add(lease.info());
    }
  }
}

}  // namespace

Result<Recorded> record_from_source(const RecordOptions& options, const std::atomic<bool>& interrupted) {
  if (Status status = check_out(options.out); !status) return status.error();
  auto calibration = calibration_text(options);
  if (!calibration) return calibration.error();
  auto made = make_capture_source(options.source, {});
  if (!made) return made.error();
  CaptureSource& source = **made;
  if (Status status = source.start(); !status) return status.error();

  PartFile part(options.out);
  Recorder recorder(options.out.parent_path());
  KnownPoses poses;
  {
    const auto first = first_frame(source, options, interrupted);
    if (!first) return first.error();
    const RecordingHeader header = header_for(first->info(), source, options, std::move(*calibration));
    if (Status status = recorder.start_at(part.path(), header); !status)
      return part.about_out(status.error());
    auto known = KnownPoses::create(first->info(), options);
    if (!known) return known.error();
    poses = *std::move(known);
    recorder.offer(first->info(), first->bytes());
    poses.add(first->info());
  }
  take_frames(source, recorder, poses, options, interrupted);
  const std::uint64_t skipped = source.counters().skipped;
  source.stop();
  const Status closed = recorder.stop();
  const Recorder::Stats stats = recorder.stats();
  if (stats.frames == 0) return closed ? failed(options, "nothing recorded") : part.about_out(closed.error());
  // A take whose disk ran full is readable to its last whole cluster: worth more on set than no take.
  if (Status status = part.keep(); !status) return status.error();
  const Status kept = poses.keep();
  if (!closed)
    return failed(options, "holds " + std::to_string(stats.frames) + " frames only, " +
                               part.about_out(closed.error()).message);
  if (!kept) return kept.error();
  return Recorded{options.out, stats.frames, stats.dropped + skipped, stats.bytes, poses.count()};
}

}  // namespace lightwell::cli
