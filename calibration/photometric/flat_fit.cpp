// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/flat_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/photometric/lamps_and_dust.h"
#include "calibration/photometric/pixel_pattern.h"
#include "calibration/photometric/take_level.h"
#include "calibration/photometric/turning.h"
#include "calibration/photometric/vignetting_fit.h"
#include "interface/flat_field_json.h"

namespace lightwell::calibration {
namespace {

constexpr double kMostTilt = 0.2;       // of the scene, from the centre to the edge
constexpr double kMostClipped = 0.01;   // of the pixels in the field
constexpr double kMostMasked = 0.05;    // likewise, of lamps and dust
constexpr double kRounding = 1 / 12.0;  // variance of a code's rounding
constexpr double kDither = 0.5;         // codes of noise that average it out

Status check_input(const MeanFrame& mean, const Lens& lens, const Response& response,
                   const std::string& name) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, name + ": " + what}; };
  if (mean.format.width != lens.image_size[0] || mean.format.height != lens.image_size[1])
    return bad("frames of " + std::to_string(mean.format.width) + "x" + std::to_string(mean.format.height) +
               ": allowed " + std::to_string(lens.image_size[0]) + "x" + std::to_string(lens.image_size[1]) +
               ", the lens's image_size");
  const int bits = significant_bits(mean.format.pixel_format);
  if (bits != response.bits && !(bits == 16 && response.bits >= 10))
    return bad("codes of " + std::to_string(bits) + " bits: allowed " + std::to_string(response.bits) +
               ", the response's");
  if (mean.frames < 2) return bad("number of frames = 1: allowed at least 2; a hundred are good");
  return {};
}

Status check_all(const std::vector<FlatTake>& takes, const std::optional<MeanFrame>& dark, const Lens& lens,
                 const Response& response) {
  for (const FlatTake& take : takes) {
    if (const Status status = check_input(take.mean, lens, response, take.name); !status) return status;
    if (take.mean.format.pixel_format != takes[0].mean.format.pixel_format)
      return Error{ErrorKind::bad_input,
                   take.name + ": another pixel format than " + takes[0].name + ": allowed one"};
  }
  if (!dark) return {};
  const std::string name = dark->name.empty() ? "dark frames" : dark->name;
  if (const Status status = check_input(*dark, lens, response, name); !status) return status;
  return check_is_dark(*dark, lens, response, name);
}

Status check_masked(const CleanFit& clean, const std::vector<FlatTake>& takes) {
  for (std::size_t t = 0; t < takes.size(); ++t) {
    const double part = static_cast<double>(clean.masked_in[t]) / static_cast<double>(clean.samples_in[t]);
    if (part > kMostMasked)
      return Error{ErrorKind::bad_input, takes[t].name + ": lamps, dust or other uneven places in " +
                                             std::to_string(100 * part) +
                                             " % of the field: allowed 5 %; light it evenly"};
  }
  return {};
}

// The mean of the middle half: hot pixels, and dead ones, do not count.
double middle_mean(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 4;
  double sum = 0;
  for (std::size_t i = cut; i < values.size() - cut; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * cut);
}

// Dark frames whose level in the field is the response's code of darkness, a colour each, so that only the pattern is
// left: the response was not measured in darkness, and what its toe errs there would be an offset of every pixel.
struct Darkness {
  std::optional<MeanFrame> mean;
  std::array<double, 3> level_error_codes = {0, 0, 0};  // taken out
};

Result<Darkness> aligned(const std::optional<MeanFrame>& dark, const Lens& lens, const Response& response) {
  Darkness out;
  if (!dark) return out;
  const double dark_code = response.code(0);
  if (!std::isfinite(dark_code))
    return Error{
        ErrorKind::bad_input,
        "response: parameters.c = 0, so that darkness has no code: allowed above 0 with dark frames; "
        "calibrate the response with a darker patch, or leave the dark frames out"};
  out.mean = dark;
  const auto width = static_cast<std::size_t>(dark->format.width);
  const auto colour = [&](std::size_t i) {
    return static_cast<std::size_t>(
        colour_of(dark->format, static_cast<int>(i % width), static_cast<int>(i / width)));
  };
  std::array<std::vector<double>, 3> codes;
  for (std::size_t i = 0; i < dark->code.size(); ++i)
    if (lens.theta_rad(Vec2d(static_cast<double>(i % width), static_cast<double>(i / width))) <
        lens.max_theta_rad)
      codes[colour(i)].push_back(dark->code[i]);
  for (std::size_t c = 0; c < 3; ++c)
    if (!codes[c].empty()) out.level_error_codes[c] = middle_mean(std::move(codes[c])) - dark_code;
  for (std::size_t i = 0; i < dark->code.size(); ++i) out.mean->code[i] -= out.level_error_codes[colour(i)];
  return out;
}

// Adds the samples of one take.
Status add_samples(const FlatTake& take, int index, int colours, const std::optional<MeanFrame>& dark,
                   const Lens& lens, const Response& response, std::vector<EvenSample>& samples) {
  const MeanFrame& even = take.mean;
  std::size_t inside = 0, taken = 0;
  // A pixel and a half inside: what the border cuts is left out. In a mosaic a pixel stands for two by two.
  const double margin = is_bayer(even.format.pixel_format) ? 3 : 1.5;
  const double edge = lens.max_theta_rad - margin / lens.focal.minCoeff();
  const double dark_code = response.code(0);
  for (int y = 0; y < even.format.height; ++y)
    for (int x = 0; x < even.format.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(even.format.width) +
                            static_cast<std::size_t>(x);
      const double theta = lens.theta_rad(Vec2d(x, y));
      if (!(theta < edge)) continue;
      ++inside;
      double code = even.code[i];
      if (code <= 0.5 || code >= response.clip_code - 0.5) continue;
      if (dark) code -= dark->code[i] - dark_code;
      const Vec2d p = (Vec2d(x, y) - lens.center).cwiseQuotient(lens.focal) / lens.max_theta_rad;
      samples.push_back({i, x, y, index * colours + colour_of(even.format, x, y), index, theta * theta, p.x(),
                         p.y(), code});
      ++taken;
    }
  if (taken < 100 || static_cast<double>(inside - taken) > kMostClipped * static_cast<double>(inside))
    return Error{ErrorKind::bad_input,
                 take.name + ": " + std::to_string(inside - taken) + " of " + std::to_string(inside) +
                     " pixels of the field are clipped: allowed 1 %; change the exposure"};
  return {};
}

// Standard error of a pixel's mean code.
double sigma_of_mean(const MeanFrame& mean, std::size_t pixel) {
  const double noise = mean.sigma[pixel] * mean.sigma[pixel];
  return std::sqrt(noise / static_cast<double>(mean.frames) + (noise < kDither * kDither ? kRounding : 0));
}

std::vector<std::vector<PixelReading>> readings_of(const std::vector<EvenSample>& samples,
                                                   const VignettingFit& fit,
                                                   const std::vector<FlatTake>& takes,
                                                   const std::optional<MeanFrame>& dark,
                                                   const Response& response) {
  std::vector<std::vector<PixelReading>> out(takes[0].mean.code.size());
  Eigen::VectorXd row(fit.p.size());
  for (const EvenSample& s : samples) {
    const MeanFrame& mean = takes[static_cast<std::size_t>(s.take)].mean;
    if (dark && out[s.index].empty())
      out[s.index].push_back({dark->code[s.index], 0, sigma_of_mean(*dark, s.index), 0});
    fit.gradient(s, response, row);
    const double shared = std::sqrt(std::max(0.0, row.dot(fit.covariance * row)));
    out[s.index].push_back({mean.code[s.index], fit.luminance(s), sigma_of_mean(mean, s.index), shared});
  }
  return out;
}

// What the parameters' errors do to a pixel's residual, rms over the field, codes.
double shared_sigma(const std::vector<EvenSample>& samples, const VignettingFit& fit,
                    const Response& response) {
  Eigen::VectorXd row(fit.p.size());
  double sum = 0;
  for (const EvenSample& s : samples) {
    fit.gradient(s, response, row);
    sum += row.dot(fit.covariance * row);
  }
  return std::sqrt(std::max(0.0, sum) / static_cast<double>(samples.size()));
}

void set_pattern(FlatFit& out, const std::vector<EvenSample>& samples, const VignettingFit& fit,
                 const std::vector<std::size_t>& masked, const std::vector<FlatTake>& takes,
                 const std::optional<MeanFrame>& dark, const Response& response) {
  const auto readings = readings_of(samples, fit, takes, dark, response);
  PixelPattern pattern = fit_pattern(readings, response);
  out.gain_rms = pattern.gain_rms;
  out.gain_sigma = pattern.gain_sigma;
  out.flat.gain = std::move(pattern.gain);
  out.flat.offset_codes = std::move(pattern.offset_codes);
  if (dark)
    for (std::size_t i = 0; i < readings.size(); ++i)
      if (readings[i].empty() || out.flat.gain.empty())
        out.flat.offset_codes[i] = static_cast<float>(dark->code[i] - response.code(0));
  double square = 0, noise = 0, count = 0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (readings[i].empty()) continue;
    double weight = 0;  // of the mean over the takes, or of the dark frames alone
    for (const PixelReading& r : readings[i]) {
      weight += 1 / (r.sigma_code * r.sigma_code);
      if (dark) break;
    }
    square += std::pow(static_cast<double>(out.flat.offset_codes[i]), 2);
    noise += 1 / weight;
    ++count;
  }
  out.offset_rms_codes = std::sqrt(square / count);
  out.offset_sigma_codes = std::sqrt(noise / count);
  if (!dark) {
    std::vector<char> told;
    for (const auto& of_pixel : readings) told.push_back(!of_pixel.empty());
    fill_masked(masked, told, takes[0].mean.format.width, out.flat.offset_codes);
  }
  out.offset_shared_sigma_codes = dark ? 0 : shared_sigma(samples, fit, response);
}

FlatFit with_takes(const std::vector<FlatTake>& takes, const Darkness& darkness, const Lens& lens) {
  FlatFit out;
  out.flat.image_size = lens.image_size;
  out.takes = takes;
  for (FlatTake& take : out.takes) take.mean.code.clear(), take.mean.sigma.clear();
  out.from_dark = darkness.mean.has_value();
  if (out.from_dark) out.dark_temperature_c = darkness.mean->temperature_c;
  out.dark_level_error_codes = darkness.level_error_codes;
  return out;
}

}  // namespace

Result<FlatFit> fit_flat_field(const std::vector<FlatTake>& even, const std::optional<MeanFrame>& dark_frames,
                               const Lens& lens, const Response& response) {
  if (const Status status = check_all(even, dark_frames, lens, response); !status) return status.error();
  const auto darkness = aligned(dark_frames, lens, response);
  if (!darkness) return darkness.error();
  const std::optional<MeanFrame>& dark = darkness->mean;
  const int colours = is_bayer(even[0].mean.format.pixel_format) ? 3 : 1;
  for (const FlatTake& take : even)
    if (const Status status = check_is_lit(take.mean, lens, response, take.name); !status)
      return status.error();
  std::vector<EvenSample> all;
  for (std::size_t t = 0; t < even.size(); ++t)
    if (const Status status = add_samples(even[t], static_cast<int>(t), colours, dark, lens, response, all);
        !status)
      return status.error();
  const int takes = static_cast<int>(even.size());
  const CleanFit clean =
      fit_without_lamps_and_dust(all, response, even[0].mean.format, colours * takes, takes);
  const VignettingFit& fit = clean.fit;

  FlatFit out = with_takes(even, *darkness, lens);
  out.vignetting_terms = fit.terms;
  out.pixels = clean.samples.size();
  out.masked_pixels = clean.masked.size();
  for (std::size_t t = 0; t < even.size(); ++t) out.takes[t].masked_pixels = clean.masked_in[t];
  for (std::size_t t = 0; t < even.size(); ++t)
    for (int c = 0; c < colours; ++c)
      out.takes[t].level_cd_m2[static_cast<std::size_t>(c)] = fit.p[static_cast<int>(t) * colours + c];
  for (int k = 0; k < fit.terms; ++k)
    out.flat.vignetting[static_cast<std::size_t>(k)] = fit.p[fit.levels + k];
  out.covariance.topLeftCorner(fit.terms, fit.terms) =
      fit.covariance.block(fit.levels, fit.levels, fit.terms, fit.terms);
  out.tilt = fit.tilt();
  if (const double tilt = std::max(clean.tilt_before, out.tilt); !(tilt < kMostTilt))
    return Error{ErrorKind::bad_input, even[0].name + ": the scene changes by " + std::to_string(100 * tilt) +
                                           " % from the centre to the edge: allowed 20 %; light it evenly"};
  if (const Status status = check_masked(clean, even); !status) return status.error();
  set_pattern(out, clean.samples, fit, clean.masked, even, dark, response);
  if (const Status status = check(out.flat, lens); !status)
    return Error{status.error().kind, even[0].name + ": " + status.error().message};
  return out;
}

Result<FlatFit> fit_turned_flat_field(const std::vector<FlatTake>& takes,
                                      const std::vector<double>& turned_deg,
                                      const std::optional<MeanFrame>& dark_frames, const Lens& lens,
                                      const Response& response) {
  if (const Status status = check_all(takes, dark_frames, lens, response); !status) return status.error();
  const auto darkness = aligned(dark_frames, lens, response);
  if (!darkness) return darkness.error();
  const std::optional<MeanFrame>& dark = darkness->mean;
  std::vector<TurnedTake> turned;
  for (std::size_t i = 0; i < takes.size(); ++i) turned.push_back({takes[i].mean, turned_deg[i]});
  const auto fit = fit_turning(turned, dark ? &*dark : nullptr, lens, response);
  if (!fit) return Error{fit.error().kind, takes[0].name + ": " + fit.error().message};
  FlatFit out = with_takes(takes, *darkness, lens);
  out.turned_deg = turned_deg;
  out.vignetting_terms = fit->terms;
  out.flat.vignetting = fit->vignetting;
  out.covariance = fit->covariance;
  out.scene_scatter = fit->scene_scatter;
  out.pixels = fit->cells;
  out.gain_sigma = std::numeric_limits<double>::infinity();
  if (dark) {
    double square = 0, noise = 0;
    for (std::size_t i = 0; i < dark->code.size(); ++i) {
      const double offset = dark->code[i] - response.code(0);
      out.flat.offset_codes.push_back(static_cast<float>(offset));
      square += offset * offset;
      noise += std::pow(sigma_of_mean(*dark, i), 2);
    }
    out.offset_rms_codes = std::sqrt(square / static_cast<double>(dark->code.size()));
    out.offset_sigma_codes = std::sqrt(noise / static_cast<double>(dark->code.size()));
  }
  if (const Status status = check(out.flat, lens); !status)
    return Error{status.error().kind, takes[0].name + ": " + status.error().message};
  return out;
}

nlohmann::ordered_json report_to_json(const FlatFit& fit) {
  using nlohmann::ordered_json;
  const auto or_null = [](const std::optional<double>& v) { return v ? ordered_json(*v) : ordered_json(); };
  std::uint64_t frames = 0;
  for (const FlatTake& take : fit.takes) frames += take.mean.frames;
  const char* offsets = fit.from_dark ? "dark frames" : fit.turned_deg.empty() ? "even frames" : "nothing";
  ordered_json out = {{"schema", "lightwell.flat-fit/1"},
                      {"vignetting", fit.flat.vignetting},
                      {"vignetting_from", fit.turned_deg.empty() ? "even scenes" : "turning"},
                      {"vignetting_terms", fit.vignetting_terms},
                      {"pixels", fit.pixels},
                      {"masked_pixels", fit.masked_pixels},
                      {"frames", frames},
                      {"exposure_us", fit.takes[0].mean.exposure_us},
                      {"level_cd_m2", fit.takes[0].level_cd_m2},
                      {"offset_from", offsets},
                      {"offset_rms_codes", fit.offset_rms_codes},
                      {"offset_sigma_codes", fit.offset_sigma_codes},
                      {"offset_shared_sigma_codes", fit.offset_shared_sigma_codes},
                      {"gain_supported", !fit.flat.gain.empty()},
                      {"gain_rms", fit.gain_rms}};
  out["gain_sigma"] = std::isfinite(fit.gain_sigma) ? ordered_json(fit.gain_sigma) : ordered_json();
  out["scene_tilt"] = fit.tilt;
  out["scene_scatter"] = fit.scene_scatter;
  out["dark_level_error_codes"] = fit.from_dark ? ordered_json(fit.dark_level_error_codes) : ordered_json();
  out["temperature_c"] = or_null(fit.takes[0].mean.temperature_c);
  out["dark_temperature_c"] = or_null(fit.dark_temperature_c);
  for (Eigen::Index r = 0; r < 3; ++r)
    out["covariance"].push_back({fit.covariance(r, 0), fit.covariance(r, 1), fit.covariance(r, 2)});
  for (std::size_t t = 0; t < fit.takes.size(); ++t) {
    const FlatTake& take = fit.takes[t];
    ordered_json json = {{"recording", take.name},
                         {"frames", take.mean.frames},
                         {"exposure_us", take.mean.exposure_us},
                         {"temperature_c", or_null(take.mean.temperature_c)}};
    if (fit.turned_deg.empty()) {
      json["level_cd_m2"] = take.level_cd_m2;
      json["masked_pixels"] = take.masked_pixels;
    } else {
      json["turned_deg"] = fit.turned_deg[t];
    }
    out["takes"].push_back(std::move(json));
  }
  return out;
}

std::string flat_file(const FlatFit& fit) {
  nlohmann::json out = flat_field_to_json(fit.flat);
  out["fit"] = report_to_json(fit);
  return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace lightwell::calibration
