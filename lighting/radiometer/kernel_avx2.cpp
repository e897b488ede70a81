// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// AVX2: sixteen codes or eight sums at a time. Built with -mavx2 (lighting/CMakeLists.txt), run where the
// machine has it.
#include "lighting/radiometer/kernel.h"
#if defined(__x86_64__) && defined(__AVX2__)
#include <immintrin.h>

namespace lightwell::radiometer {
namespace {

constexpr std::size_t kPrefetchBytes = 4096;  // how far ahead of the decoder the frame is asked for

// A 16 bit constant in every lane; the cast keeps the bits.
__m256i every(std::uint32_t bits) {
  return _mm256_set1_epi16(static_cast<short>(bits));
}
__m128i load16(const std::byte* p) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
}
__m256i load(const std::uint16_t* p) {
  return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
}

template <Storage kStorage>
struct Codes {
  static constexpr std::size_t bytes(std::size_t pixels) {
    return kStorage == Storage::u8 ? pixels : kStorage == Storage::u16 ? 2 * pixels : pixels * 3 / 2;
  }
  // Sixteen codes at p, exactly their bytes.
  static __m256i load(const std::byte* p) {
    if constexpr (kStorage == Storage::u8) return _mm256_cvtepu8_epi16(load16(p));
    if constexpr (kStorage == Storage::u16) return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(p));
    // 24 bytes as two halves that overlap; each 16 bit lane gets the two bytes that hold its code. The even
    // lane's code is shifted up by the product with 16, then both are shifted down.
    const __m256i pair = _mm256_inserti128_si256(_mm256_castsi128_si256(load16(p)), load16(p + 8), 1);
    const __m256i bytes_of_code = _mm256_setr_epi8(0, 1, 1, 2, 3, 4, 4, 5, 6, 7, 7, 8, 9, 10, 10, 11,  //
                                                   4, 5, 5, 6, 7, 8, 8, 9, 10, 11, 11, 12, 13, 14, 14, 15);
    const __m256i spread = _mm256_shuffle_epi8(pair, bytes_of_code);
    return _mm256_srli_epi16(_mm256_mullo_epi16(spread, _mm256_set1_epi32(0x00010010)), 4);
  }
};

// 2^(t / 2048 − 16): exponent from the top bits, mantissa from the polynomial, in two halves of eight floats.
// The order of the lanes is that of unpack: see in_order.
class Decoder {
 public:
  explicit Decoder(const LogCurve& curve)
      : clip_(every(curve.clip)),
        slope_(every(curve.slope)),
        base_(every(curve.base)),
        shift_(_mm_cvtsi32_si128(curve.shift)) {}

  __m256i steps(__m256i codes, const std::uint16_t* attenuation) {
    most_ = _mm256_max_epu16(most_, codes);
    const __m256i scaled = _mm256_sll_epi16(_mm256_min_epu16(codes, clip_), shift_);
    const __m256i up = _mm256_add_epi16(_mm256_mulhi_epu16(scaled, slope_), base_);
    return _mm256_subs_epu16(up, load(attenuation));
  }

  // unpack works within 128 bit halves; this order of t makes its results come out in order.
  static __m256i in_order(__m256i t) { return _mm256_permute4x64_epi64(t, 0xd8); }

  static void exp2(__m256i t, __m256& low, __m256& high) {
    const __m256i x = _mm256_slli_epi16(t, kMantissaShift);
    __m256i m = _mm256_add_epi16(_mm256_mulhi_epu16(x, every(kExp2[3])), every(kExp2[2]));
    m = _mm256_add_epi16(_mm256_mulhi_epu16(x, m), every(kExp2[1]));
    m = _mm256_add_epi16(_mm256_mulhi_epu16(x, m), every(kExp2[0]));
    m = _mm256_mulhi_epu16(x, m);
    const __m256i exponent = _mm256_and_si256(_mm256_srli_epi16(t, 4), every(0x0f80));
    const __m256i top =
        _mm256_add_epi16(_mm256_add_epi16(exponent, every(kExponentBias << 7)), _mm256_srli_epi16(m, 9));
    const __m256i bottom = _mm256_slli_epi16(m, 7);
    low = _mm256_castsi256_ps(_mm256_unpacklo_epi16(bottom, top));
    high = _mm256_castsi256_ps(_mm256_unpackhi_epi16(bottom, top));
  }

  [[nodiscard]] bool clipped() const {
    const __m256i below = _mm256_cmpeq_epi16(_mm256_subs_epu16(clip_, most_), _mm256_setzero_si256());
    return _mm256_movemask_epi8(below) != 0;
  }

 private:
  __m256i clip_, slope_, base_;
  __m128i shift_;
  __m256i most_ = _mm256_setzero_si256();
};

template <Storage kStorage>
bool decode(const std::byte* codes, const std::uint16_t* attenuation, float* out, std::size_t count,
            const LogCurve& curve) {
  Decoder decoder(curve);
  for (std::size_t i = 0; i < count; i += 16) {
    const std::byte* p = codes + Codes<kStorage>::bytes(i);
    __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(p) + kPrefetchBytes));
    const __m256i t = Decoder::in_order(decoder.steps(Codes<kStorage>::load(p), attenuation + i));
    __m256 low, high;
    Decoder::exp2(t, low, high);
    _mm256_storeu_ps(out + i, low);
    _mm256_storeu_ps(out + i + 8, high);
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
    __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(p) + kPrefetchBytes));
    __builtin_prefetch(reinterpret_cast<const void*>(reinterpret_cast<std::uintptr_t>(q) + kPrefetchBytes));
    __m256 a, b, c, d;  // unpack's order and shuffle's undo each other
    Decoder::exp2(decoder.steps(Codes<kStorage>::load(p), top_attenuation + x), a, b);
    Decoder::exp2(decoder.steps(Codes<kStorage>::load(q), bottom_attenuation + x), c, d);
    _mm256_storeu_ps(out[0] + x / 2, _mm256_shuffle_ps(a, b, 0x88));
    _mm256_storeu_ps(out[1] + x / 2,
                     _mm256_add_ps(_mm256_shuffle_ps(a, b, 0xdd), _mm256_shuffle_ps(c, d, 0x88)));
    _mm256_storeu_ps(out[2] + x / 2, _mm256_shuffle_ps(c, d, 0xdd));
  }
  return decoder.clipped();
}

alignas(64) constexpr std::int32_t kMask[8][8] = {
    {-1, 0, 0, 0, 0, 0, 0, 0},       {-1, -1, 0, 0, 0, 0, 0, 0},      {-1, -1, -1, 0, 0, 0, 0, 0},
    {-1, -1, -1, -1, 0, 0, 0, 0},    {-1, -1, -1, -1, -1, 0, 0, 0},   {-1, -1, -1, -1, -1, -1, 0, 0},
    {-1, -1, -1, -1, -1, -1, -1, 0}, {-1, -1, -1, -1, -1, -1, -1, -1}};

__m256 segment(const float* window, std::uint16_t start, std::uint8_t mask) {
  const auto* table = reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(kMask) + mask);
  return _mm256_and_ps(_mm256_load_ps(table), _mm256_loadu_ps(window + start));
}

// Eight vectors to the vector of their sums, and of their maxima.
__m256 horizontal_sums(const float* v) {
  const __m256 a = _mm256_hadd_ps(_mm256_load_ps(v), _mm256_load_ps(v + 8));
  const __m256 b = _mm256_hadd_ps(_mm256_load_ps(v + 16), _mm256_load_ps(v + 24));
  const __m256 c = _mm256_hadd_ps(_mm256_load_ps(v + 32), _mm256_load_ps(v + 40));
  const __m256 d = _mm256_hadd_ps(_mm256_load_ps(v + 48), _mm256_load_ps(v + 56));
  const __m256 e = _mm256_hadd_ps(a, b);
  const __m256 f = _mm256_hadd_ps(c, d);
  return _mm256_add_ps(_mm256_permute2f128_ps(e, f, 0x20), _mm256_permute2f128_ps(e, f, 0x31));
}

__m256 pairwise_max(__m256 a, __m256 b) {
  return _mm256_max_ps(_mm256_shuffle_ps(a, b, 0x88), _mm256_shuffle_ps(a, b, 0xdd));
}

__m256 horizontal_maxima(const float* v) {
  const __m256 a = pairwise_max(_mm256_load_ps(v), _mm256_load_ps(v + 8));
  const __m256 b = pairwise_max(_mm256_load_ps(v + 16), _mm256_load_ps(v + 24));
  const __m256 c = pairwise_max(_mm256_load_ps(v + 32), _mm256_load_ps(v + 40));
  const __m256 d = pairwise_max(_mm256_load_ps(v + 48), _mm256_load_ps(v + 56));
  const __m256 e = pairwise_max(a, b);
  const __m256 f = pairwise_max(c, d);
  return _mm256_max_ps(_mm256_permute2f128_ps(e, f, 0x20), _mm256_permute2f128_ps(e, f, 0x31));
}

// Eight cells from i on: to radiance, and out to their slots.
// Inline and with copies of both (nothing that is written can change them): a third of a small frame's time is here.
__attribute__((always_inline)) inline void finish(const CellBatch batch, std::size_t i, __m256 sum,
                                                  __m256 most, const CellOutput out) {
  const __m256 toe = _mm256_loadu_ps(batch.toe + i);
  const __m256 exposure = _mm256_set1_ps(out.exposure);
  __m256 radiance = _mm256_sub_ps(_mm256_mul_ps(sum, _mm256_loadu_ps(batch.scale + i)), toe);
  radiance = _mm256_mul_ps(_mm256_max_ps(radiance, _mm256_set1_ps(out.least)), exposure);
  __m256 peak = _mm256_sub_ps(_mm256_mul_ps(most, _mm256_loadu_ps(batch.peak_scale + i)), toe);
  peak = _mm256_max_ps(_mm256_mul_ps(peak, exposure), radiance);
  alignas(32) float r[8];
  alignas(32) float p[8];
  _mm256_store_ps(r, radiance);
  _mm256_store_ps(p, peak);
  const std::uint32_t* slot = batch.slot + i;
  const auto put = [&](std::size_t k) {
    out.radiance[slot[k]] = r[k];
    out.peak[slot[k]] = p[k];
  };
  if (batch.cells - i >= 8) {
    for (std::size_t k = 0; k < 8; ++k) put(k);
  } else {
    for (std::size_t k = 0; k < batch.cells - i; ++k) put(k);
  }
}

void reduce(const CellBatch& given, const float* window, const CellScratch& scratch,
            const CellOutput& given_out) {
  const CellBatch batch = given;
  const CellOutput out = given_out;
  const std::uint16_t* start = batch.start;
  const std::uint8_t* mask = batch.mask;
  float* sum = scratch.sum;
  float* most = scratch.peak;
  for (std::size_t k = 0; k < batch.class_count; ++k) {
    const std::uint32_t n = batch.classes[k].segments;
    for (std::uint32_t cell = 0; cell < batch.classes[k].cells; ++cell) {
      __m256 even = _mm256_setzero_ps();
      __m256 odd = even;
      __m256 top = even;
      std::uint32_t i = 0;
      for (; i + 1 < n; i += 2) {
        const __m256 u = segment(window, start[i], mask[i]);
        const __m256 v = segment(window, start[i + 1], mask[i + 1]);
        even = _mm256_add_ps(even, u);
        odd = _mm256_add_ps(odd, v);
        top = _mm256_max_ps(top, _mm256_max_ps(u, v));
      }
      if (i < n) {
        const __m256 u = segment(window, start[i], mask[i]);
        even = _mm256_add_ps(even, u);
        top = _mm256_max_ps(top, u);
      }
      _mm256_store_ps(sum, _mm256_add_ps(even, odd));
      _mm256_store_ps(most, top);
      start += n;
      mask += n;
      sum += 8;
      most += 8;
    }
  }
  for (std::size_t i = 0; i < batch.cells; i += 8)
    finish(batch, i, horizontal_sums(scratch.sum + 8 * i), horizontal_maxima(scratch.peak + 8 * i), out);
}

void reduce_pixels(const CellBatch& given, const float* window, const CellOutput& given_out) {
  const CellBatch batch = given;
  const CellOutput out = given_out;
  const std::uint16_t* start = batch.start;
  for (std::size_t i = 0; i < batch.cells; i += 8) {
    const std::uint32_t n = batch.classes[i / 8].segments;
    __m256 sum = _mm256_setzero_ps();
    __m256 top = sum;
    for (std::uint32_t k = 0; k < n; ++k, start += 8) {
      const __m256i pixels = _mm256_cvtepu16_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(start)));
      const __m256 value = _mm256_i32gather_ps(window, pixels, 4);
      sum = _mm256_add_ps(sum, value);
      top = _mm256_max_ps(top, value);
    }
    finish(batch, i, sum, top, out);
  }
}

}  // namespace

extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = {Isa::avx2,
                              8,
                              {decode<Storage::u8>, decode<Storage::u16>, decode<Storage::p12>},
                              {decode_bayer<Storage::u8>, decode_bayer<Storage::u16>},
                              reduce,
                              reduce_pixels};

}  // namespace lightwell::radiometer
#endif
