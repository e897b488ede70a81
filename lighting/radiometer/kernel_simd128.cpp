// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// SSE4.1: eight codes or four sums at a time, for x86 machines without AVX2. Built with -msse4.1.
#include "lighting/radiometer/kernel.h"
#if defined(__x86_64__) && defined(__SSE4_1__)
#include <smmintrin.h>

namespace lightwell::radiometer {
namespace {

constexpr std::size_t kPrefetchBytes = 4096;  // how far ahead of the decoder the frame is asked for

// A 16 bit constant in every lane; the cast keeps the bits.
__m128i every(std::uint32_t bits) {
  return _mm_set1_epi16(static_cast<short>(bits));
}
__m128i load16(const std::byte* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}

void prefetch(const std::byte* p) {
  __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(p) + kPrefetchBytes));
}

template <Storage kStorage>
struct Codes {
  static constexpr std::size_t bytes(std::size_t pixels) {
    return kStorage == Storage::u8 ? pixels : kStorage == Storage::u16 ? 2 * pixels : pixels * 3 / 2;
  }
  // Sixteen codes at p, exactly their bytes.
  static void load(const std::byte* p, __m128i& first, __m128i& second) {
    if constexpr (kStorage == Storage::u8) {
      const __m128i codes = load16(p);
      first = _mm_cvtepu8_epi16(codes);
      second = _mm_unpackhi_epi8(codes, _mm_setzero_si128());
    } else if constexpr (kStorage == Storage::u16) {
      first = load16(p);
      second = load16(p + 16);
    } else {  // 24 bytes as two halves that overlap: see kernel_avx2.cpp
      first = unpack(load16(p), _mm_setr_epi8(0, 1, 1, 2, 3, 4, 4, 5, 6, 7, 7, 8, 9, 10, 10, 11));
      second = unpack(load16(p + 8), _mm_setr_epi8(4, 5, 5, 6, 7, 8, 8, 9, 10, 11, 11, 12, 13, 14, 14, 15));
    }
  }

 private:
  static __m128i unpack(__m128i packed, __m128i bytes_of_code) {
    return _mm_srli_epi16(
        _mm_mullo_epi16(_mm_shuffle_epi8(packed, bytes_of_code), _mm_set1_epi32(0x00010010)), 4);
  }
};

// 2^(t / 2048 − 16) of eight codes as two vectors of four floats.
class Decoder {
 public:
  explicit Decoder(const LogCurve& curve)
      : clip_(every(curve.clip)),
        slope_(every(curve.slope)),
        base_(every(curve.base)),
        shift_(_mm_cvtsi32_si128(curve.shift)) {}

  void operator()(__m128i codes, const std::uint16_t* attenuation, __m128& low, __m128& high) {
    most_ = _mm_max_epu16(most_, codes);
    const __m128i scaled = _mm_sll_epi16(_mm_min_epu16(codes, clip_), shift_);
    const __m128i up = _mm_add_epi16(_mm_mulhi_epu16(scaled, slope_), base_);
    const __m128i t = _mm_subs_epu16(up, _mm_loadu_si128(reinterpret_cast<const __m128i*>(attenuation)));
    const __m128i x = _mm_slli_epi16(t, kMantissaShift);
    __m128i m = _mm_add_epi16(_mm_mulhi_epu16(x, every(kExp2[3])), every(kExp2[2]));
    m = _mm_add_epi16(_mm_mulhi_epu16(x, m), every(kExp2[1]));
    m = _mm_add_epi16(_mm_mulhi_epu16(x, m), every(kExp2[0]));
    m = _mm_mulhi_epu16(x, m);
    const __m128i exponent = _mm_and_si128(_mm_srli_epi16(t, 4), every(0x0f80));
    const __m128i top =
        _mm_add_epi16(_mm_add_epi16(exponent, every(kExponentBias << 7)), _mm_srli_epi16(m, 9));
    const __m128i bottom = _mm_slli_epi16(m, 7);
    low = _mm_castsi128_ps(_mm_unpacklo_epi16(bottom, top));
    high = _mm_castsi128_ps(_mm_unpackhi_epi16(bottom, top));
  }

  [[nodiscard]] bool clipped() const {
    return _mm_movemask_epi8(_mm_cmpeq_epi16(_mm_subs_epu16(clip_, most_), _mm_setzero_si128())) != 0;
  }

 private:
  __m128i clip_, slope_, base_, shift_;
  __m128i most_ = _mm_setzero_si128();
};

template <Storage kStorage>
bool decode(const std::byte* codes, const std::uint16_t* attenuation, float* out, std::size_t count,
            const LogCurve& curve) {
  Decoder decoder(curve);
  for (std::size_t i = 0; i < count; i += 16) {
    const std::byte* p = codes + Codes<kStorage>::bytes(i);
    prefetch(p);
    __m128i code[2];
    Codes<kStorage>::load(p, code[0], code[1]);
    for (std::size_t half = 0; half < 2; ++half) {
      __m128 low, high;
      decoder(code[half], attenuation + i + 8 * half, low, high);
      _mm_storeu_ps(out + i + 8 * half, low);
      _mm_storeu_ps(out + i + 8 * half + 4, high);
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
    const std::byte* p = top + Codes<kStorage>::bytes(x);
    const std::byte* q = bottom + Codes<kStorage>::bytes(x);
    prefetch(p);
    prefetch(q);
    __m128i above[2];
    __m128i below[2];
    Codes<kStorage>::load(p, above[0], above[1]);
    Codes<kStorage>::load(q, below[0], below[1]);
    for (std::size_t half = 0; half < 2; ++half) {
      __m128 a, b, c, d;
      decoder(above[half], top_attenuation + x + 8 * half, a, b);
      decoder(below[half], bottom_attenuation + x + 8 * half, c, d);
      const std::size_t to = x / 2 + 4 * half;
      _mm_storeu_ps(out[0] + to, _mm_shuffle_ps(a, b, 0x88));
      _mm_storeu_ps(out[1] + to, _mm_add_ps(_mm_shuffle_ps(a, b, 0xdd), _mm_shuffle_ps(c, d, 0x88)));
      _mm_storeu_ps(out[2] + to, _mm_shuffle_ps(c, d, 0xdd));
    }
  }
  return decoder.clipped();
}

alignas(64) constexpr std::int32_t kMask[4][4] = {
    {-1, 0, 0, 0}, {-1, -1, 0, 0}, {-1, -1, -1, 0}, {-1, -1, -1, -1}};

__m128 segment(const float* window, std::uint16_t start, std::uint8_t mask) {
  const auto* table = reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(kMask) + mask);
  return _mm_and_ps(_mm_load_ps(table), _mm_loadu_ps(window + start));
}

// Four cells from i on: to radiance, and out to their slots.
void finish(const CellBatch& batch, std::size_t i, __m128 sum, __m128 most, const CellOutput& out) {
  const __m128 toe = _mm_loadu_ps(batch.toe + i);
  const __m128 exposure = _mm_set1_ps(out.exposure);
  __m128 radiance = _mm_sub_ps(_mm_mul_ps(sum, _mm_loadu_ps(batch.scale + i)), toe);
  radiance = _mm_mul_ps(_mm_max_ps(radiance, _mm_set1_ps(out.least)), exposure);
  __m128 peak = _mm_sub_ps(_mm_mul_ps(most, _mm_loadu_ps(batch.peak_scale + i)), toe);
  peak = _mm_max_ps(_mm_mul_ps(peak, exposure), radiance);
  alignas(16) float r[4];
  alignas(16) float p[4];
  _mm_store_ps(r, radiance);
  _mm_store_ps(p, peak);
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
      __m128 even = _mm_setzero_ps();
      __m128 odd = even;
      __m128 top = even;
      std::uint32_t i = 0;
      for (; i + 1 < n; i += 2) {
        const __m128 u = segment(window, start[i], mask[i]);
        const __m128 v = segment(window, start[i + 1], mask[i + 1]);
        even = _mm_add_ps(even, u);
        odd = _mm_add_ps(odd, v);
        top = _mm_max_ps(top, _mm_max_ps(u, v));
      }
      if (i < n) {
        const __m128 u = segment(window, start[i], mask[i]);
        even = _mm_add_ps(even, u);
        top = _mm_max_ps(top, u);
      }
      _mm_store_ps(sum, _mm_add_ps(even, odd));
      _mm_store_ps(most, top);
      start += n;
      mask += n;
      sum += 4;
      most += 4;
    }
  }
  for (std::size_t i = 0; i < batch.cells; i += 4) {
    const float* s = scratch.sum + 4 * i;
    const float* m = scratch.peak + 4 * i;
    __m128 a = _mm_load_ps(s), b = _mm_load_ps(s + 4), c = _mm_load_ps(s + 8), d = _mm_load_ps(s + 12);
    __m128 e = _mm_load_ps(m), f = _mm_load_ps(m + 4), g = _mm_load_ps(m + 8), h = _mm_load_ps(m + 12);
    _MM_TRANSPOSE4_PS(a, b, c, d);
    _MM_TRANSPOSE4_PS(e, f, g, h);
    finish(batch, i, _mm_add_ps(_mm_add_ps(a, b), _mm_add_ps(c, d)),
           _mm_max_ps(_mm_max_ps(e, f), _mm_max_ps(g, h)), out);
  }
}

__m128 four(const float* window, const std::uint16_t* start) {
  return _mm_setr_ps(window[start[0]], window[start[1]], window[start[2]], window[start[3]]);
}

void reduce_pixels(const CellBatch& batch, const float* window, const CellOutput& out) {
  const std::uint16_t* start = batch.start;
  for (std::size_t i = 0; i < batch.cells; i += 8) {
    const std::uint32_t n = batch.classes[i / 8].segments;
    __m128 low = _mm_setzero_ps();
    __m128 high = low;
    __m128 low_top = low;
    __m128 high_top = low;
    for (std::uint32_t k = 0; k < n; ++k, start += 8) {
      const __m128 a = four(window, start);
      const __m128 b = four(window, start + 4);
      low = _mm_add_ps(low, a);
      high = _mm_add_ps(high, b);
      low_top = _mm_max_ps(low_top, a);
      high_top = _mm_max_ps(high_top, b);
    }
    finish(batch, i, low, low_top, out);
    if (i + 4 < batch.cells) finish(batch, i + 4, high, high_top, out);
  }
}

}  // namespace

extern const Kernels kSimd128Kernels;
const Kernels kSimd128Kernels = {Isa::simd128,
                                 4,
                                 {decode<Storage::u8>, decode<Storage::u16>, decode<Storage::p12>},
                                 {decode_bayer<Storage::u8>, decode_bayer<Storage::u16>},
                                 reduce,
                                 reduce_pixels};

}  // namespace lightwell::radiometer
#endif
