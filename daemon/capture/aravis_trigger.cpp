// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/aravis_trigger.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/capture/glib_error.h"

namespace lightwell {
namespace {

constexpr auto kRetryRefused = std::chrono::milliseconds(500);

std::vector<std::string> trigger_sources(ArvCamera* camera) {
  std::vector<std::string> list;
  if (!arv_camera_is_feature_available(camera, "TriggerSource", nullptr)) return list;
  guint count = 0;
  const char** names = arv_camera_dup_available_trigger_sources(camera, &count, nullptr);
  for (guint i = 0; names != nullptr && i < count; ++i) list.emplace_back(names[i]);
  g_free(names);
  return list;
}

bool is_input(std::string_view source) {
  return source.starts_with("Line") || source.starts_with("Input");
}

// What is in force, whoever set it.
void read_trigger(ArvCamera* camera, SessionSettings& settings) {
  if (!arv_camera_is_feature_available(camera, "TriggerMode", nullptr)) return;
  const char* mode = arv_camera_get_string(camera, "TriggerMode", nullptr);
  settings.free_running = mode == nullptr || std::string_view(mode) != "On";
  if (settings.free_running) return;
  const char* source = arv_camera_get_trigger_source(camera, nullptr);
  settings.trigger = source != nullptr ? std::string("triggered by ") + source : "triggered";
}

std::optional<CaptureFault> trigger_by(ArvCamera* camera, const std::string& source) {
  GlibError error;
  if (arv_camera_is_feature_available(camera, "ExposureMode", nullptr))
    arv_camera_set_exposure_mode(camera, ARV_EXPOSURE_MODE_TIMED, error.out());
  if (!error) arv_camera_set_trigger(camera, source.c_str(), error.out());
  if (!error) return std::nullopt;
  return CaptureFault{SourceState::opening, "does not take trigger " + source + ": " + error.text(),
                      kRetryRefused};
}

}  // namespace

std::optional<CaptureFault> set_trigger(ArvCamera* camera, const CaptureOptions& options,
                                        SessionSettings& settings) {
  const std::string& wanted = options.trigger;
  if (wanted == "off") {
    arv_camera_clear_triggers(camera, nullptr);  // a camera without triggers has none to clear
  } else if (!wanted.empty()) {
    const auto sources = trigger_sources(camera);
    const auto at = wanted == "any" ? std::find_if(sources.begin(), sources.end(), is_input)
                                    : std::find(sources.begin(), sources.end(), wanted);
    if (at != sources.end()) {
      if (auto fault = trigger_by(camera, *at)) return fault;
    } else if (wanted == "any") {
      settings.remark += (settings.remark.empty() ? "" : "; ") + std::string("has no trigger input");
    } else {
      std::string list;
      for (const std::string& source : sources) list += (list.empty() ? "" : ", ") + source;
      return CaptureFault{SourceState::opening,
                          "trigger = \"" + wanted + "\": the camera has " + (list.empty() ? "none" : list),
                          kRetryRefused};
    }
  }
  read_trigger(camera, settings);
  return std::nullopt;
}

}  // namespace lightwell
