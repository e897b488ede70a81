// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/session_text.h"

#include <cstdio>

namespace lightwell::render {
namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[256];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

// Empty: light that does not age.
std::string light_text(const ViewNumbers& n) {
  if (!n.light_arrived) return "waiting for light";
  if (!n.light_age) return "";
  return text("light %.1f s old", std::chrono::duration<double>(*n.light_age).count());
}

}  // namespace

std::string title_text(const ViewNumbers& n) {
  const std::string light = light_text(n);
  return text("Lightwell – %.1f fps – %zu lights", n.fps, n.lights) + (light.empty() ? "" : " – " + light);
}

std::vector<std::string> overlay_text(const ViewNumbers& n) {
  std::vector<std::string> lines = {
      text("%.1f fps, %.1f ms a frame", n.fps, n.frame_ms),
      text("%zu lights, %zu shadow maps of %d", n.lights, n.shadow_maps, n.shadow_size)};
  if (const std::string light = light_text(n); !light.empty()) lines.push_back(light);
  if (n.predicted_error > 0) lines.push_back(text("predicted error of shadows %.2g", n.predicted_error));
  if (n.expected_error > 0) lines.push_back(text("expected error at this frame rate %.2g", n.expected_error));
  lines.push_back(text("EV %.1f%s", n.ev100, n.ev_by_hand ? " by hand" : ""));
  lines.emplace_back("h: keys");
  return lines;
}

std::string lost_shadows_text(const std::string& scene, std::size_t objects, std::size_t of, float texel_m,
                              float span_m) {
  return scene +
         text(
             ": what casts spans %.3g m, and %zu of %zu objects are smaller than the finest texel of "
             "its shadow maps, %.2g m: their shadows are lost; a larger --shadow-size makes it smaller",
             static_cast<double>(span_m), objects, of, static_cast<double>(texel_m));
}

std::string plate_white_text(const std::string& plate, float white_cd_m2) {
  return plate +
         text(
             ": its white counts as %.3g cd/m², a white floor under this light; --plate-white says otherwise",
             static_cast<double>(white_cd_m2));
}

}  // namespace lightwell::render
