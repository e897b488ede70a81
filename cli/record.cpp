// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/record.h"

#include <csignal>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/command.h"
#include "daemon/record/pose_recorder.h"
#include "daemon/record/take_name.h"
#include "interface/atomic_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

// What stands in the pose file beside the take.
struct RecordedPoses {
  std::string file;
  PoseRecorder::Stats stats;
};

void print(const RecordOptions& options, const Recorded& recorded,
           const std::optional<RecordedPoses>& poses) {
  const std::string file = recorded.file.string();
  if (options.json) {
    nlohmann::ordered_json json = {{"schema", "lightwell.record/1"},
                                   {"file", file},
                                   {"frames", recorded.frames},
                                   {"dropped", recorded.dropped},
                                   {"bytes", recorded.bytes}};
    if (poses)
      json["poses"] = {{"file", poses->file},
                       {"poses", poses->stats.poses},
                       {"malformed", poses->stats.malformed},
                       {"out_of_order", poses->stats.out_of_order},
                       {"clock_steps", poses->stats.clock_steps},
                       {"other_cameras", poses->stats.other_cameras},
                       {"longest_silence_s", poses->stats.longest_silence_s}};
    std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
    return;
  }
  std::printf("%s: %llu frames, %.1f MB", file.c_str(), static_cast<unsigned long long>(recorded.frames),
              static_cast<double>(recorded.bytes) * 1e-6);
  if (recorded.dropped > 0) std::printf(", %llu dropped", static_cast<unsigned long long>(recorded.dropped));
  std::printf("%s\n", recorded.file == options.out ? "" : " (in the daemon's record directory)");
  if (poses)
    std::printf("%s: %llu poses\n", poses->file.c_str(), static_cast<unsigned long long>(poses->stats.poses));
}

// take_exists: one that the poses belong to, whole or not.
Result<Recorded> record(const RecordOptions& options, bool& take_exists) {
  auto recorded = options.source.empty() ? record_through_daemon(options, interrupted, take_exists)
                                         : record_from_source(options, interrupted);
  std::error_code ignored;
  take_exists = take_exists || recorded || std::filesystem::exists(options.out, ignored);
  return recorded;
}

void complain(const std::string& what) {
  std::fprintf(stderr, "lightwell: %s\n", printable(what).c_str());
}

// What its recorder did not say as it happened.
void complain_about(const PoseRecorder::Stats& stats) {
  constexpr double kSilence_s = 1;
  if (stats.malformed > 0)
    complain(std::to_string(stats.malformed) +
             " packets of the tracker were malformed and left out, the first: " + *stats.first_malformed);
  if (stats.out_of_order > 0)
    complain(std::to_string(stats.out_of_order) +
             " poses were left out: no later than one before them, by their arrival or the tracker's clock");
  if (stats.poses > 0 && stats.silence_at_end_s > kSilence_s) {
    char text[120];
    std::snprintf(text, sizeof text, "the tracker was silent for the last %.1f s: frames there have no pose",
                  stats.silence_at_end_s);
    complain(text);
  }
}

std::string cameras_heard(const PoseRecorder::Stats& stats) {
  std::string numbers;
  for (const int number : stats.other_cameras)
    numbers += (numbers.empty() ? "" : ", ") + std::to_string(number);
  return numbers.empty() ? ""
                         : " of camera " + std::to_string(stats.camera.value_or(0)) + ", but of " + numbers;
}

// The take and, from before its first frame until after its last, what the tracker sends.
int record_with_tracker(const RecordOptions& options) {
  auto tracking = parse_tracking(options.tracking);
  if (!tracking) return fail(tracking.error());
  tracking->camera = options.tracking_camera;
  const auto daemon = parse_host_port(options.daemon);
  if (options.source.empty() && (!daemon || !is_loopback(daemon->host)))
    return fail(usage("--tracking with --daemon " + options.daemon +
                      ": allowed a daemon on this machine, whose clock stamps the poses too"));
  RecordedPoses poses{poses_beside(options.out).string(), {}};
  auto recorder = PoseRecorder::start(*tracking, poses.file, complain);
  if (!recorder) return fail(recorder.error());
  bool take_exists = false;
  const auto recorded = record(options, take_exists);
  const Status written = (*recorder)->stop();
  poses.stats = (*recorder)->stats();
  const Status kept = take_exists && poses.stats.poses > 0 ? (*recorder)->keep() : Status();
  complain_about(poses.stats);
  if (!recorded) {
    if (!kept) complain(kept.error().message);
    return fail(recorded.error());
  }
  if (poses.stats.poses == 0)
    return fail({ErrorKind::failed, "--tracking " + options.tracking + ": no pose came" +
                                        cameras_heard(poses.stats) + "; the take " + recorded->file.string() +
                                        " is without"});
  print(options, *recorded, poses);
  if (!written) return fail(written.error());
  return kept ? 0 : fail(kept.error());
}

int run(const RecordOptions& options) {
  if (options.out.filename().empty())
    return fail(usage("--out " + options.out.string() + " is not a file's name"));
  if (const Status named = check_output_name(options.out); !named) return fail(named.error());
  if (const std::string name = options.out.filename().string();
      options.source.empty() && !check_take_name(name))
    return fail(usage("--out " + options.out.string() +
                      ": the daemon takes plain names only, such as take.mkv: " + kTakeNameRule +
                      "; with --source any name will do"));
  constexpr std::string_view kRecording = "recording:";
  if (options.source.starts_with(kRecording))
    if (const Status other =
            check_output_is_no_input(options.out, {options.source.substr(kRecording.size())});
        !other)
      return fail(other.error());
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  if (!options.tracking.empty()) return record_with_tracker(options);
  bool take_exists = false;
  const auto recorded = record(options, take_exists);
  if (!recorded) return fail(recorded.error());
  std::optional<RecordedPoses> known;
  if (recorded->known_poses > 0)
    known = {poses_beside(options.out).string(), {.poses = recorded->known_poses}};
  print(options, *recorded, known);
  return 0;
}

}  // namespace

Command add_record(CLI::App& app) {
  struct Arguments {
    RecordOptions options;
    std::string out, codec = "raw";
  };
  constexpr double kWeek = 7 * 24 * 3600;
  const auto arguments = std::make_shared<Arguments>();
  RecordOptions& options = arguments->options;
  CLI::App* command =
      app.add_subcommand("record", "Record a take, through the running daemon or from a source");
  command->footer(
      "Example: lightwell record --seconds 10 --out take.mkv\n"
      "         lightwell record --seconds 10 --out take.mkv --source aravis:127.0.0.1 --codec ffv1");
  command->add_option("--seconds", options.seconds, "How long; Ctrl-C ends earlier and keeps the take")
      ->check(numbers_above_0_to(kWeek, "above 0 to 604800 (a week)"))
      ->required();
  command->add_option("--out", arguments->out, "The take (.mkv); never overwrites")->required();
  command->add_option(
      "--source", options.source,
      "Record from here, without a daemon: aravis:ADDRESS, v4l2:/dev/videoN, libcamera:ID, recording:FILE");
  command->add_option("--codec", arguments->codec, "raw, or ffv1: a third of the size, up to a core of work")
      ->check(CLI::IsMember({"raw", "ffv1"}));
  command->add_option("--calibration", options.calibration, "Folder to attach to a take made with --source");
  command->add_option(
      "--tracking", options.tracking,
      "Write what a tracker sends beside the take (take.poses.csv): opentrackio:ADDRESS:PORT or "
      "freed:ADDRESS:PORT, of this machine or a multicast group");
  command
      ->add_option("--tracking-camera", options.tracking_camera,
                   "Which camera to follow where the port hears several: FreeD's id, OpenTrackIO's "
                   "sourceNumber [the first]")
      ->check(whole_numbers(0, kMostTrackedCamera))
      ->needs("--tracking")
      ->type_name("NUMBER");
  command->add_option("--daemon", options.daemon, "ADDRESS:PORT of the daemon");
  command->add_flag("--json", options.json, "Machine-readable result on stdout");
  return {command, [arguments] {
            arguments->options.out = arguments->out;
            arguments->options.codec =
                recording_codec_from_name(arguments->codec).value_or(RecordingCodec::raw);
            return run(arguments->options);
          }};
}

}  // namespace lightwell::cli
