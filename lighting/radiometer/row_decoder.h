// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lighting/calibration.h"
#include "lighting/frame_format.h"
#include "lighting/radiometer/aligned.h"
#include "lighting/radiometer/cells.h"
#include "lighting/radiometer/fine_table.h"
#include "lighting/radiometer/kernel.h"
#include "lighting/radiometer/log_tables.h"
#include "lighting/radiometer/sample_weights.h"

namespace lightwell::radiometer {

// Code of a pixel, counted from the start of the frame.
std::uint32_t code_at(const std::byte* frame, Storage storage, std::size_t pixel);

// Turns a row of samples of a raw frame into weighted radiance. Never reads past the frame. Allocates nothing
// after construction.
class RowDecoder {
 public:
  RowDecoder(const Calibration& calibration, const FrameFormat& format, const CellPlan& plan,
             const SampleWeights& weights, const Kernels& kernels);

  // out: one row for each channel, where the row's span begins. True where a code of the span, or of the
  // pixels beside it that share a block, is clipped.
  bool decode(const std::byte* frame, int y, const CellPlan::RowSpan& span, float* const out[3]) noexcept;

  // Decoded value × unit: cd/m² · sr at the reference exposure.
  [[nodiscard]] double unit(std::uint32_t group) const { return log_ ? log_->unit[group] : 1; }
  [[nodiscard]] double toe_cd_m2() const { return toe_; }  // to subtract from every pixel's radiance
  [[nodiscard]] std::uint32_t clip_code() const { return clip_; }
  [[nodiscard]] Storage storage() const { return storage_; }

 private:
  const std::byte* pixels(const std::byte* frame, std::size_t first, std::size_t count) noexcept;
  const std::byte* mosaic_row(const std::byte* frame, int row, std::size_t column, std::size_t count,
                              AlignedVector<std::byte>& copy) const noexcept;
  bool decode_mono(const std::byte* frame, int y, const CellPlan::RowSpan& span, float* out) noexcept;
  bool decode_mosaic(const std::byte* frame, int y, const CellPlan::RowSpan& span,
                     float* const out[3]) noexcept;
  // By table, for responses that the integers do not hold.
  [[nodiscard]] float look_up(std::uint32_t code, std::size_t at) const noexcept;

  FrameFormat format_;
  Storage storage_;
  const Kernels* kernels_;
  std::size_t first_column_, stride_, frame_bytes_;
  std::uint32_t clip_;
  double toe_ = 0;
  std::optional<LogTables> log_;
  // Logarithmic and linear: (table[code] − dark) · weight
  std::vector<float> table_, dark_, weight_;
  // The other models: radiance at (code − offset) · weight
  std::optional<FineTable> fine_;
  std::vector<float> offset_;
  AlignedVector<std::byte> row_[2];  // copies of rows whose blocks would reach past the frame or the mosaic
};

}  // namespace lightwell::radiometer
