// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/brackets.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <opencv2/photo.hpp>

#include "calibration/photometric/bracket_merge.h"
#include "interface/response_json.h"
#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr int kGrey = 118;  // sRGB of 18 % grey
constexpr std::size_t kGreen = 1;

using Curve3 = std::array<std::vector<double>, 3>;  // exposure of every code, 256

// What the pixels of one code in one photograph have in another, in the middle: [photograph][code][other]; −1 where fewer
// than kFewest pixels have that code. Medians of many pixels know no noise, and no edges or passers-by.
using Comparison = std::vector<std::vector<std::vector<int>>>;

Comparison compare(const std::vector<const Photograph*>& photos, std::size_t channel) {
  constexpr std::uint32_t kFewest = 30;
  const std::size_t n = photos.size();
  Comparison out(n, std::vector<std::vector<int>>(256, std::vector<int>(n, -1)));
  std::vector<std::uint32_t> histogram;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b) {
      histogram.assign(256 * 256, 0);
      const auto &from = photos[a]->picture.rgb, &to = photos[b]->picture.rgb;
      for (std::size_t pixel = 0, i = channel; i < from.size(); ++pixel, i += 3)
        if (photos[a]->uneven[pixel] == 0 && photos[b]->uneven[pixel] == 0)
          ++histogram[256 * std::size_t{from[i]} + to[i]];
      for (std::size_t z = 0; z < 256; ++z) {
        const auto row = histogram.begin() + static_cast<std::ptrdiff_t>(256 * z);
        const std::uint32_t count = std::accumulate(row, row + 256, 0U);
        if (count < kFewest) continue;
        std::uint32_t sum = 0;
        int median = 0;
        while ((sum += row[median]) * 2 < count) ++median;
        out[a][z][b] = median;
      }
    }
  return out;
}

// The nearest curve that does not fall (pool adjacent violators), then with a least rise from code to code.
void make_increasing(std::vector<double>& ln) {
  struct Block {
    double sum = 0;
    int count = 0;
  };
  std::vector<Block> blocks;
  for (const double v : ln) {
    blocks.push_back({v, 1});
    while (blocks.size() > 1) {
      Block &last = blocks.back(), &before = blocks[blocks.size() - 2];
      if (last.sum / last.count > before.sum / before.count) break;
      before = {before.sum + last.sum, before.count + last.count};
      blocks.pop_back();
    }
  }
  constexpr double kLeastRise = 1e-4;  // relative
  std::size_t i = 0;
  for (const Block& block : blocks)
    for (int k = 0; k < block.count; ++k, ++i) {
      ln[i] = block.sum / block.count;
      if (i > 0) ln[i] = std::max(ln[i], ln[i - 1] + kLeastRise);
    }
}

// Straight lines across what is not finite, the nearest value at the ends. False where nothing is finite.
bool fill_gaps(std::vector<double>& values) {
  std::optional<std::size_t> before;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) continue;
    for (std::size_t k = before ? *before + 1 : 0; k < i; ++k)
      values[k] = before ? std::lerp(values[*before], values[i],
                                     static_cast<double>(k - *before) / static_cast<double>(i - *before))
                         : values[i];
    before = i;
  }
  if (!before) return false;
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(*before), values.end(), values[*before]);
  return true;
}

// The exposure of every code of one channel, from the photographs `kept` of those compared.
std::vector<double> solve_channel(const std::vector<const Photograph*>& photos, const Comparison& comparison,
                                  const std::vector<std::size_t>& kept, BracketSolver solver) {
  constexpr std::size_t kSpots = 256, kFirst = 12, kLast = 243;
  // Debevec's system grows with the spots; Robertson's curve has gaps at the codes that no spot has.
  const std::size_t levels = solver == BracketSolver::robertson
                                 ? kLast - kFirst + 1
                                 : std::max<std::size_t>(kSpots / kept.size(), 2);
  std::vector<std::vector<int>> spots;  // a code for each kept photograph
  for (const std::size_t a : kept)
    for (std::size_t k = 0; k < levels; ++k) {
      const std::vector<int>& row = comparison[a][kFirst + (kLast - kFirst) * k / (levels - 1)];
      if (row[a] < 0) continue;
      spots.emplace_back();
      for (const std::size_t b : kept) spots.back().push_back(row[b]);
    }
  if (spots.size() < 32) return {};
  // The solver takes its samples from pictures: one row of spots. OpenCV 4.6's Robertson writes beyond its arrays for
  // any other than three channels, so it gets three that are equal.
  const int channels = solver == BracketSolver::robertson ? 3 : 1;
  std::vector<cv::Mat> pictures;
  std::vector<float> times;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    cv::Mat picture(1, static_cast<int>(spots.size()), CV_8UC(channels));
    for (std::size_t i = 0; i < spots.size(); ++i)
      std::fill_n(picture.ptr() + i * static_cast<std::size_t>(channels), channels,
                  static_cast<unsigned char>(spots[i][k]));
    pictures.push_back(picture);
    times.push_back(static_cast<float>(photos[kept[k]]->exposure_s));
  }
  cv::Mat curve;
  if (solver == BracketSolver::debevec)
    cv::createCalibrateDebevec(static_cast<int>(spots.size()), 20.0F, false)->process(pictures, curve, times);
  else
    cv::createCalibrateRobertson(1000, 1e-4F)->process(pictures, curve, times);
  std::vector<double> ln, out;
  for (int z = 0; z < 256; ++z) ln.push_back(std::log(static_cast<double>(*curve.ptr<float>(z))));
  if (!fill_gaps(ln)) return {};
  make_increasing(ln);
  for (const double v : ln) out.push_back(std::exp(v - ln[kGrey]));
  return out;
}

Result<Curve3> solve(const std::vector<const Photograph*>& photos,
                     const std::array<Comparison, 3>& comparisons, const std::vector<std::size_t>& kept,
                     BracketSolver solver) {
  Curve3 out;
  for (std::size_t c = 0; c < 3; ++c) {
    out[c] = solve_channel(photos, comparisons[c], kept, solver);
    // Every camera's curve rises by a stop or more from mid grey to white.
    const double rise = out[c].empty() ? 0 : out[c][kClippedCode];
    if (!(rise > 2) || !std::isfinite(out[c][255]))
      return Error{ErrorKind::bad_input,
                   photos[0]->file +
                       " and the others: the codes do not follow the exposure times (white is " +
                       std::to_string(rise) +
                       " times mid grey): allowed photographs of one scene, in manual mode, two stops apart"};
  }
  return out;
}

// Scaled so that L = level · x(code) at the reference exposure.
Response as_response(const std::vector<double>& exposures, double level_cd_m2, double reference_s) {
  PiecewiseLinearResponse model;
  for (int z = kDarkCode; z <= kClippedCode; ++z)
    model.points.push_back({level_cd_m2 * exposures[static_cast<std::size_t>(z)], static_cast<double>(z)});
  Response response;
  response.model = std::move(model);
  response.bits = 8;
  response.black_code = kDarkCode;
  response.clip_code = kClippedCode;
  response.reference_exposure_us = 1e6 * reference_s;
  return response;
}

std::optional<double> median_if_any(std::vector<float> values) {
  if (values.empty()) return std::nullopt;
  return median(std::move(values));
}

double reference_of(const std::vector<const Photograph*>& photos) {
  return photos[photos.size() / 2]->exposure_s;
}

// One curve over the exposure times is one aperture and one ISO. of: of a photograph, where it is known.
Status check_same(const std::vector<Photograph>& photos, const char* name,
                  std::optional<double> Photograph::*of) {
  constexpr double kSame = 0.01;  // fractions, as EXIF has them, may be rounded
  const Photograph* first = nullptr;
  for (const Photograph& p : photos) {
    if (!(p.*of)) continue;
    if (first == nullptr) first = &p;
    if (std::abs(*(p.*of) - *(first->*of)) <= kSame * *(first->*of)) continue;
    char text[100];
    std::snprintf(text, sizeof text, ": %s = %g: allowed %g, that of ", name, *(p.*of), *(first->*of));
    return Error{ErrorKind::bad_input, p.file + text + first->file};
  }
  return {};
}

Status check_set(const std::vector<Photograph>& photos) {
  const auto bad = [](const std::string& what) { return Error{ErrorKind::bad_input, what}; };
  if (const Status status = check_number_of_photographs(photos.size()); !status) return status;
  for (const Photograph& p : photos) {
    if (p.full_width != photos[0].full_width || p.full_height != photos[0].full_height)
      return bad(p.file + ": its size differs from that of " + photos[0].file + ": allowed one size");
    if (!(p.exposure_s > 0 && p.exposure_s < 1e5))
      return bad(p.file + ": exposure = " + std::to_string(p.exposure_s) + " s: allowed above 0, below 1e5");
  }
  if (const Status status = check_same(photos, "f-number", &Photograph::f_number); !status) return status;
  if (const Status status = check_same(photos, "ISO", &Photograph::iso); !status) return status;
  for (std::size_t i = 1; i < photos.size(); ++i)
    if (photos[i].exposure_s < 1.01 * photos[i - 1].exposure_s)
      return bad(photos[i].file + ": exposure " + std::to_string(photos[i].exposure_s) + " s is that of " +
                 photos[i - 1].file + " too: allowed different ones");
  return {};
}

// Three times every third exposure, the first and the last excepted, is kept out and foretold from the others.
Status foretell(const std::vector<const Photograph*>& all, const std::array<Comparison, 3>& comparisons,
                BracketSolver solver, BracketFit& fit) {
  std::vector<float> errors;
  std::array<std::vector<float>, 3> of_channel;
  for (std::size_t fold = 0; fold < 3; ++fold) {
    std::vector<std::size_t> kept, held;
    std::vector<const Photograph*> kept_photos;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (i % 3 == fold && i != 0 && i + 1 != all.size()) {
        held.push_back(i);
      } else {
        kept.push_back(i);
        kept_photos.push_back(all[i]);
      }
    if (held.empty()) continue;
    const auto curve = solve(all, comparisons, kept, solver);
    if (!curve) return curve.error();
    const std::vector<double> luminance = luminance_table(as_response((*curve)[kGreen], 1, 1));
    for (const std::size_t h : held) {
      const Photograph& p = *all[h];
      std::vector<float> own;
      for (std::size_t i = 0; i < p.picture.rgb.size(); ++i) {
        const int code = p.picture.rgb[i];
        if (code <= kDarkCode || code >= kClippedCode || p.uneven[i / 3] != 0) continue;
        MergedChannel others;
        for (const Photograph* other : kept_photos)
          if (other->uneven[i / 3] == 0) others.add(other->picture.rgb[i], luminance, other->exposure_s);
        const double foretold = others.luminance_cd_m2(1);
        if (!(foretold > 0)) continue;
        const double seen = luminance[static_cast<std::size_t>(code)] / p.exposure_s;
        own.push_back(static_cast<float>(std::abs(foretold / seen - 1)));
        of_channel[i % 3].push_back(own.back());
      }
      errors.insert(errors.end(), own.begin(), own.end());
      const std::size_t count = own.size();
      fit.predictions.push_back({p.file, p.exposure_s, median_if_any(std::move(own)), count});
    }
  }
  fit.median_error = median_if_any(std::move(errors));
  for (std::size_t c = 0; c < 3; ++c) fit.channel_median_error[c] = median_if_any(std::move(of_channel[c]));
  return {};
}

}  // namespace

Status check_number_of_photographs(std::size_t count) {
  if (count >= 3 && count <= kMostPhotographs) return {};
  return Error{ErrorKind::bad_input, "number of photographs = " + std::to_string(count) + ": allowed 3 to " +
                                         std::to_string(kMostPhotographs)};
}

Result<BracketFit> fit_brackets(std::vector<Photograph> photographs, BracketSolver solver) {
  std::sort(photographs.begin(), photographs.end(),
            [](const Photograph& a, const Photograph& b) { return a.exposure_s < b.exposure_s; });
  if (const Status status = check_set(photographs); !status) return status.error();
  std::vector<const Photograph*> all;
  std::vector<std::size_t> every;
  for (std::size_t i = 0; i < photographs.size(); ++i) {
    all.push_back(&photographs[i]);
    every.push_back(i);
  }
  const std::array<Comparison, 3> comparisons = {compare(all, 0), compare(all, 1), compare(all, 2)};
  BracketFit fit;
  if (photographs.size() >= 4)
    if (const Status status = foretell(all, comparisons, solver, fit); !status) return status.error();
  const auto curve = solve(all, comparisons, every, solver);
  if (!curve) return curve.error();
  const double reference_s = reference_of(all);
  const Photograph& middle = *all[all.size() / 2];
  fit.absolute = middle.f_number && middle.iso;
  // A reflected-light meter exposes luminance L for mid grey at K = L t S / N² = 12.5 (ISO 2720).
  const double level =
      fit.absolute ? 12.5 * *middle.f_number * *middle.f_number / (reference_s * *middle.iso) : 1;
  fit.response = as_response((*curve)[kGreen], level, reference_s);
  if (const Status status = check(fit.response); !status) return status.error();
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float> spread;
    for (std::size_t z = 32; z < 224; ++z)
      spread.push_back(static_cast<float>(std::abs((*curve)[c][z] / (*curve)[kGreen][z] - 1)));
    fit.channel_spread[c] = median(std::move(spread));
  }
  return fit;
}

Status scale_luminance(BracketFit& fit, double scale) {
  for (auto& point : std::get<PiecewiseLinearResponse>(fit.response.model).points)
    point.luminance_cd_m2 *= scale;
  fit.scale *= scale;
  return check(fit.response);
}

std::string channel_warning(const BracketFit& fit) {
  constexpr double kMostSpread = 0.1;
  const double spread = std::max(fit.channel_spread[0], fit.channel_spread[2]);
  if (spread <= kMostSpread) return {};
  char text[200];
  std::snprintf(
      text, sizeof text,
      "the curves of red and blue differ from green's by %.0f %% and %.0f %%, and green's is written: "
      "colours change with brightness",
      100 * fit.channel_spread[0], 100 * fit.channel_spread[2]);
  return text;
}

nlohmann::ordered_json report_to_json(const BracketFit& fit) {
  const auto or_null = [](const std::optional<double>& error) {
    return error ? nlohmann::ordered_json(*error) : nlohmann::ordered_json();
  };
  const auto& of = fit.channel_median_error;
  nlohmann::ordered_json out = {{"schema", "lightwell.bracket-fit/1"},
                                {"median_error", or_null(fit.median_error)},
                                {"channel_median_error", {or_null(of[0]), or_null(of[1]), or_null(of[2])}},
                                {"error_of", "all channels by green's curve, even squares of 4 x 4 pixels"},
                                {"absolute", fit.absolute},
                                {"scale", fit.scale},
                                {"channel_spread", fit.channel_spread},
                                {"predictions", nlohmann::ordered_json::array()}};
  for (const Prediction& p : fit.predictions)
    out["predictions"].push_back({{"file", p.file},
                                  {"exposure_s", p.exposure_s},
                                  {"median_error", or_null(p.median_error)},
                                  {"pixels", p.pixels}});
  return out;
}

std::string bracket_response_file(const BracketFit& fit) {
  nlohmann::json out = response_to_json(fit.response, true);
  out["brackets"] = nlohmann::json::parse(
      report_to_json(fit).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace lightwell::calibration
