// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// NEON, for arm64, where it is always there: eight codes or four sums at a time.
#include "lighting/radiometer/kernel.h"
#if defined(__aarch64__)
#include <arm_neon.h>

namespace lightwell::radiometer {
namespace {

const std::uint8_t* bytes_at(const std::byte* p) {
  return reinterpret_cast<const std::uint8_t*>(p);
}

// NEON multiplies unsigned 16 bit lanes to 32 bits only; the upper halves are picked out of both products.
uint16x8_t high_product(uint16x8_t a, uint16x8_t b) {
  const uint32x4_t low = vmull_u16(vget_low_u16(a), vget_low_u16(b));
  const uint32x4_t high = vmull_high_u16(a, b);
  return vuzp2q_u16(vreinterpretq_u16_u32(low), vreinterpretq_u16_u32(high));
}

template <Storage kStorage>
struct Codes {
  static constexpr std::size_t bytes(std::size_t pixels) {
    return kStorage == Storage::u8 ? pixels : kStorage == Storage::u16 ? 2 * pixels : pixels * 3 / 2;
  }
  // Sixteen codes at p, exactly their bytes.
  static void load(const std::byte* p, uint16x8_t& first, uint16x8_t& second) {
    if constexpr (kStorage == Storage::u8) {
      const uint8x16_t codes = vld1q_u8(bytes_at(p));
      first = vmovl_u8(vget_low_u8(codes));
      second = vmovl_high_u8(codes);
    } else if constexpr (kStorage == Storage::u16) {
      first = vreinterpretq_u16_u8(vld1q_u8(bytes_at(p)));
      second = vreinterpretq_u16_u8(vld1q_u8(bytes_at(p) + 16));
    } else {  // eight triples of bytes, taken apart: two codes each
      const uint8x8x3_t triple = vld3_u8(bytes_at(p));
      const uint16x8_t middle = vmovl_u8(triple.val[1]);
      const uint16x8_t even =
          vorrq_u16(vmovl_u8(triple.val[0]), vandq_u16(vshlq_n_u16(middle, 8), vdupq_n_u16(0xf00)));
      const uint16x8_t odd = vorrq_u16(vshrq_n_u16(middle, 4), vshll_n_u8(triple.val[2], 4));
      first = vzip1q_u16(even, odd);
      second = vzip2q_u16(even, odd);
    }
  }
};

// 2^(t / 2048 − 16) of eight codes as two vectors of four floats.
class Decoder {
 public:
  explicit Decoder(const LogCurve& curve)
      : clip_(vdupq_n_u16(curve.clip)),
        slope_(vdupq_n_u16(curve.slope)),
        base_(vdupq_n_u16(curve.base)),
        shift_(vdupq_n_s16(static_cast<std::int16_t>(curve.shift))) {}

  void operator()(uint16x8_t codes, const std::uint16_t* attenuation, float32x4_t& low, float32x4_t& high) {
    most_ = vmaxq_u16(most_, codes);
    const uint16x8_t up = vaddq_u16(high_product(vshlq_u16(vminq_u16(codes, clip_), shift_), slope_), base_);
    const uint16x8_t t = vqsubq_u16(up, vld1q_u16(attenuation));
    const uint16x8_t x = vshlq_n_u16(t, kMantissaShift);
    uint16x8_t m = vaddq_u16(high_product(x, vdupq_n_u16(kExp2[3])), vdupq_n_u16(kExp2[2]));
    m = vaddq_u16(high_product(x, m), vdupq_n_u16(kExp2[1]));
    m = vaddq_u16(high_product(x, m), vdupq_n_u16(kExp2[0]));
    m = high_product(x, m);
    const uint16x8_t exponent =
        vaddq_u16(vandq_u16(vshrq_n_u16(t, 4), vdupq_n_u16(0x0f80)), vdupq_n_u16(kExponentBias << 7));
    const uint16x8_t top = vaddq_u16(exponent, vshrq_n_u16(m, 9));
    const uint16x8_t bottom = vshlq_n_u16(m, 7);
    low = vreinterpretq_f32_u16(vzip1q_u16(bottom, top));
    high = vreinterpretq_f32_u16(vzip2q_u16(bottom, top));
  }

  [[nodiscard]] bool clipped() const { return vmaxvq_u16(vcgeq_u16(most_, clip_)) != 0; }

 private:
  uint16x8_t clip_, slope_, base_;
  int16x8_t shift_;
  uint16x8_t most_ = vdupq_n_u16(0);
};

template <Storage kStorage>
bool decode(const std::byte* codes, const std::uint16_t* attenuation, float* out, std::size_t count,
            const LogCurve& curve) {
  Decoder decoder(curve);
  for (std::size_t i = 0; i < count; i += 16) {
    uint16x8_t code[2];
    Codes<kStorage>::load(codes + Codes<kStorage>::bytes(i), code[0], code[1]);
    for (std::size_t half = 0; half < 2; ++half) {
      float32x4_t low, high;
      decoder(code[half], attenuation + i + 8 * half, low, high);
      vst1q_f32(out + i + 8 * half, low);
      vst1q_f32(out + i + 8 * half + 4, high);
    }
  }
  return decoder.clipped();
}

template <Storage kStorage>
bool decode_bayer(const std::byte* top, const std::byte* bottom, const std::uint16_t* top_attenuation,
                  const std::uint16_t* bottom_attenuation, float* const out[3], std::size_t count,
                  const LogCurve& curve) {
  Decoder decoder(curve);
  for (std::size_t x = 0; x < 2 * count; x += 16) {
    uint16x8_t above[2];
    uint16x8_t below[2];
    Codes<kStorage>::load(top + Codes<kStorage>::bytes(x), above[0], above[1]);
    Codes<kStorage>::load(bottom + Codes<kStorage>::bytes(x), below[0], below[1]);
    for (std::size_t half = 0; half < 2; ++half) {
      float32x4_t a, b, c, d;
      decoder(above[half], top_attenuation + x + 8 * half, a, b);
      decoder(below[half], bottom_attenuation + x + 8 * half, c, d);
      const std::size_t to = x / 2 + 4 * half;
      vst1q_f32(out[0] + to, vuzp1q_f32(a, b));
      vst1q_f32(out[1] + to, vaddq_f32(vuzp2q_f32(a, b), vuzp1q_f32(c, d)));
      vst1q_f32(out[2] + to, vuzp2q_f32(c, d));
    }
  }
  return decoder.clipped();
}

alignas(64) constexpr std::uint32_t kMask[4][4] = {
    {~0u, 0, 0, 0}, {~0u, ~0u, 0, 0}, {~0u, ~0u, ~0u, 0}, {~0u, ~0u, ~0u, ~0u}};

float32x4_t segment(const float* window, std::uint16_t start, std::uint8_t mask) {
  const uint32x4_t keep = vld1q_u32(&kMask[0][0] + mask / sizeof(std::uint32_t));
  return vreinterpretq_f32_u32(vandq_u32(keep, vreinterpretq_u32_f32(vld1q_f32(window + start))));
}

// Four cells from i on: to radiance, and out to their slots.
void finish(const CellBatch& batch, std::size_t i, float32x4_t sum, float32x4_t most, const CellOutput& out) {
  const float32x4_t toe = vld1q_f32(batch.toe + i);
  float32x4_t radiance = vsubq_f32(vmulq_f32(sum, vld1q_f32(batch.scale + i)), toe);
  radiance = vmulq_n_f32(vmaxq_f32(radiance, vdupq_n_f32(out.least)), out.exposure);
  float32x4_t peak = vsubq_f32(vmulq_f32(most, vld1q_f32(batch.peak_scale + i)), toe);
  peak = vmaxq_f32(vmulq_n_f32(peak, out.exposure), radiance);
  float r[4];
  float p[4];
  vst1q_f32(r, radiance);
  vst1q_f32(p, peak);
  const std::size_t n = batch.cells - i < 4 ? batch.cells - i : 4;
  for (std::size_t k = 0; k < n; ++k) {
    out.radiance[batch.slot[i + k]] = r[k];
    out.peak[batch.slot[i + k]] = p[k];
  }
}

void reduce(const CellBatch& batch, const float* window, const CellScratch& scratch, const CellOutput& out) {
  const std::uint16_t* start = batch.start;
  const std::uint8_t* mask = batch.mask;
  float* sum = scratch.sum;
  float* most = scratch.peak;
  for (std::size_t k = 0; k < batch.class_count; ++k) {
    const std::uint32_t n = batch.classes[k].segments;
    for (std::uint32_t cell = 0; cell < batch.classes[k].cells; ++cell) {
      float32x4_t even = vdupq_n_f32(0);
      float32x4_t odd = even;
      float32x4_t top = even;
      std::uint32_t i = 0;
      for (; i + 1 < n; i += 2) {
        const float32x4_t u = segment(window, start[i], mask[i]);
        const float32x4_t v = segment(window, start[i + 1], mask[i + 1]);
        even = vaddq_f32(even, u);
        odd = vaddq_f32(odd, v);
        top = vmaxq_f32(top, vmaxq_f32(u, v));
      }
      if (i < n) {
        const float32x4_t u = segment(window, start[i], mask[i]);
        even = vaddq_f32(even, u);
        top = vmaxq_f32(top, u);
      }
      *sum++ = vaddvq_f32(vaddq_f32(even, odd));
      *most++ = vmaxvq_f32(top);
      start += n;
      mask += n;
    }
  }
  for (std::size_t i = 0; i < batch.cells; i += 4)
    finish(batch, i, vld1q_f32(scratch.sum + i), vld1q_f32(scratch.peak + i), out);
}

float32x4_t four(const float* window, const std::uint16_t* start) {
  return float32x4_t{window[start[0]], window[start[1]], window[start[2]], window[start[3]]};
}

void reduce_pixels(const CellBatch& batch, const float* window, const CellOutput& out) {
  const std::uint16_t* start = batch.start;
  for (std::size_t i = 0; i < batch.cells; i += 8) {
    const std::uint32_t n = batch.classes[i / 8].segments;
    float32x4_t low = vdupq_n_f32(0);
    float32x4_t high = low;
    float32x4_t low_top = low;
    float32x4_t high_top = low;
    for (std::uint32_t k = 0; k < n; ++k, start += 8) {
      const float32x4_t a = four(window, start);
      const float32x4_t b = four(window, start + 4);
      low = vaddq_f32(low, a);
      high = vaddq_f32(high, b);
      low_top = vmaxq_f32(low_top, a);
      high_top = vmaxq_f32(high_top, b);
    }
    finish(batch, i, low, low_top, out);
    if (i + 4 < batch.cells) finish(batch, i + 4, high, high_top, out);
  }
}

}  // namespace

extern const Kernels kNeonKernels;
const Kernels kNeonKernels = {Isa::neon,
                              4,
                              {decode<Storage::u8>, decode<Storage::u16>, decode<Storage::p12>},
                              {decode_bayer<Storage::u8>, decode_bayer<Storage::u16>},
                              reduce,
                              reduce_pixels};

}  // namespace lightwell::radiometer
#endif
