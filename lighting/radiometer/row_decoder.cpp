// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/radiometer/row_decoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lightwell::radiometer {
namespace {

Storage storage_of(PixelFormat format) {
  const int bits = storage_bits(format);
  return bits == 8 ? Storage::u8 : bits == 12 ? Storage::p12 : Storage::u16;
}

std::size_t bytes_of(Storage storage, std::size_t pixels) {
  return storage == Storage::u8 ? pixels : storage == Storage::u16 ? 2 * pixels : (3 * pixels + 1) / 2;
}

// Radiance of every code at offset 0, without the toe.
std::vector<float> response_table(const Response& response) {
  std::vector<float> table;
  for (int code = 0; code <= static_cast<int>(std::ceil(response.clip_code)); ++code) {
    double radiance = response.luminance_cd_m2(code);
    if (const auto* log = std::get_if<LogResponse>(&response.model)) radiance += log->c;
    table.push_back(static_cast<float>(radiance));
  }
  return table;
}

}  // namespace

std::uint32_t code_at(const std::byte* frame, Storage storage, std::size_t pixel) {
  if (storage == Storage::u8) return static_cast<std::uint32_t>(frame[pixel]);
  if (storage == Storage::u16) {
    std::uint16_t code;
    std::memcpy(&code, frame + 2 * pixel, sizeof code);
    return code;
  }
  const std::byte* triple = frame + pixel / 2 * 3;
  const auto low = static_cast<std::uint32_t>(triple[pixel % 2]);
  const auto high = static_cast<std::uint32_t>(triple[pixel % 2 + 1]);
  return pixel % 2 ? low >> 4 | high << 4 : low | (high & 15) << 8;
}

RowDecoder::RowDecoder(const Calibration& calibration, const FrameFormat& format, const CellPlan& plan,
                       const SampleWeights& weights, const Kernels& kernels)
    : format_(format),
      storage_(storage_of(format.pixel_format)),
      kernels_(&kernels),
      first_column_(static_cast<std::size_t>(plan.first_column)),
      stride_(plan.stride),
      frame_bytes_(format.bytes()),
      clip_(static_cast<std::uint32_t>(std::ceil(calibration.response.clip_code))) {
  const Response& response = calibration.response;
  if (const auto* log = std::get_if<LogResponse>(&response.model)) toe_ = log->c;
  for (auto& row : row_) row.assign(2 * (2 * stride_ + 16), std::byte{0});
  log_ = fold_log_response(response, weights);
  if (log_) return;
  weight_ = weights.weight_sr;
  if (!std::holds_alternative<LogResponse>(response.model) &&
      !std::holds_alternative<LinearResponse>(response.model)) {
    offset_ = weights.offset_codes;
    const auto [least, most] = std::minmax_element(offset_.begin(), offset_.end());
    if (least != offset_.end())
      fine_ = FineTable(response, -static_cast<double>(*most), clip_ - static_cast<double>(*least));
    return;
  }
  table_ = response_table(response);
  dark_.assign(weight_.size(), 0);
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    const auto offset = static_cast<double>(weights.offset_codes[i]);
    if (const auto* log = std::get_if<LogResponse>(&response.model))
      weight_[i] *= static_cast<float>(std::exp(-offset / log->b));
    else
      dark_[i] = static_cast<float>(offset * response.dluminance_dcode(0));
  }
}

float RowDecoder::look_up(std::uint32_t code, std::size_t at) const noexcept {
  const std::uint32_t inside = std::min(code, clip_);
  if (fine_) return fine_->radiance(static_cast<float>(inside) - offset_[at]) * weight_[at];
  return (table_[inside] - dark_[at]) * weight_[at];
}

// count pixels from `first` on, as bytes that may be read in whole.
const std::byte* RowDecoder::pixels(const std::byte* frame, std::size_t first, std::size_t count) noexcept {
  const std::size_t at = bytes_of(storage_, first);
  const std::size_t wanted = bytes_of(storage_, count);
  if (at + wanted <= frame_bytes_) return frame + at;
  const std::size_t there = at < frame_bytes_ ? frame_bytes_ - at : 0;
  std::memcpy(row_[0].data(), frame + at, there);
  std::memset(row_[0].data() + there, 0, wanted - there);
  return row_[0].data();
}

bool RowDecoder::decode_mono(const std::byte* frame, int y, const CellPlan::RowSpan& span,
                             float* out) noexcept {
  const auto width = static_cast<std::size_t>(format_.width);
  const std::size_t first = static_cast<std::size_t>(y) * width + first_column_ + span.begin;
  const std::size_t table = static_cast<std::size_t>(y) * stride_ + span.begin;
  const std::size_t all = width * static_cast<std::size_t>(format_.height);
  const std::size_t there = std::min(span.count, all - first);
  if (log_ && !(storage_ == Storage::p12 && first % 2 != 0))
    return kernels_->decode[static_cast<std::size_t>(storage_)](
        pixels(frame, first, span.count), log_->attenuation.data() + table, out, span.count, log_->curve);
  if (log_) {  // packed, and the row starts in the middle of a byte
    std::memset(row_[0].data(), 0, 2 * span.count);
    for (std::size_t i = 0; i < there; ++i) {
      const auto code = static_cast<std::uint16_t>(code_at(frame, storage_, first + i));
      std::memcpy(row_[0].data() + 2 * i, &code, sizeof code);
    }
    return kernels_->decode[static_cast<std::size_t>(Storage::u16)](
        row_[0].data(), log_->attenuation.data() + table, out, span.count, log_->curve);
  }
  bool clipped = false;
  for (std::size_t i = 0; i < there; ++i) {
    const std::uint32_t code = code_at(frame, storage_, first + i);
    clipped |= code >= clip_;
    out[i] = look_up(code, table + i);
  }
  return clipped;
}

// count pixels of a row of the mosaic from `column` on, the odd border filled with its own colours.
const std::byte* RowDecoder::mosaic_row(const std::byte* frame, int row, std::size_t column,
                                        std::size_t count, AlignedVector<std::byte>& copy) const noexcept {
  const auto width = static_cast<std::size_t>(format_.width);
  const auto y = static_cast<std::size_t>(source_pixel(row, format_.height));
  const std::size_t at = bytes_of(storage_, y * width + column);
  const std::size_t wanted = bytes_of(storage_, count);
  const bool odd_border = width % 2 != 0 && column + count > width;
  if (!odd_border && at + wanted <= frame_bytes_) return frame + at;
  const std::size_t there = std::min(count, width - column);
  std::memset(copy.data(), 0, wanted);
  std::memcpy(copy.data(), frame + at, bytes_of(storage_, there));
  if (odd_border)
    std::memcpy(copy.data() + bytes_of(storage_, there), frame + bytes_of(storage_, y * width + width - 2),
                bytes_of(storage_, 1));
  return copy.data();
}

bool RowDecoder::decode_mosaic(const std::byte* frame, int y, const CellPlan::RowSpan& span,
                               float* const out[3]) noexcept {
  const std::size_t column = 2 * (first_column_ + span.begin);
  const std::byte* top = mosaic_row(frame, 2 * y, column, 2 * span.count, row_[0]);
  const std::byte* bottom = mosaic_row(frame, 2 * y + 1, column, 2 * span.count, row_[1]);
  const std::size_t table = 4 * static_cast<std::size_t>(y) * stride_ + 2 * span.begin;
  if (log_)
    return kernels_->decode_bayer[static_cast<std::size_t>(storage_)](
        top, bottom, log_->attenuation.data() + table, log_->attenuation.data() + table + 2 * stride_, out,
        span.count, log_->curve);
  bool clipped = false;
  for (std::size_t i = 0; i < span.count; ++i) {
    const std::uint32_t code[4] = {code_at(top, storage_, 2 * i), code_at(top, storage_, 2 * i + 1),
                                   code_at(bottom, storage_, 2 * i), code_at(bottom, storage_, 2 * i + 1)};
    for (const std::uint32_t c : code) clipped |= c >= clip_;
    out[0][i] = look_up(code[0], table + 2 * i);
    out[1][i] = look_up(code[1], table + 2 * i + 1) + look_up(code[2], table + 2 * stride_ + 2 * i);
    out[2][i] = look_up(code[3], table + 2 * stride_ + 2 * i + 1);
  }
  return clipped;
}

bool RowDecoder::decode(const std::byte* frame, int y, const CellPlan::RowSpan& span,
                        float* const out[3]) noexcept {
  return is_bayer(format_.pixel_format) ? decode_mosaic(frame, y, span, out)
                                        : decode_mono(frame, y, span, out[0]);
}

}  // namespace lightwell::radiometer
