// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "lighting/field_error.h"
#include "lighting/radiometer/aligned.h"
#include "lighting/radiometer/cells.h"
#include "lighting/radiometer/kernel.h"
#include "lighting/radiometer/pixel_bins.h"
#include "lighting/radiometer/row_decoder.h"
#include "lighting/radiometer/sample_weights.h"

namespace lightwell {
namespace {

using namespace radiometer;

Status check_format(const Calibration& calibration, const FrameFormat& format) {
  const auto& size = calibration.lens.image_size;
  const std::string of_lens = ", the lens's image_size";
  if (format.width != size[0])
    return field_error("frame width", format.width, std::to_string(size[0]) + of_lens);
  if (format.height != size[1])
    return field_error("frame height", format.height, std::to_string(size[1]) + of_lens);
  const bool bayer = is_bayer(format.pixel_format);
  if (bayer && std::min(format.width, format.height) < 2)
    return field_error("frame size of a Bayer mosaic", std::min(format.width, format.height),
                       "at least 2 x 2");
  const int bits = significant_bits(format.pixel_format);
  const int codes = calibration.response.bits;
  const std::string format_name(name(format.pixel_format));
  if (bits == 16 && (codes < 10 || codes > 16))
    return field_error("response.bits", codes, "10 to 16, in the low bits of " + format_name);
  if (bits != 16 && codes != bits)
    return field_error("response.bits", codes, std::to_string(bits) + ", those of " + format_name);
  if (bayer && !(calibration.rec709_from_camera.cwiseAbs().maxCoeff() < 1e3))
    return field_error("rec709_from_camera: largest coefficient",
                       calibration.rec709_from_camera.cwiseAbs().maxCoeff(), "below 1000");
  return {};
}

Status check_grid(const PolarGrid& grid) {
  if (grid.rings < 1 || grid.rings > 4096) return field_error("map rings", grid.rings, "1 to 4096");
  if (grid.sectors < 1 || grid.sectors > 16384) return field_error("map sectors", grid.sectors, "1 to 16384");
  if (!(grid.theta_max_rad > 0 && grid.theta_max_rad <= kPi))
    return field_error("map theta_max_rad", grid.theta_max_rad, "above 0, at most pi");
  return {};
}

Result<const Kernels*> choose_kernels(std::optional<Isa> wanted) {
  const Isa isa = wanted.value_or(available_isas().front());
  if (const Kernels* found = kernels(isa)) return found;
  std::string allowed;
  for (const Isa there : available_isas())
    allowed += (allowed.empty() ? "" : ", ") + std::string(name(there));
  return Error{ErrorKind::usage,
               "instruction set " + std::string(name(isa)) + ": this machine has " + allowed};
}

// What a cell's sums are multiplied with, in the order of the cells.
struct CellFactors {
  std::vector<float> scale, peak_scale, toe;
};

}  // namespace

struct Radiometer::Plan {
  FrameFormat format;
  double reference_exposure_us;
  PolarMap blank;  // what make_map gives
  const Kernels* kernels;
  std::vector<std::uint32_t> bin_of_sample;
  int samples_wide;
  CellPlan cells;
  RowDecoder decoder;
  Eigen::Matrix3f rec709_from_camera;

  std::size_t channels;
  std::array<std::vector<float>, 3> toe;  // [bins], radiance
  // [bins]: energy to mean radiance, and that of one sample to its radiance
  std::vector<double> mean_per_unit, peak_per_unit;
  std::array<CellFactors, 3> whole, parts;
  std::array<AlignedVector<float>, 3> window;
  AlignedVector<float> sums, peaks;                       // the kernels' scratch
  std::array<std::vector<float>, 3> part_sum, part_peak;  // [parts]
  std::array<std::vector<float>, 3> camera, camera_peak;  // [bins], colour before the matrix

  Plan(const Calibration& calibration, const FrameFormat& frame_format, const PolarGrid& grid, PixelBins bins,
       const Kernels& chosen, CellPlan plan, const SampleWeights& weights);
  void make_factors(const PixelBins& bins, const SampleWeights& weights);
  void order_factors(const CellPlan::Cells& in, bool part, std::size_t channel, CellFactors& out) const;
  void decode_rows(const std::byte* frame, int begin, int end, PolarMap& map) noexcept;
  void count_clipped(const std::byte* frame, int y, PolarMap& map) const noexcept;
  void reduce(std::size_t batch, const CellPlan::Cells& order, const CellFactors& factors,
              std::size_t channel, const CellOutput& out) noexcept;
  void join_parts(std::size_t channel, const CellOutput& out) noexcept;
  void to_rec709(PolarMap& map) const noexcept;
};

Radiometer::Plan::Plan(const Calibration& calibration, const FrameFormat& frame_format, const PolarGrid& grid,
                       PixelBins bins, const Kernels& chosen, CellPlan plan, const SampleWeights& weights)
    : format(frame_format),
      reference_exposure_us(calibration.response.reference_exposure_us),
      blank(PolarMap::make(grid, is_bayer(frame_format.pixel_format) ? 3 : 1)),
      kernels(&chosen),
      samples_wide(bins.width),
      cells(std::move(plan)),
      decoder(calibration, frame_format, cells, weights, chosen),
      rec709_from_camera(calibration.rec709_from_camera.cast<float>()),
      channels(static_cast<std::size_t>(blank.channels)) {
  std::transform(bins.bin_sr.begin(), bins.bin_sr.end(), blank.solid_angle_sr.begin(),
                 [](double sr) { return static_cast<float>(sr); });
  blank.coverage = static_cast<float>(bins.total_sr / (4 * kPi));
  make_factors(bins, weights);
  bin_of_sample = std::move(bins.group);
  for (std::uint32_t& entry : bin_of_sample)
    if (entry != kNone) entry = bins.bin_of_group[entry];
  const std::size_t bin_count = grid.size();
  for (std::size_t c = 0; c < channels; ++c) {
    order_factors(cells.whole, false, c, whole[c]);
    order_factors(cells.parts, true, c, parts[c]);
    // A segment's load may reach past the window, and short cells are filled from there.
    window[c].assign(static_cast<std::size_t>(cells.window_rows) * cells.stride + kWindowZeros, 0);
    part_sum[c].assign(cells.part_bin.size(), 0);
    part_peak[c].assign(cells.part_bin.size(), 0);
    if (channels == 3) {
      camera[c].assign(bin_count, 0);
      camera_peak[c].assign(bin_count, 0);
    }
  }
  sums.assign(8 * cells.largest_batch + 8, 0);
  peaks.assign(8 * cells.largest_batch + 8, 0);
}

void Radiometer::Plan::make_factors(const PixelBins& bins, const SampleWeights& weights) {
  const std::size_t bin_count = bins.bin_sr.size();
  peak_per_unit.assign(bin_count, 0);
  for (std::size_t s = 0; s < bins.group.size(); ++s)
    if (bins.group[s] != kNone) {
      double& largest = peak_per_unit[bins.bin_of_group[bins.group[s]]];
      largest = std::max(largest, static_cast<double>(bins.solid_angle_sr[s]));
    }
  mean_per_unit = bins.bin_sr;
  for (std::size_t b = 0; b < bin_count; ++b) {
    std::size_t like = b;  // an empty bin is as its nearest sample, with the toe of that sample's bin
    if (const std::uint32_t sample = bins.nearest[b]; sample != kNone) {
      like = bins.bin_of_group[bins.group[sample]];
      mean_per_unit[b] = peak_per_unit[b] = static_cast<double>(bins.solid_angle_sr[sample]);
    }
    for (std::size_t c = 0; c < channels; ++c)
      toe[c].push_back(
          static_cast<float>(decoder.toe_cd_m2() * weights.bin_weight_sr[c][like] / bins.bin_sr[like]));
    mean_per_unit[b] = 1 / mean_per_unit[b];
    peak_per_unit[b] = 1 / peak_per_unit[b];
  }
}

void Radiometer::Plan::order_factors(const CellPlan::Cells& in, bool part, std::size_t channel,
                                     CellFactors& out) const {
  for (std::size_t i = 0; i < in.slot.size(); ++i) {
    const bool padding = in.slot[i] == kNone;
    const std::size_t bin = padding ? 0 : part ? cells.part_bin[in.slot[i]] : in.slot[i];
    const double unit = padding ? 0 : decoder.unit(in.group[i]);
    out.scale.push_back(static_cast<float>(unit * mean_per_unit[bin]));
    out.peak_scale.push_back(static_cast<float>(unit * peak_per_unit[bin]));
    out.toe.push_back(part ? 0 : toe[channel][bin]);  // parts: once, where they are joined
  }
}

void Radiometer::Plan::count_clipped(const std::byte* frame, int y, PolarMap& map) const noexcept {
  const bool quads = channels == 3;
  const int step = quads ? 2 : 1;
  const auto width = static_cast<std::size_t>(format.width);
  const CellPlan::RowSpan& span = cells.rows[static_cast<std::size_t>(y)];
  const std::size_t begin = static_cast<std::size_t>(cells.first_column) + span.begin;
  const std::size_t end = std::min(begin + span.count, static_cast<std::size_t>(samples_wide));
  const std::uint32_t* bins = bin_of_sample.data() + static_cast<std::ptrdiff_t>(y) * samples_wide;
  for (int row = step * y; row < std::min(step * (y + 1), format.height); ++row) {
    const std::size_t line = static_cast<std::size_t>(row) * width;
    for (std::size_t x = begin; x < end; ++x) {
      if (bins[x] == kNone) continue;
      const std::size_t first = static_cast<std::size_t>(step) * x;
      const std::size_t last = std::min(first + static_cast<std::size_t>(step), width);
      for (std::size_t pixel = first; pixel < last; ++pixel) {
        if (code_at(frame, decoder.storage(), line + pixel) < decoder.clip_code()) continue;
        std::uint16_t& count = map.clipped[bins[x]];
        if (count < std::numeric_limits<std::uint16_t>::max()) ++count;
        ++map.clipped_pixels;
      }
    }
  }
}

void Radiometer::Plan::decode_rows(const std::byte* frame, int begin, int end, PolarMap& map) noexcept {
  for (int y = begin; y < end; ++y) {
    const CellPlan::RowSpan& span = cells.rows[static_cast<std::size_t>(y)];
    if (span.count == 0) continue;
    float* out[3] = {};
    for (std::size_t c = 0; c < channels; ++c) out[c] = window[c].data() + cells.window_row(y) + span.begin;
    if (decoder.decode(frame, y, span, out)) count_clipped(frame, y, map);
  }
}

void Radiometer::Plan::reduce(std::size_t batch, const CellPlan::Cells& order, const CellFactors& factors,
                              std::size_t channel, const CellOutput& out) noexcept {
  const auto& range = order.batches[batch];
  if (range.cells == 0) return;
  CellBatch cell_batch;
  cell_batch.classes = order.classes.data() + range.first_class;
  cell_batch.class_count = range.classes;
  cell_batch.start = order.start.data() + range.first_segment;
  cell_batch.mask = order.mask.data() + range.first_segment;
  cell_batch.slot = order.slot.data() + range.first_cell;
  cell_batch.scale = factors.scale.data() + range.first_cell;
  cell_batch.peak_scale = factors.peak_scale.data() + range.first_cell;
  cell_batch.toe = factors.toe.data() + range.first_cell;
  cell_batch.cells = range.cells;
  if (cells.lanes == 1)
    kernels->reduce_pixels(cell_batch, window[channel].data(), out);
  else
    kernels->reduce(cell_batch, window[channel].data(), {sums.data(), peaks.data()}, out);
}

void Radiometer::Plan::join_parts(std::size_t channel, const CellOutput& out) noexcept {
  const auto& bins = cells.part_bin;
  for (std::size_t i = 0; i < bins.size();) {
    const std::uint32_t bin = bins[i];
    double sum = 0;
    float peak = 0;
    for (; i < bins.size() && bins[i] == bin; ++i) {
      sum += static_cast<double>(part_sum[channel][i]);
      peak = std::max(peak, part_peak[channel][i]);
    }
    const float dark = toe[channel][bin];
    out.radiance[bin] = std::max(0.0f, static_cast<float>(sum) - dark) * out.exposure;
    out.peak[bin] = std::max(out.radiance[bin], (peak - dark) * out.exposure);
  }
}

void Radiometer::Plan::to_rec709(PolarMap& map) const noexcept {
  const std::size_t n = map.grid.size();
  for (std::size_t b = 0; b < n; ++b) {
    const Eigen::Vector3f mean =
        rec709_from_camera * Eigen::Vector3f(camera[0][b], camera[1][b], camera[2][b]);
    const Eigen::Vector3f peak =
        rec709_from_camera * Eigen::Vector3f(camera_peak[0][b], camera_peak[1][b], camera_peak[2][b]);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto axis = static_cast<Eigen::Index>(c);
      map.radiance[c * n + b] = std::max(0.0f, mean[axis]);
      map.peak[c * n + b] = std::max(map.radiance[c * n + b], peak[axis]);
    }
  }
}

Result<Radiometer> Radiometer::create(const Calibration& calibration, const FrameFormat& format,
                                      const RadiometerOptions& options) {
  for (const Status& status :
       {check(calibration.lens), check(calibration.response), check(calibration.flat, calibration.lens),
        check_grid(options.grid), check_format(calibration, format)})
    if (!status) return status.error();
  const auto chosen = choose_kernels(options.isa);
  if (!chosen) return chosen.error();
  const Kernels& kernel_set = **chosen;
  const bool bayer = is_bayer(format.pixel_format);
  auto bins = bin_pixels(calibration.lens, options.grid, bayer);
  if (!bins) return bins.error();
  CellPlan cells = plan_cells(*bins, kernel_set.lanes);
  const SampleWeights weights = weigh_samples(calibration, *bins, cells, bayer);
  return Radiometer(std::make_unique<Plan>(calibration, format, options.grid, std::move(bins).value(),
                                           kernel_set, std::move(cells), weights));
}

Radiometer::Radiometer(std::unique_ptr<Plan> plan) : plan_(std::move(plan)) {}
Radiometer::Radiometer(Radiometer&&) noexcept = default;
Radiometer& Radiometer::operator=(Radiometer&&) noexcept = default;
Radiometer::~Radiometer() = default;

PolarMap Radiometer::make_map() const {
  return plan_->blank;
}

Isa Radiometer::isa() const {
  return plan_->kernels->isa;
}

void Radiometer::develop(std::span<const std::byte> frame, double exposure_us, PolarMap& map) noexcept {
  Plan& p = *plan_;
  verify_bug(frame.size() == p.format.bytes(), "develop: frame of another size than the format's");
  verify_bug(exposure_us > 0 && std::isfinite(exposure_us), "develop: exposure not above 0");
  verify_bug(map.grid == p.blank.grid && map.radiance.size() == p.blank.radiance.size() &&
                 map.peak.size() == map.radiance.size() && map.clipped.size() == map.grid.size(),
             "develop: map of another shape than make_map's");
  std::fill(map.clipped.begin(), map.clipped.end(), std::uint16_t{0});
  map.clipped_pixels = 0;
  const bool colour = p.channels == 3;
  const auto exposure = static_cast<float>(p.reference_exposure_us / exposure_us);
  CellOutput out[3];
  CellOutput part_out[3];
  for (std::size_t c = 0; c < p.channels; ++c) {
    out[c] = {colour ? p.camera[c].data() : map.radiance.data(),
              colour ? p.camera_peak[c].data() : map.peak.data(), exposure, 0};
    // A part may be below 0, as long as its bin is not.
    part_out[c] = {p.part_sum[c].data(), p.part_peak[c].data(), 1, -std::numeric_limits<float>::max()};
  }
  int row = 0;
  for (std::size_t batch = 0; batch < p.cells.batch_end.size(); ++batch) {
    p.decode_rows(frame.data(), row, p.cells.batch_end[batch], map);
    row = p.cells.batch_end[batch];
    for (std::size_t c = 0; c < p.channels; ++c) {
      p.reduce(batch, p.cells.whole, p.whole[c], c, out[c]);
      p.reduce(batch, p.cells.parts, p.parts[c], c, part_out[c]);
    }
  }
  for (std::size_t c = 0; c < p.channels; ++c) p.join_parts(c, out[c]);
  if (colour) p.to_rec709(map);
}

}  // namespace lightwell
