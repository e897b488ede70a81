// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/recorded_patches.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "interface/csv_table.h"
#include "lighting/median.h"

namespace lightwell::calibration {
namespace {

constexpr std::size_t kFewestPixels = 16;
constexpr double kMostClipped = 1e-3;  // of a patch's codes; noise of 3 sigma below clipping
constexpr double kFarSigmas = 5;       // a pixel that far from the median is not of the patch
constexpr double kDither =
    0.5;  // codes of noise that make rounding vanish on average (Vanderkooy and Lipshitz 1984)
constexpr const char* kColours[] = {"R", "G", "B"};

Error bad(const std::string& what) {
  return {ErrorKind::bad_input, what};
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

struct KnownPatch {
  std::string name;
  double luminance_cd_m2 = 0;
  bool check = false;
  PatchRegion region;
};

Result<std::vector<KnownPatch>> read_luminances(const std::filesystem::path& file) {
  const auto table = CsvTable::read(file);
  if (!table) return table.error();
  if (const Status status = table->require({"luminance_cd_m2", "patch"}); !status) return status.error();
  std::vector<KnownPatch> out;
  std::set<std::string> names;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto luminance = table->luminance(row, "luminance_cd_m2");
    if (!luminance) return luminance.error();
    KnownPatch patch{table->text(row, "patch"), *luminance, false, {}};
    if (!names.insert(patch.name).second)
      return bad(table->place(row) + ": patch = " + patch.name.substr(0, 40) +
                 " stands there twice: allowed once");
    const std::string use = table->text(row, "use");
    if (!use.empty() && use != "fit" && use != "check")
      return bad(table->place(row) + ": use = " + use.substr(0, 40) + ": allowed fit, check");
    patch.check = use == "check";
    out.push_back(std::move(patch));
  }
  return out;
}

bool inside(const PatchRegion& region, const Vec2d& p) {
  bool left = false, right = false;
  for (std::size_t c = 0; c < 4; ++c) {
    const Vec2d side = region.corners[(c + 1) % 4] - region.corners[c], to = p - region.corners[c];
    const double turn = side.x() * to.y() - side.y() * to.x();
    left |= turn < 0;
    right |= turn > 0;
  }
  return !(left && right);
}

// The pixels of one patch and one colour.
struct Spot {
  std::size_t patch = 0;
  int colour = 0;
  std::vector<std::size_t> pixels;
  std::size_t lines = 0;  // columns or rows, whichever are fewer
};

Result<std::vector<Spot>> spots_of(const KnownPatch& patch, std::size_t index, const FrameFormat& format) {
  Vec2d low = patch.region.corners[0], high = low;
  for (const Vec2d& c : patch.region.corners) low = low.cwiseMin(c), high = high.cwiseMax(c);
  if (!(low.x() >= -0.5 && low.y() >= -0.5 && high.x() <= format.width - 0.5 &&
        high.y() <= format.height - 0.5))
    return bad("patch " + patch.name + " reaches from (" + shown(low.x()) + ", " + shown(low.y()) + ") to (" +
               shown(high.x()) + ", " + shown(high.y()) + "): allowed inside the picture of " +
               std::to_string(format.width) + "x" + std::to_string(format.height));
  const int colours = is_bayer(format.pixel_format) ? 3 : 1;
  std::vector<Spot> spots;
  for (int colour = 0; colour < colours; ++colour) {
    Spot spot{index, colour, {}, 0};
    std::set<int> columns, rows;
    for (int y = static_cast<int>(std::ceil(low.y())); y <= high.y(); ++y)
      for (int x = static_cast<int>(std::ceil(low.x())); x <= high.x(); ++x) {
        if (colour_of(format, x, y) != colour || !inside(patch.region, Vec2d(x, y))) continue;
        spot.pixels.push_back(static_cast<std::size_t>(y) * static_cast<std::size_t>(format.width) +
                              static_cast<std::size_t>(x));
        columns.insert(x);
        rows.insert(y);
      }
    spot.lines = std::min(columns.size(), rows.size());
    if (spot.pixels.size() < kFewestPixels)
      return bad("patch " + patch.name + " has " + std::to_string(spot.pixels.size()) +
                 (colours > 1 ? " pixels of a colour" : " pixels") + ": allowed at least " +
                 std::to_string(kFewestPixels));
    spots.push_back(std::move(spot));
  }
  return spots;
}

// Without the pixels that do not look like the others.
Spot without_outliers(Spot spot, const MeanFrame& mean) {
  std::vector<double> codes, distances;
  for (const std::size_t i : spot.pixels) codes.push_back(mean.code[i]);
  const double middle = median(codes);
  for (const double code : codes) distances.push_back(std::abs(code - middle));
  const double reach = std::max(kFarSigmas * 1.4826 * median(std::move(distances)), 1.0);  // a code at least
  std::erase_if(spot.pixels, [&](std::size_t i) { return std::abs(mean.code[i] - middle) > reach; });
  return spot;
}

// What the frames of one exposure say of a spot.
struct Measurement {
  Spot spot;
  std::size_t exposure = 0;
  double sum = 0, square = 0;  // of the frames' means, less the mean's mean: no digits are lost
  double mean = 0;
  std::uint64_t frames = 0, clipped = 0;
};

// Sensors may clip below the largest code: pixels there stand still while all others are noisy.
double seen_clip_code(const MeanFrame& mean) {
  const double most = *std::max_element(mean.code.begin(), mean.code.end());
  std::size_t still = 0;
  for (std::size_t i = 0; i < mean.code.size(); ++i) still += mean.code[i] == most && mean.sigma[i] == 0;
  const bool noisy = median(mean.sigma) > 0.3;  // a code of rounding is less
  constexpr std::size_t kFewestStill = 20, kFewestFrames = 4;
  return mean.frames >= kFewestFrames && noisy && still >= kFewestStill ? most : 0;
}

// What the take tells of its codes.
void set_scale(PatchSet& set, const std::vector<MeanFrame>& means) {
  const int bits = significant_bits(means.front().format.pixel_format);
  if (bits < 16) set.bits = bits;  // 16 bits may carry 10, 12 or 14
  for (const MeanFrame& mean : means) {
    set.largest_code = std::max(set.largest_code, *std::max_element(mean.code.begin(), mean.code.end()));
    set.still_at_code = std::max(set.still_at_code, seen_clip_code(mean));
  }
}

Patch patch_of(const Measurement& m, const KnownPatch& known, const MeanFrame& mean, bool bayer) {
  const auto pixels = static_cast<double>(m.spot.pixels.size()), frames = static_cast<double>(m.frames);
  double square = 0, noise = 0;
  for (const std::size_t i : m.spot.pixels) {
    square += std::pow(mean.code[i] - m.mean, 2);
    noise += mean.sigma[i] * mean.sigma[i] / pixels;
  }
  const double spread = std::sqrt(square / (pixels - 1) / static_cast<double>(m.spot.lines));
  const double flicker =
      m.frames > 1 ? std::sqrt(std::max(0.0, m.square - m.sum * m.sum / frames) / (frames - 1) / frames) : 0;
  const double rounding = std::sqrt(noise) < kDither ? 1 / std::sqrt(12.0) : 0;
  Patch patch;
  patch.name = "patch " + known.name;
  patch.luminance_cd_m2 = known.luminance_cd_m2;
  patch.code = m.mean;
  patch.code_sigma = std::hypot(spread, flicker, rounding);
  patch.channel = bayer ? kColours[m.spot.colour] : "";
  patch.exposure_us = mean.exposure_us;
  return patch;
}

Result<std::vector<PatchRegion>> regions_of(const RecordedPatchesOptions& options,
                                            const std::vector<MeanFrame>& means) {
  if (!options.chart) return read_positions(options.positions);
  Result<std::vector<PatchRegion>> best = bad("");
  for (const MeanFrame& mean : means) {  // some exposure shows black and white
    best = find_chart(mean, *options.chart, options.lens);
    if (best) return best;
  }
  return bad(options.recording.string() + ": " + best.error().message);
}

Status place(std::vector<KnownPatch>& patches, const std::vector<PatchRegion>& regions,
             const std::string& file, const RecordedPatchesOptions& options) {
  for (KnownPatch& patch : patches) {
    const auto found = std::find_if(regions.begin(), regions.end(),
                                    [&](const PatchRegion& r) { return r.patch == patch.name; });
    if (found == regions.end())
      return bad(file + ": patch = " + (patch.name.empty() ? "nothing" : patch.name.substr(0, 40)) +
                 ": allowed " +
                 (options.chart ? "1 to " + std::to_string(options.chart->patches()) + ", the chart's"
                                : "one of " + options.positions.string()));
    patch.region = *found;
  }
  return {};
}

// Means over each frame, for what all of a patch's pixels do together, and clipped codes.
Status read_spots(TakeFrames& take, const std::vector<MeanFrame>& means, double clip_code,
                  std::vector<Measurement>& all) {
  return take.for_each([&](const RecordedFrame& frame, std::span<const std::byte> codes) {
    for (Measurement& m : all) {
      const double exposure = means[m.exposure].exposure_us;
      if (std::abs(frame.exposure_us - exposure) > kOneExposure * exposure) continue;
      double sum = 0;
      for (const std::size_t i : m.spot.pixels) {
        const double code = take.code(codes, i);
        sum += code;
        m.clipped += code <= 0 || code >= clip_code;
      }
      const double off = sum / static_cast<double>(m.spot.pixels.size()) - m.mean;
      m.sum += off;
      m.square += off * off;
      ++m.frames;
    }
    return Status();
  });
}

Result<std::vector<Measurement>> measurements_of(const std::vector<KnownPatch>& patches,
                                                 const std::vector<MeanFrame>& means,
                                                 const std::string& recording) {
  std::vector<Measurement> all;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const auto spots = spots_of(patches[i], i, means.front().format);
    if (!spots) return bad(recording + ": " + spots.error().message);
    for (std::size_t e = 0; e < means.size(); ++e)
      for (const Spot& spot : *spots) {
        Measurement m;
        m.spot = without_outliers(spot, means[e]);
        m.exposure = e;
        for (const std::size_t pixel : m.spot.pixels)
          m.mean += means[e].code[pixel] / static_cast<double>(m.spot.pixels.size());
        all.push_back(std::move(m));
      }
  }
  return all;
}

}  // namespace

Result<RecordedPatches> measure_patches(const std::filesystem::path& luminances,
                                        const RecordedPatchesOptions& options,
                                        const ResponseFitOptions& fit) {
  auto patches = read_luminances(luminances);
  if (!patches) return patches.error();
  auto take = TakeFrames::open(options.recording);
  if (!take) return take.error();
  const auto means = mean_frames(*take);
  if (!means) return means.error();
  auto regions = regions_of(options, *means);
  if (!regions) return regions.error();
  if (const Status status = place(*patches, *regions, luminances.string(), options); !status)
    return status.error();
  const std::string recording = options.recording.string();
  auto all = measurements_of(*patches, *means, recording);
  if (!all) return all.error();
  RecordedPatches out;
  set_scale(out.set, *means);
  if (fit.bits > 0 && out.set.bits > 0 && fit.bits != out.set.bits)
    return bad(recording + ": codes of " + std::to_string(out.set.bits) +
               " bits: allowed --bits = " + std::to_string(fit.bits));
  const double clip_code = clip_code_of(out.set, fit);
  if (const Status status = read_spots(*take, *means, clip_code, *all); !status) return status.error();

  out.recording = recording;
  out.regions = *std::move(regions);
  for (const MeanFrame& mean : *means) {
    out.frames += mean.frames;
    out.exposures_us.push_back(mean.exposure_us);
  }
  out.set.file = luminances.string();
  const bool bayer = is_bayer(take->format().pixel_format);
  std::set<std::pair<std::size_t, int>> seen;
  for (const Measurement& m : *all) {
    const KnownPatch& known = (*patches)[m.spot.patch];
    const MeanFrame& mean = (*means)[m.exposure];
    const double codes = static_cast<double>(m.spot.pixels.size()) * static_cast<double>(m.frames);
    if (static_cast<double>(m.clipped) > kMostClipped * codes) {
      out.left_out.push_back("patch " + known.name +
                             (bayer ? std::string(" ") + kColours[m.spot.colour] : "") + " at " +
                             shown(mean.exposure_us) + " us: clipped");
      continue;
    }
    seen.insert({m.spot.patch, m.spot.colour});
    (known.check ? out.set.check : out.set.fit).push_back(patch_of(m, known, mean, bayer));
  }
  for (const Measurement& m : *all)
    if (!seen.contains({m.spot.patch, m.spot.colour}))
      return bad(recording + ": patch " + (*patches)[m.spot.patch].name + ": code = " + shown(m.mean) +
                 " is clipped: allowed above 0 and below " + shown(clip_code) +
                 (means->size() > 1 ? " in some exposure" : "") + "; leave the patch out");
  return out;
}

nlohmann::ordered_json to_json(const RecordedPatches& patches) {
  nlohmann::ordered_json out = {{"recording", patches.recording},
                                {"frames", patches.frames},
                                {"exposures_us", patches.exposures_us},
                                {"left_out", patches.left_out}};
  out["regions"] = nlohmann::ordered_json::array();
  for (const PatchRegion& r : patches.regions) {
    nlohmann::ordered_json corners = nlohmann::ordered_json::array();
    for (const Vec2d& c : r.corners) corners.push_back({c.x(), c.y()});
    out["regions"].push_back({{"patch", r.patch}, {"corners", std::move(corners)}});
  }
  return out;
}

}  // namespace lightwell::calibration
