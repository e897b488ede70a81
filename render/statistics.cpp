// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/statistics.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace lightwell::render {
namespace {

// The smallest value that a share of all values does not exceed; null of none.
nlohmann::json percentile(std::vector<double> values, double share) {
  if (values.empty()) return nullptr;
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

template <class Get>
nlohmann::json percentile(const std::vector<Statistics::Frame>& frames, double share, Get get) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const auto& frame : frames) values.push_back(get(frame));
  return percentile(std::move(values), share);
}

}  // namespace

std::string Statistics::json() const {
  using F = Frame;
  const auto pass = [&](double PassTimes::*time) {
    return percentile(frames, 0.5, [=](const F& f) { return f.passes.*time; });
  };
  const auto ms = [](const F& f) { return f.ms; };
  nlohmann::ordered_json report = {
      {"frames", frames.size()},
      {"ms", {{"p50", percentile(frames, 0.5, ms)}, {"p99", percentile(frames, 0.99, ms)}}},
      {"cpu_ms", {{"p50", percentile(frames, 0.5, [](const F& f) { return f.cpu_ms; })}}},
      {"passes",
       {{"shadow", pass(&PassTimes::shadow_ms)},
        {"gbuffer", pass(&PassTimes::gbuffer_ms)},
        {"shading", pass(&PassTimes::shading_ms)},
        {"tonemap", pass(&PassTimes::tonemap_ms)}}},
      {"lights", lights},
      {"shadow_maps", shadow_maps},
      {"shadow_size", shadow_size},
      {"triangles", triangles},
      {"predicted_error",
       predicted_error > 0 ? nlohmann::ordered_json(predicted_error) : nlohmann::ordered_json()},
      {"gl_renderer", gl_renderer}};
  if (chosen)
    report["chosen"] = {{"lights", lights},
                        {"shadow_texels", chosen->shadow_texels},
                        {"expected_error", chosen->expected_error}};
  if (lamps)
    report["luminaires"] = {{"count", lamps->lamps},          {"positions", lamps->positions},
                            {"sources", lamps->sources},      {"shadow_maps", lamps->maps},
                            {"shadow_size", lamps->map_side}, {"bytes", lamps->bytes}};
  if (field)
    report["field"] = {
        {"size", field->size},
        {"degree", field->degree},
        {"main_lights", field->main_lights},
        {"texture_units", field->texture_units},
        {"bytes", field->bytes},
        {"balls", field->balls},
        {"updates", field->update_ms.size()},
        {"update_ms",
         {{"p50", percentile(field->update_ms, 0.5)}, {"p99", percentile(field->update_ms, 0.99)}}}};
  return report.dump(2) + "\n";
}

Statistics::Field field_statistics(const Renderer& renderer) {
  const FieldShading& field = *renderer.field();
  const FieldLayout& layout = field.layout();
  return {layout.grid().size,
          layout.degree(),
          field.lights_with_power(),
          field.texture_units(),
          layout.bytes(),
          renderer.field_balls(),
          {}};
}

}  // namespace lightwell::render
