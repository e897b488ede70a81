// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/sensor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

#include "daemon/simulator/value_noise.h"

namespace lightwell::simulator {
namespace {

constexpr std::size_t kNoiseValues = 1 << 17;

// log2 of a positive normal float, error below 1e-6: exponent, plus 2/ln 2 · atanh((m − 1)/(m + 1)) by its
// series, with m in [√½, √2) where |s| < 0.172 and the first omitted term, 2.89 s⁹/9, is below 5e-8.
inline float fast_log2(float x) {
  const auto bits = std::bit_cast<std::int32_t>(x);
  const std::int32_t shifted = bits - 0x3f3504f3;  // √½
  const std::int32_t exponent = shifted >> 23;
  const auto m = std::bit_cast<float>(bits - exponent * (1 << 23));
  const float s = (m - 1) / (m + 1);
  const float s2 = s * s;
  return static_cast<float>(exponent) +
         s * (2.88539008f + s2 * (0.961796694f + s2 * (0.577078016f + s2 * 0.412198583f)));
}

// signal = plane · transmission · gain; code = model(signal) + offset + noise, rounded and clipped.
struct Row {
  const float* plane;
  const float* transmission;
  const float* offset;
  const float* noise;
  std::uint16_t* code;
  std::size_t count;
  float gain, offset_scale, noise_scale, top;
};

inline std::uint16_t rounded(float code, float top) {
  return static_cast<std::uint16_t>(
      static_cast<std::int32_t>(std::min(std::max(code + 0.5f, 0.0f), top + 0.5f)));
}

void encode_log(const Row& r, const LogResponse& m) {
  // Below the smallest normal float the logarithm's bits mean nothing.
  const auto a = static_cast<float>(m.a), b = static_cast<float>(m.b * std::log(2.0));
  const float c = std::max(static_cast<float>(m.c), 1e-30f);
  for (std::size_t i = 0; i < r.count; ++i) {
    const float light = r.plane[i] * (r.transmission[i] * r.gain) + c;
    const float code = a + b * fast_log2(light) + r.offset_scale * r.offset[i] + r.noise_scale * r.noise[i];
    r.code[i] = rounded(code, r.top);
  }
}

void encode_linear(const Row& r, const LinearResponse& m) {
  const auto black = static_cast<float>(m.black), slope = static_cast<float>(m.gain);
  for (std::size_t i = 0; i < r.count; ++i) {
    const float light = r.plane[i] * (r.transmission[i] * r.gain);
    const float code = black + slope * light + r.offset_scale * r.offset[i] + r.noise_scale * r.noise[i];
    r.code[i] = rounded(code, r.top);
  }
}

// The other models one pixel after the other, in double: exact rather than fast.
template <class Model>
void encode_any(const Row& r, const Model& m) {
  for (std::size_t i = 0; i < r.count; ++i) {
    const double light = static_cast<double>(r.plane[i] * (r.transmission[i] * r.gain));
    const float code =
        static_cast<float>(m.code(light)) + r.offset_scale * r.offset[i] + r.noise_scale * r.noise[i];
    r.code[i] = rounded(code, r.top);
  }
}

std::vector<float> standard_normal_values(std::uint64_t seed) {
  std::mt19937_64 random(seed ^ 0x6e6f697365);
  std::vector<double> values(kNoiseValues);
  constexpr double kTiny = 1e-300;
  for (std::size_t i = 0; i < values.size(); i += 2) {  // Box and Muller 1958
    const double u = static_cast<double>(random() >> 11) * 0x1p-53 + kTiny;
    const double v = static_cast<double>(random() >> 11) * 0x1p-53;
    values[i] = std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v);
    values[i + 1] = std::sqrt(-2 * std::log(u)) * std::sin(2 * kPi * v);
  }
  double mean = 0, square = 0;
  for (const double v : values) mean += v / static_cast<double>(kNoiseValues);
  for (const double v : values) square += (v - mean) * (v - mean) / static_cast<double>(kNoiseValues);
  std::vector<float> out;
  out.reserve(values.size());
  for (const double v : values) out.push_back(static_cast<float>((v - mean) / std::sqrt(square)));
  return out;
}

}  // namespace

Sensor::Sensor(const ProbeModel& model)
    : model_(model), response_(model.calibration.response), noise_(standard_normal_values(model.seed)) {
  const auto width = static_cast<std::size_t>(model.format.width),
             height = static_cast<std::size_t>(model.format.height);
  const Lens& lens = model.calibration.lens;
  const FlatField& flat = model.calibration.flat;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const double theta = std::min(lens.theta_rad({x, y}), lens.max_theta_rad);
      transmission_.push_back(static_cast<float>(flat.transmission(theta)));
    }
  for (std::size_t i = 0; i < flat.gain.size(); ++i) transmission_[i] *= flat.gain[i];
  offset_ = flat.offset_codes.empty() ? std::vector<float>(width * height, 0.0f) : flat.offset_codes;
  codes_.resize(width * height);
  noise_.insert(noise_.end(), noise_.begin(),
                noise_.begin() + static_cast<std::ptrdiff_t>(std::min(width, kNoiseValues)));
}

void Sensor::encode_row(std::size_t begin, std::size_t count, double exposure_us, std::uint64_t frame_index,
                        std::span<const float> plane) {
  const std::uint64_t start = mix(mix(model_.seed ^ mix(frame_index)) ^ begin) % kNoiseValues;
  Row row{};
  row.plane = plane.data() + begin;
  row.transmission = transmission_.data() + begin;
  row.offset = offset_.data() + begin;
  row.noise = noise_.data() + start;
  row.code = codes_.data() + begin;
  row.count = count;
  row.gain = static_cast<float>(exposure_us / response_.reference_exposure_us);
  row.offset_scale = static_cast<float>(std::ldexp(1.0, response_.bits - model_.calibration.response.bits));
  row.noise_scale = static_cast<float>(std::ldexp(model_.noise_codes, response_.bits - 12));
  row.top = static_cast<float>((1 << response_.bits) - 1);
  if (const auto* log = std::get_if<LogResponse>(&response_.model))
    encode_log(row, *log);
  else if (const auto* linear = std::get_if<LinearResponse>(&response_.model))
    encode_linear(row, *linear);
  else if (const auto* lin_log = std::get_if<LinLogResponse>(&response_.model))
    encode_any(row, *lin_log);
  else if (const auto* companded = std::get_if<PiecewiseLinearResponse>(&response_.model))
    encode_any(row, *companded);
}

void Sensor::encode(std::span<const float> plane, double exposure_us, std::uint64_t frame_index,
                    PixelFormat format, std::span<std::byte> out) {
  if (significant_bits(format) != response_.bits)
    response_ = with_bits(model_.calibration.response, significant_bits(format));
  const auto width = static_cast<std::size_t>(model_.format.width);
  for (std::size_t begin = 0; begin < codes_.size(); begin += width)
    encode_row(begin, width, exposure_us, frame_index, plane);
  pack_codes(codes_, format, out);
}

void pack_codes(std::span<const std::uint16_t> codes, PixelFormat format, std::span<std::byte> out) {
  if (storage_bits(format) == 8) {
    for (std::size_t i = 0; i < codes.size(); ++i) out[i] = static_cast<std::byte>(codes[i]);
  } else if (storage_bits(format) == 16) {
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(out.data(), codes.data(), codes.size() * 2);
    } else {
      for (std::size_t i = 0; i < codes.size(); ++i) {
        out[2 * i] = static_cast<std::byte>(codes[i] & 255);
        out[2 * i + 1] = static_cast<std::byte>(codes[i] >> 8);
      }
    }
  } else {
    for (std::size_t i = 0; i < codes.size(); i += 2) {
      const unsigned first = codes[i], second = i + 1 < codes.size() ? codes[i + 1] : 0;
      const std::size_t at = i / 2 * 3;
      out[at] = static_cast<std::byte>(first & 255);
      out[at + 1] = static_cast<std::byte>(first >> 8 | (second & 15) << 4);
      if (i + 1 < codes.size()) out[at + 2] = static_cast<std::byte>(second >> 4);
    }
  }
}

}  // namespace lightwell::simulator
