// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/command.h"
#include "cli/progress.h"
#include "interface/calibration_io.h"
#include "interface/printable.h"
#include "interface/recording.h"

namespace lightwell::cli {
namespace {

// What a pass over all of a take's frames finds.
struct Contents {
  RecordingHeader header;
  std::uint64_t bytes = 0;
  std::uint64_t frames = 0;
  std::uint64_t lost = 0;  // gaps in the camera's sequence
  RecordedFrame first, last;
  bool complete = false;
  std::string damage;          // the first complaint
  std::string calibration_id;  // empty: none, or unreadable
};

Result<Contents> look_through(const std::string& file) {
  const auto opened = RecordingReader::open(file);
  if (!opened) return opened.error();
  RecordingReader& reader = **opened;
  Contents found;
  found.header = reader.header();
  std::error_code ignored;
  found.bytes = std::filesystem::file_size(file, ignored);
  found.complete = reader.complete();
  const auto expected = reader.frame_count();
  Progress progress(expected ? *expected : 0);
  for (;;) {
    const auto frame = reader.skip();
    if (!frame) {
      if (found.damage.empty()) found.damage = frame.error().message;
      continue;
    }
    if (!*frame) break;
    if (found.frames == 0)
      found.first = **frame;
    else if ((*frame)->sequence > found.last.sequence)
      found.lost += (*frame)->sequence - found.last.sequence - 1;
    found.last = **frame;
    progress.done(++found.frames);
  }
  if (found.frames == 0) return Error{ErrorKind::bad_input, file + ": holds no whole frame"};
  if (!found.header.calibration_json.empty()) {
    const auto calibration =
        calibration_from_json(found.header.calibration_json, file + " (attached calibration.json)");
    if (calibration)
      found.calibration_id = calibration->id;
    else if (found.damage.empty())
      found.damage = calibration.error().message;
  }
  return found;
}

double duration_s(const Contents& found) {
  return (static_cast<double>(found.last.capture_mono_ns) -
          static_cast<double>(found.first.capture_mono_ns)) *
         1e-9;
}

std::string utc_text(std::int64_t utc_ns) {
  const std::int64_t seconds = utc_ns / 1'000'000'000 - (utc_ns % 1'000'000'000 < 0 ? 1 : 0);
  const auto time = static_cast<std::time_t>(seconds);
  std::tm utc{};
  if (::gmtime_r(&time, &utc) == nullptr) return "unknown";
  char text[80];
  const std::size_t length = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text + length, sizeof text - length, ".%03dZ",
                static_cast<int>((utc_ns - seconds * 1'000'000'000) / 1'000'000));
  return text;
}

void print_json(const std::string& file, const Contents& found) {
  const FrameFormat& format = found.header.format;
  const nlohmann::ordered_json calibration_id =
      found.calibration_id.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(found.calibration_id);
  const nlohmann::ordered_json json = {
      {"schema", "lightwell.take/1"},
      {"file", file},
      {"frames", found.frames},
      {"size", {format.width, format.height}},
      {"format", name(format.pixel_format)},
      {"codec", name(found.header.codec)},
      {"rate_hz", found.header.rate_hz},
      {"duration_s", duration_s(found)},
      {"first_utc", utc_text(found.first.capture_utc_ns)},
      {"last_utc", utc_text(found.last.capture_utc_ns)},
      {"first_mono_ns", found.first.capture_mono_ns},
      {"last_mono_ns", found.last.capture_mono_ns},
      {"first_sequence", found.first.sequence},
      {"last_sequence", found.last.sequence},
      {"lost_frames", found.lost},
      {"timecode",
       found.first.timecode ? nlohmann::ordered_json(timecode_text(*found.first.timecode)) : nullptr},
      {"exposure_us", found.first.exposure_us},
      {"source", found.header.source},
      {"start_utc", utc_text(found.header.start_utc_ns)},
      {"calibration_id", calibration_id},
      {"complete", found.complete},
      {"damage", found.damage},
      {"bytes", found.bytes}};
  // Text from the camera or the file's name may be any bytes.
  std::printf("%s\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

void print_text(const std::string& file, const Contents& found) {
  const FrameFormat& format = found.header.format;
  std::printf("%s\n", file.c_str());
  std::printf("frames       %llu, %llu lost\n", static_cast<unsigned long long>(found.frames),
              static_cast<unsigned long long>(found.lost));
  std::printf("format       %dx%d %s, stored as %s, %.1f MB\n", format.width, format.height,
              std::string(name(format.pixel_format)).c_str(), std::string(name(found.header.codec)).c_str(),
              static_cast<double>(found.bytes) * 1e-6);
  std::printf("duration     %.3f s at %g Hz\n", duration_s(found), found.header.rate_hz);
  std::printf("taken        %s to %s\n", utc_text(found.first.capture_utc_ns).c_str(),
              utc_text(found.last.capture_utc_ns).c_str());
  if (found.first.timecode)
    std::printf("timecode     from %s\n", timecode_text(*found.first.timecode).c_str());
  std::printf("source       %s\n", found.header.source.empty() ? "unknown" : found.header.source.c_str());
  std::printf("calibration  %s\n", found.calibration_id.empty() ? "none" : found.calibration_id.c_str());
  std::printf("complete     %s\n", found.complete ? "yes" : "no");
}

}  // namespace

Command add_info(CLI::App& app) {
  struct Options {
    std::string take;
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("info", "Say what a take holds: frames, format, times, losses, calibration");
  command->footer("Example: lightwell info take.mkv --json");
  command->add_option("TAKE", options->take, "Recording (.mkv)")->required();
  command->add_flag("--json", options->json, "Machine-readable result on stdout");
  return {command, [options] {
            const auto found = look_through(options->take);
            if (!found) return fail(found.error());
            // A cut take is a good answer to the question; that it is cut belongs to the answer.
            if (!found->damage.empty())
              std::fprintf(stderr, "lightwell: %s\n", printable(found->damage).c_str());
            options->json ? print_json(options->take, *found) : print_text(options->take, *found);
            return 0;
          }};
}

}  // namespace lightwell::cli
