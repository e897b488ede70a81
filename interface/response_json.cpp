// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/response_json.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lightwell {
namespace {

using nlohmann::json;

constexpr const char* kResponseSchema = "lightwell.response/1";

json table_of(const Response& response) {
  json code = json::array();
  json luminance = json::array();
  const int last = static_cast<int>(std::floor(response.clip_code));
  for (int c = static_cast<int>(std::ceil(response.black_code)); c <= last; ++c) {
    code.push_back(c);
    luminance.push_back(response.luminance_cd_m2(c));
  }
  return {{"code", std::move(code)}, {"luminance_cd_m2", std::move(luminance)}};
}

json parameters_of(const LogResponse& m) {
  return {{"a", m.a}, {"b", m.b}, {"c", m.c}};
}
json parameters_of(const LinearResponse& m) {
  return {{"black", m.black}, {"gain", m.gain}};
}
json parameters_of(const LinLogResponse& m) {
  return {{"black", m.black}, {"gain", m.gain}, {"knee_cd_m2", m.knee_cd_m2}};
}
json parameters_of(const PiecewiseLinearResponse& m) {
  json code = json::array();
  json luminance = json::array();
  for (const auto& point : m.points) {
    code.push_back(point.code);
    luminance.push_back(point.luminance_cd_m2);
  }
  return {{"code", std::move(code)}, {"luminance_cd_m2", std::move(luminance)}};
}

// Two lists of equal length.
std::pair<std::vector<double>, std::vector<double>> curve_from(const JsonFields& fields) {
  std::vector<double> code = fields.number_list("code");
  std::vector<double> luminance = fields.number_list("luminance_cd_m2");
  if (code.size() != luminance.size())
    fields.fail("luminance_cd_m2", "has " + std::to_string(luminance.size()) + " values, code has " +
                                       std::to_string(code.size()) + ": allowed equal numbers");
  return {std::move(code), std::move(luminance)};
}

PiecewiseLinearResponse piecewise_linear_from(const JsonFields& parameters) {
  const auto [code, luminance] = curve_from(parameters);
  PiecewiseLinearResponse model;
  for (std::size_t i = 0; i < code.size(); ++i) model.points.push_back({luminance[i], code[i]});
  return model;
}

void check_table(const JsonFields& table) {
  const auto [code, luminance] = curve_from(table);
  for (std::size_t i = 1; i < code.size(); ++i) {
    if (!(code[i] > code[i - 1])) table.fail("code[" + std::to_string(i) + "]", "does not increase");
    if (!(luminance[i] > luminance[i - 1]))
      table.fail("luminance_cd_m2[" + std::to_string(i) + "]", "does not increase");
  }
}

}  // namespace

std::string_view model_name(const Response& response) {
  constexpr std::string_view kNames[] = {"log", "linear", "linlog", "pwl"};
  static_assert(std::size(kNames) == std::variant_size_v<decltype(Response::model)>);
  return kNames[response.model.index()];
}

json response_to_json(const Response& response, bool with_table) {
  json out = {{"schema", kResponseSchema},       {"model", model_name(response)},
              {"bits", response.bits},           {"black_code", response.black_code},
              {"clip_code", response.clip_code}, {"reference_exposure_us", response.reference_exposure_us}};
  out["parameters"] = std::visit([](const auto& m) { return parameters_of(m); }, response.model);
  if (with_table) out["table"] = table_of(response);
  return out;
}

Response response_from_json(const JsonFields& fields) {
  fields.require_schema(kResponseSchema);
  Response response;
  const std::string model = fields.text("model");
  const JsonFields parameters = fields.object("parameters");
  if (model == "log") {
    response.model = LogResponse{parameters.number("a"), parameters.number("b"), parameters.number("c")};
  } else if (model == "linear") {
    response.model = LinearResponse{parameters.number("black"), parameters.number("gain")};
  } else if (model == "linlog") {
    response.model = LinLogResponse{parameters.number("black"), parameters.number("gain"),
                                    parameters.number("knee_cd_m2")};
  } else if (model == "pwl") {
    response.model = piecewise_linear_from(parameters);
  } else {
    fields.fail("model", "= \"" + model.substr(0, 40) + "\": allowed log, linear, linlog, pwl");
  }
  response.bits = fields.integer("bits", 1, 16);
  response.black_code = fields.number("black_code");
  response.clip_code = fields.number("clip_code");
  response.reference_exposure_us = fields.number("reference_exposure_us");
  if (fields.has("table")) check_table(fields.object("table"));
  return response;
}

void add_colour_matrix(json& out, const Eigen::Matrix3d& m) {
  if (m.isIdentity(0)) return;
  json rows = json::array();
  for (Eigen::Index r = 0; r < 3; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2)});
  out["rec709_from_camera"] = std::move(rows);
}

Eigen::Matrix3d colour_matrix_from(const JsonFields& fields, const json& object) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
  if (!fields.has("rec709_from_camera")) return m;
  const json& rows = object.at("rec709_from_camera");
  const auto bad = [&] { fields.fail("rec709_from_camera", "is not 3 rows of 3 finite numbers"); };
  if (!rows.is_array() || rows.size() != 3) bad();
  for (std::size_t r = 0; r < 3; ++r) {
    if (!rows[r].is_array() || rows[r].size() != 3) bad();
    for (std::size_t c = 0; c < 3; ++c) {
      if (!rows[r][c].is_number() || !(std::abs(rows[r][c].get<double>()) <= 1e3)) bad();
      m(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[r][c].get<double>();
    }
  }
  return m;
}

}  // namespace lightwell
