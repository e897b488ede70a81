// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "lighting/radiometer/isa.h"

// The inner loops of the frame path, one set for each instruction set, behind plain data. The files that hold
// them are compiled with their own flags, so they include nothing with inline code that the linker could
// share with a machine that lacks the instructions: no standard containers, no algorithms.
namespace lightwell::radiometer {

enum class Storage {
  u8,
  u16,
  p12
};  // how a code lies in the frame; p12: two codes in three bytes, low bits first

// A logarithmic response in 16 bit integers: with
//   t = ((min(code, clip) << shift) · slope >> 16) + base ⊖ attenuation      (⊖ stops at 0)
// the pixel's weighted radiance is 2^(t / 2048 − 16) times one factor for the whole frame. What differs from
// pixel to pixel (fixed pattern, vignetting, solid angle) is the one attenuation, in 1/2048 octaves.
struct LogCurve {
  std::uint16_t clip = 0;
  std::uint16_t slope = 0;
  std::uint16_t base = 0;
  int shift = 0;
};
inline constexpr std::size_t kWindowZeros = 16;  // floats behind the window that stay 0
inline constexpr int kOctave = 2048;             // steps of t
inline constexpr int kMantissaShift = 5;         // fraction of t to 16 bits
inline constexpr int kExponentBias = 127 - 16;
// 65536 (2^x − 1) = x (c1 + x (c2 + x (c3 + x c4))), fitted with the truncating products it is evaluated
// with, for the least relative error of 2^x over [0, 1): 1.6e-5.
inline constexpr std::uint16_t kExp2[4] = {45422, 15811, 3424, 881};

// One batch of cells. A cell is a bin's pixels inside a few rows, as segments: runs of at most `lanes`
// neighbours in the window of decoded rows. Cells stand sorted by their number of segments, so that a class
// is one loop without surprise.
struct CellClass {
  std::uint32_t segments = 0;  // of each cell
  std::uint32_t cells = 0;
};
struct CellBatch {
  const CellClass* classes = nullptr;
  std::size_t class_count = 0;
  const std::uint16_t* start = nullptr;  // of each segment, index into the window
  const std::uint8_t* mask =
      nullptr;  // of each segment, (length − 1) · lanes · 4: byte offset of its mask; lanes > 1
  // Of each cell, padded to a multiple of 8 with slots that are safe to write:
  const std::uint32_t* slot = nullptr;  // where the result goes
  const float* scale = nullptr;         // sum to mean radiance
  const float* peak_scale = nullptr;    // largest sample to radiance
  const float* toe = nullptr;           // radiance to subtract
  std::size_t cells = 0;
};
// radiance[slot] = max(least, sum · scale − toe) · exposure; peak likewise, and never below radiance
struct CellOutput {
  float* radiance = nullptr;
  float* peak = nullptr;
  float exposure = 1;
  float least = 0;
};
struct CellScratch {  // 8 floats a cell of the largest batch, 32 byte aligned
  float* sum = nullptr;
  float* peak = nullptr;
};

struct Kernels {
  Isa isa = Isa::scalar;
  int lanes = 1;  // longest segment of `reduce`
  // count codes (a multiple of 16, read as whole blocks) to weighted radiance; true where one is at clip or
  // above
  bool (*decode[3])(const std::byte* codes, const std::uint16_t* attenuation, float* out, std::size_t count,
                    const LogCurve& curve);
  // Two rows of RGGB, count quads (a multiple of 16): red, the sum of both greens, blue. u8 and u16.
  bool (*decode_bayer[2])(const std::byte* top, const std::byte* bottom, const std::uint16_t* top_attenuation,
                          const std::uint16_t* bottom_attenuation, float* const out[3], std::size_t count,
                          const LogCurve& curve);
  void (*reduce)(const CellBatch& batch, const float* window, const CellScratch& scratch,
                 const CellOutput& out);
  // The same for single pixels, which suit small frames: each class is eight cells, `start` holds the first
  // pixel of all eight, then the second, …
  void (*reduce_pixels)(const CellBatch& batch, const float* window, const CellOutput& out);
};

// nullptr where this build or this machine has no such instructions.
const Kernels* kernels(Isa isa);

}  // namespace lightwell::radiometer
