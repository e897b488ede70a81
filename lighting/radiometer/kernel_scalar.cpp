// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The reference that the other kernels must equal: the same integers, one pixel at a time.
#include <cstring>

#include "lighting/radiometer/kernel.h"

namespace lightwell::radiometer {
namespace {

template <Storage kStorage>
std::uint32_t code_at(const std::byte* codes, std::size_t i) {
  if constexpr (kStorage == Storage::u8) return static_cast<std::uint32_t>(codes[i]);
  if constexpr (kStorage == Storage::u16) {
    std::uint16_t code;
    std::memcpy(&code, codes + 2 * i, sizeof code);
    return code;
  }
  const std::byte* triple = codes + i / 2 * 3;
  const auto low = static_cast<std::uint32_t>(triple[i % 2]);
  const auto high = static_cast<std::uint32_t>(triple[i % 2 + 1]);
  return i % 2 ? low >> 4 | high << 4 : low | (high & 15) << 8;
}

float weighted_radiance(std::uint32_t code, std::uint32_t attenuation, const LogCurve& curve) {
  const std::uint32_t clamped = code < curve.clip ? code : curve.clip;
  const std::uint32_t up =
      ((clamped << curve.shift) * curve.slope >> 16) + curve.base;  // at most 65535 by plan
  const std::uint32_t t = up > attenuation ? up - attenuation : 0;
  const std::uint32_t x = t << kMantissaShift & 0xffff;
  std::uint32_t mantissa = (x * kExp2[3] >> 16) + kExp2[2];
  mantissa = (x * mantissa >> 16) + kExp2[1];
  mantissa = (x * mantissa >> 16) + kExp2[0];
  mantissa = x * mantissa >> 16;
  const std::uint32_t bits = (t / kOctave + kExponentBias) << 23 | mantissa << 7;
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

template <Storage kStorage>
bool decode(const std::byte* codes, const std::uint16_t* attenuation, float* out, std::size_t count,
            const LogCurve& curve) {
  bool clipped = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t code = code_at<kStorage>(codes, i);
    clipped |= code >= curve.clip;
    out[i] = weighted_radiance(code, attenuation[i], curve);
  }
  return clipped;
}

template <Storage kStorage>
bool decode_bayer(const std::byte* top, const std::byte* bottom, const std::uint16_t* top_attenuation,
                  const std::uint16_t* bottom_attenuation, float* const out[3], std::size_t count,
                  const LogCurve& curve) {
  bool clipped = false;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t x = 2 * i;
    const std::uint32_t code[4] = {code_at<kStorage>(top, x), code_at<kStorage>(top, x + 1),
                                   code_at<kStorage>(bottom, x), code_at<kStorage>(bottom, x + 1)};
    for (const std::uint32_t c : code) clipped |= c >= curve.clip;
    out[0][i] = weighted_radiance(code[0], top_attenuation[x], curve);
    out[1][i] = weighted_radiance(code[1], top_attenuation[x + 1], curve) +
                weighted_radiance(code[2], bottom_attenuation[x], curve);
    out[2][i] = weighted_radiance(code[3], bottom_attenuation[x + 1], curve);
  }
  return clipped;
}

void reduce_pixels(const CellBatch& batch, const float* window, const CellOutput& out) {
  const std::uint16_t* start = batch.start;
  for (std::size_t first = 0; first < batch.cells; first += 8) {
    const std::uint32_t n = batch.classes[first / 8].segments;
    for (std::size_t i = first; i < first + 8 && i < batch.cells; ++i) {
      float sum = 0;
      float top = 0;
      for (std::uint32_t k = 0; k < n; ++k) {
        const float value = window[start[8 * k + (i - first)]];
        sum += value;
        top = value > top ? value : top;
      }
      float radiance = sum * batch.scale[i] - batch.toe[i];
      radiance = (radiance > out.least ? radiance : out.least) * out.exposure;
      const float peak = (top * batch.peak_scale[i] - batch.toe[i]) * out.exposure;
      out.radiance[batch.slot[i]] = radiance;
      out.peak[batch.slot[i]] = peak > radiance ? peak : radiance;
    }
    start += 8 * static_cast<std::size_t>(n);
  }
}

}  // namespace

extern const Kernels kScalarKernels;
const Kernels kScalarKernels = {Isa::scalar,
                                1,
                                {decode<Storage::u8>, decode<Storage::u16>, decode<Storage::p12>},
                                {decode_bayer<Storage::u8>, decode_bayer<Storage::u16>},
                                nullptr,  // one lane: pixels alone
                                reduce_pixels};

}  // namespace lightwell::radiometer
