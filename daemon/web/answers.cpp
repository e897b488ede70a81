// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/answers.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <string_view>

#include "daemon/web/json.h"
#include "daemon/web/page_files.h"
#include "daemon/web/pictures.h"
#include "interface/environment_io.h"
#include "interface/jpeg.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr int kPictureSize = 560;  // pixels; sharp on a phone, a few milliseconds to make
constexpr const char* kNoFrame = "no frame has been published yet";

const char* type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  if (name.ends_with(".svg")) return "image/svg+xml";
  return "application/yaml";
}

}  // namespace

WebAnswer error_answer(int status, const std::string& message) {
  return {status, "application/json", error_json(message)};
}

std::function<WebAnswer()> WebAnswers::find(const std::string& path) {
  struct Route {
    const char* path;
    WebAnswer (WebAnswers::*answer)();
  };
  static constexpr Route kRoutes[] = {{"/api/v1/status", &WebAnswers::status},
                                      {"/api/v1/lights", &WebAnswers::lights},
                                      {"/api/v1/environment.exr", &WebAnswers::environment_exr},
                                      {"/api/v1/environment.jpg", &WebAnswers::environment_jpg},
                                      {"/metrics", &WebAnswers::metrics}};
  for (const Route& route : kRoutes)
    if (path == route.path) return [this, &route] { return (this->*route.answer)(); };
  for (const PageFile& file : page_files()) {
    const std::string own_path = file.name == "index.html"     ? "/"
                                 : file.name == "openapi.yaml" ? "/api/openapi.yaml"
                                                               : "/" + std::string(file.name);
    if (path == own_path)
      return [&file] { return WebAnswer{200, type_of(file.name), std::string(file.content)}; };
  }
  return {};
}

WebAnswer WebAnswers::status() {
  return {200, "application/json", status_json(control_.status())};
}

WebAnswer WebAnswers::lights() {
  const auto lease = snapshots_.wait_newer(0, 0ms);
  if (!lease) return error_answer(503, kNoFrame);
  const auto fit = control_.newest_fit();
  return {200, "application/json", lights_json(*lease, fit ? &*fit : nullptr)};
}

WebAnswer WebAnswers::metrics() {
  const auto lease = snapshots_.wait_newer(0, 0ms);
  return {200, "text/plain; version=0.0.4; charset=utf-8",
          metrics_text(control_.status(), lease ? &*lease : nullptr, counters_)};
}

WebAnswer WebAnswers::environment_exr() {
  return picture(exr_picture_, "image/x-exr",
                 [](const Snapshot& s) { return environment_to_exr(lat_long_from_polar_map(s.map)); });
}

WebAnswer WebAnswers::environment_jpg() {
  return picture(jpg_picture_, "image/jpeg", [](const Snapshot& s) {
    return encode_jpeg(kPictureSize, kPictureSize, fisheye_picture(s.map, kPictureSize));
  });
}

WebAnswer WebAnswers::picture(Picture& last, const char* type, Result<std::string> (*make)(const Snapshot&)) {
  const auto lease = snapshots_.wait_newer(0, 0ms);
  if (!lease) return error_answer(503, kNoFrame);
  if (last.number != lease->number || last.capture_ns != lease->capture_mono_ns) {
    auto made = make(*lease);
    if (!made) return error_answer(500, made.error().message);
    last = {lease->number, lease->capture_mono_ns, std::move(made).value()};
  }
  return {200, type, last.body};
}

WebAnswer WebAnswers::record(const std::string& body) {
  const auto json = nlohmann::json::parse(body, nullptr, false);
  if (!json.is_object())
    return error_answer(400, R"(expected {"action": "start", "file": "name.mkv"} or {"action": "stop"})");
  const auto text = [&](const char* key) {
    const auto at = json.find(key);
    return at != json.end() && at->is_string() ? at->get<std::string>() : std::string();
  };
  const std::string action = text("action");
  if (action != "start" && action != "stop")
    return error_answer(400, R"(action: expected "start" or "stop")");
  const std::string file = text("file");
  const Status done = action == "start" ? control_.start_recording(file) : control_.stop_recording();
  if (done.ok()) return status();
  // usage: the caller can do better; otherwise the state of the daemon or the disk is in the way.
  return error_answer(done.error().kind == ErrorKind::usage ? 400 : 409, done.error().message);
}

}  // namespace lightwell
