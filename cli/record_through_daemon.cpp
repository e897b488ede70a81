// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/progress.h"
#include "cli/record.h"
#include "interface/host_port.h"
#include "interface/http_client.h"

namespace lightwell::cli {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;

// The daemon's answer, or its own words for why not.
Result<Json> ask(const RecordOptions& options, const HttpRequest& request) {
  const auto answer = http_request(options.daemon, request);
  if (!answer)
    return Error{answer.error().kind,
                 answer.error().message + " (is lightwelld running? --source records without it)"};
  const Json json = Json::parse(answer->body, nullptr, false);
  if (answer->status == 200 && json.is_object()) return json;
  std::string why = "answered with HTTP " + std::to_string(answer->status);
  if (json.is_object() && json.contains("error") && json["error"].is_string()) why = json["error"];
  return Error{answer->status == 400 ? ErrorKind::usage : ErrorKind::failed,
               "daemon at " + options.daemon + ": " + why};
}

Result<Json> order(const RecordOptions& options, const char* action) {
  HttpRequest request;
  request.method = "POST";
  request.path = "/api/v1/record";
  request.body = Json{{"action", action}, {"file", options.out.filename().string()}}.dump();
  return ask(options, request);
}

Json recording_of(const Json& status) {
  return status.value("recording", Json::object());
}

// Until the time is over, or the take has ended by itself.
void wait(const RecordOptions& options, const std::atomic<bool>& interrupted) {
  constexpr std::chrono::milliseconds kStep{50}, kLook{500};
  const auto begin = Clock::now();
  const auto end =
      begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.seconds));
  auto look = begin + kLook;
  Progress progress(static_cast<std::size_t>(options.seconds * 1000));
  for (auto now = begin; now < end && !interrupted; now = Clock::now()) {
    progress.done(
        static_cast<std::size_t>(std::chrono::duration_cast<std::chrono::milliseconds>(now - begin).count()));
    if (now >= look) {
      look = now + kLook;
      const auto status = ask(options, {.path = "/api/v1/status"});
      if (!status || !recording_of(*status).value("active", false)) return;
    }
    std::this_thread::sleep_for(std::min<Clock::duration>(kStep, end - now));
  }
}

// A daemon on this machine wrote the take into its own folder; it belongs where the caller wants it.
Result<std::filesystem::path> bring(const RecordOptions& options, const std::filesystem::path& directory) {
  const std::filesystem::path made = directory / options.out.filename();
  std::error_code why;
  if (std::filesystem::equivalent(made, options.out, why)) return options.out;
  const auto address = parse_host_port(options.daemon);
  if (directory.empty() || !address || !is_loopback(address->host) || !std::filesystem::exists(made, why))
    return made;
  if (std::filesystem::exists(options.out, why)) return made;
  std::filesystem::rename(made, options.out, why);
  if (!why) return options.out;
  return made;  // another file system or not ours to move: it is safe where it is
}

}  // namespace

Result<Recorded> record_through_daemon(const RecordOptions& options, const std::atomic<bool>& interrupted,
                                       bool& began) {
  if (std::error_code ignored; std::filesystem::exists(std::filesystem::symlink_status(options.out, ignored)))
    return Error{ErrorKind::failed, options.out.string() + ": exists already and is not overwritten"};
  const std::filesystem::path folder = options.out.has_parent_path() ? options.out.parent_path() : ".";
  if (std::error_code ignored; !std::filesystem::is_directory(folder, ignored))
    return Error{ErrorKind::failed,
                 options.out.string() + ": the folder " + folder.string() + " does not exist"};
  const auto started = order(options, "start");
  if (!started) return started.error();
  began = true;
  wait(options, interrupted);
  const auto stopped = order(options, "stop");
  if (!stopped) return stopped.error();
  const Json recording = recording_of(*stopped);
  if (const std::string error = recording.value("error", ""); !error.empty())
    return Error{ErrorKind::failed, "daemon at " + options.daemon + ": " + error};
  const auto file = bring(options, recording.value("directory", ""));
  if (!file) return file.error();
  return Recorded{*file, recording.value("frames", std::uint64_t{0}),
                  recording.value("dropped", std::uint64_t{0}), recording.value("bytes", std::uint64_t{0})};
}

}  // namespace lightwell::cli
