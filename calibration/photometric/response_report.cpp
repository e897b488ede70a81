// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/response_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "interface/printable.h"
#include "interface/response_json.h"

namespace lightwell::calibration {
namespace {

using nlohmann::ordered_json;

// JSON has no infinity: null.
ordered_json finite(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

ordered_json json_of(const PatchResidual& r, bool check) {
  ordered_json out = {{"patch", r.patch.name},
                      {"luminance_cd_m2", r.patch.luminance_cd_m2},
                      {"code", r.patch.code},
                      {"measured_cd_m2", finite(r.luminance_cd_m2)},
                      {"relative_error", finite(r.relative_error)},
                      {"stops", finite(r.stops)},
                      {"code_residual", finite(r.code_residual)},
                      {"interval_95_cd_m2", {r.interval[0], finite(r.interval[1])}}};
  if (check) {
    out["inside_95"] = r.inside;
  } else {
    out["used"] = !r.rejected;
    out["leverage"] = finite(r.leverage);
  }
  return out;
}

ordered_json json_of(const CurveScore& s) {
  ordered_json out = {{"model", name(s.curve)}, {"parameters", s.parameters}};
  if (s.segments > 0) out["segments"] = s.segments;
  if (!s.refused.empty()) {
    out["refused"] = s.refused;
  } else {
    out["aicc"] = s.aicc;
    out["chi2"] = s.chi2;
  }
  return out;
}

ordered_json covariance_of(const ResponseFit& fit) {
  ordered_json rows = ordered_json::array();
  for (Eigen::Index r = 0; r < fit.covariance.rows(); ++r) {
    ordered_json row = ordered_json::array();
    for (Eigen::Index c = 0; c < fit.covariance.cols(); ++c) row.push_back(fit.covariance(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

bool is_chosen(const ResponseFit& fit, const CurveScore& s) {
  if (s.curve != fit.curve) return false;
  const auto* pwl = std::get_if<PiecewiseLinearResponse>(&fit.response.model);
  return pwl == nullptr || pwl->points.size() == static_cast<std::size_t>(s.segments) + 1;
}

// The best of the curves that were not chosen, and how much more or less AICc it has.
ordered_json runner_up_of(const ResponseFit& fit) {
  const CurveScore *chosen = nullptr, *next = nullptr;
  for (const CurveScore& s : fit.scores) {
    if (!s.refused.empty()) continue;
    if (is_chosen(fit, s))
      chosen = &s;
    else if (next == nullptr || s.aicc < next->aicc)
      next = &s;
  }
  if (chosen == nullptr || next == nullptr) return nullptr;
  ordered_json out = {{"model", name(next->curve)}, {"aicc_difference", next->aicc - chosen->aicc}};
  if (next->segments > 0) out["segments"] = next->segments;
  return out;
}

double rms_relative_error(const std::vector<PatchResidual>& residuals) {
  double sum = 0;
  int count = 0;
  for (const PatchResidual& r : residuals)
    if (!r.rejected && std::isfinite(r.relative_error)) sum += r.relative_error * r.relative_error, ++count;
  return count > 0 ? std::sqrt(sum / count) : 0;
}

ordered_json usable_of(const ResponseFit& fit) {
  if (!fit.usable_codes) return nullptr;
  const auto [low, high] = *fit.usable_codes;
  return {{"limit", kUsableError},
          {"code", {low, high}},
          {"luminance_cd_m2", {fit.response.luminance_cd_m2(low), fit.response.luminance_cd_m2(high)}}};
}

// Σ over the patches that are light, weights equal: their relative errors are.
ChannelGain gain_of(const ResponseFit& fit, const PatchSet& patches, const std::string& channel) {
  double sum = 0, square = 0, count = 0;
  for (const Patch& p : patches.fit) {
    const double measured = fit.response.luminance_cd_m2(p.code);
    if (!(p.luminance_cd_m2 > 0 && measured > 0)) continue;
    const double ln = std::log(measured / p.luminance_cd_m2);
    sum += ln;
    square += ln * ln;
    ++count;
  }
  const double mean = count > 0 ? sum / count : 0;
  return {channel, std::exp(mean),
          count > 1 ? std::sqrt(std::max(0.0, square - count * mean * mean) / (count - 1)) : 0};
}

std::string default_channel(const std::vector<std::string>& channels) {
  if (std::find(channels.begin(), channels.end(), "G") != channels.end()) return "G";
  return channels.empty() ? "" : channels.front();
}

// Where it was measured.
std::optional<double> measured_gain(const ResponseReport& report, const char* channel) {
  if (report.channel == channel) return 1;
  for (const ChannelGain& c : report.channels)
    if (c.channel == channel) return c.gain;
  return std::nullopt;
}

std::string selection_rule(const ResponseFit& fit) {
  const std::string within =
      " whose AICc is within " + std::to_string(static_cast<int>(kStrongAicc)) + " of the least";
  if (!fit.curve_given) return "the first of linear, log, linlog, pwl" + within;
  return fit.curve == Curve::pwl ? "given, with the fewest segments" + within : "given";
}

std::string line(const char* format, auto... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

}  // namespace

Result<ResponseReport> calibrate_response(const PatchSet& patches, const std::string& channel,
                                          const ResponseFitOptions& options) {
  const std::vector<std::string> channels = channels_of(patches);
  ResponseReport report;
  report.source = patches.file;
  report.channel = channel.empty() ? default_channel(channels) : channel_named(channel).value_or(channel);
  if (!channels.empty() && std::find(channels.begin(), channels.end(), report.channel) == channels.end())
    return Error{ErrorKind::usage, "--channel = " + channel + ": no patch of " + patches.file + " has it"};
  auto fit = fit_response(of_channel(patches, report.channel), options);
  if (!fit) return fit.error();
  report.fit = *std::move(fit);
  for (const std::string& other : channels) {
    if (other == report.channel) continue;
    const auto checked =
        ordered_and_checked(at_exposure(of_channel(patches, other), report.fit.response.reference_exposure_us,
                                        options.luminance_error),
                            report.fit.response.clip_code, options.code_sigma);
    if (!checked) return checked.error();
    report.channels.push_back(gain_of(report.fit, *checked, other));
  }
  return report;
}

std::vector<std::string> assumption_lines(const ResponseReport& report) {
  std::vector<std::string> out;
  for (const Assumption& a : report.fit.assumed)
    out.push_back(line("%s = %g is assumed, %s: %s states it", a.key.c_str(), a.value, a.reason.c_str(),
                       a.option.c_str()));
  return out;
}

ordered_json report_to_json(const ResponseReport& report) {
  const ResponseFit& fit = report.fit;
  ordered_json out = {{"schema", "lightwell.response-fit/1"}, {"source", report.source}};
  if (report.recorded) out["measured_in"] = to_json(*report.recorded);
  if (!report.channel.empty()) out["channel"] = report.channel;
  out["model"] = name(fit.curve);
  out["parameters"] = response_to_json(fit.response, false).at("parameters");
  out["bits"] = fit.response.bits;
  out["clip_code"] = fit.response.clip_code;
  out["assumed"] = ordered_json::object();
  for (const Assumption& a : fit.assumed) out["assumed"][a.key] = a.value;
  out["parameter_order"] = parameter_names(fit.response.model);
  out["covariance"] = covariance_of(fit);
  out["noise_scale"] = fit.noise_scale;
  out["degrees_of_freedom"] = fit.degrees;
  out["t95"] = fit.t95;
  out["luminance_error"] = fit.luminance_error;
  out["selection"] = fit.curve_given ? "given" : "AICc";
  out["selection_rule"] = selection_rule(fit);
  out["runner_up"] = runner_up_of(fit);
  out["models"] = ordered_json::array();
  for (const CurveScore& score : fit.scores) out["models"].push_back(json_of(score));
  out["fit"] = ordered_json::array();
  out["rejected"] = ordered_json::array();
  for (const PatchResidual& r : fit.fit) {
    out["fit"].push_back(json_of(r, false));
    if (r.rejected) out["rejected"].push_back(r.patch.name);
  }
  out["check"] = ordered_json::array();
  for (const PatchResidual& r : fit.check) out["check"].push_back(json_of(r, true));
  out["rms_relative_error"] = {{"fit", rms_relative_error(fit.fit)},
                               {"check", rms_relative_error(fit.check)}};
  out["usable_range"] = usable_of(fit);
  for (const ChannelGain& c : report.channels)
    out["channels"].push_back({{"channel", c.channel}, {"gain", c.gain}, {"relative_scatter", c.scatter}});
  return out;
}

std::string response_file(const ResponseReport& report) {
  const ResponseFit& fit = report.fit;
  nlohmann::json out = response_to_json(fit.response, true);
  nlohmann::json sigma = nlohmann::json::array();
  for (const auto& code : out["table"]["code"]) {
    const double value = fit.relative_sigma(code.get<double>());
    sigma.push_back(std::isfinite(value) ? nlohmann::json(value) : nlohmann::json());
  }
  out["table"]["relative_sigma"] = std::move(sigma);
  out["fit"] = nlohmann::json::parse(
      report_to_json(report).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  out["assumed"] = std::move(out["fit"]["assumed"]);
  out["fit"].erase("assumed");
  const auto red = measured_gain(report, "R"), green = measured_gain(report, "G"),
             blue = measured_gain(report, "B");
  if (red && green && blue) {
    add_colour_matrix(out, Eigen::Vector3d(1 / *red, 1 / *green, 1 / *blue).asDiagonal().toDenseMatrix());
    // Grey comes out grey; what the filters do to colours is not known from grey patches.
    if (out.contains("rec709_from_camera")) out["rec709_from_camera_is"] = "grey balance";
  }
  return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::string summary(const ResponseReport& report) {
  const ResponseFit& fit = report.fit;
  std::string out = line("model %s, %d bits, %s:", std::string(name(fit.curve)).c_str(), fit.response.bits,
                         selection_rule(fit).c_str());
  const auto names = parameter_names(fit.response.model);
  const auto values = parameters_of(fit.response.model);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    out += line("\n  %-10s %12.6g ± %.2g", names[i].c_str(), values[i], std::sqrt(fit.covariance(at, at)));
  }
  out += "\n     patch            cd/m2      code     error     stops\n";
  const auto add = [&](const PatchResidual& r, const char* use) {
    out += line("  %-14.14s %10.5g %9.2f", printable(r.patch.name).c_str(), r.patch.luminance_cd_m2,
                r.patch.code);
    if (std::isfinite(r.stops))
      out += line("  %+7.2f %%  %+7.3f  %s\n", 100 * r.relative_error, r.stops, use);
    else
      out += line("  measured %.3g, no ratio to darkness  %s\n", r.luminance_cd_m2, use);
  };
  for (const PatchResidual& r : fit.fit)
    add(r, r.rejected                    ? "left out: it contradicts the others"
           : r.leverage > kAloneLeverage ? "the curve here rests on it alone"
                                         : "");
  for (const PatchResidual& r : fit.check)
    add(r, r.inside ? "check, inside its 95 % interval" : "check, OUTSIDE its 95 % interval");
  for (const ChannelGain& c : report.channels)
    out += line("  channel %s: gain %.4f, scatter %.2f %%\n", printable(c.channel).c_str(), c.gain,
                100 * c.scatter);
  if (fit.usable_codes)
    out += line("good to 5 %% (95 %% sure) from %.4g to %.4g cd/m2\n",
                fit.response.luminance_cd_m2((*fit.usable_codes)[0]),
                fit.response.luminance_cd_m2((*fit.usable_codes)[1]));
  else
    out += "nowhere good to 5 %: more patches, or better known ones\n";
  return out;
}

}  // namespace lightwell::calibration
