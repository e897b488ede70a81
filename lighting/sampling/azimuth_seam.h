// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

#include "lighting/sampling/ring_distribution.h"

namespace lightwell {

// Where the circle of azimuths is cut open for the inverse of the rings' cumulative power.
//
// A light is a fixed point s of the circle [0, 1); a ring's cumulative power, counted from the seam, maps s
// to azimuth. Energy that crosses the seam wraps from s = 1 to s = 0 and drags every light of its rings
// across the map, so the seam stays where little energy is near:
// - "near" is weighed by the kernel ((1 + cos Δλ)/2)², wide enough that the least of it lies opposite a
// single light
//   and between two;
// - the seam rests while the energy near it exceeds the least by no more than a quarter of the range, so
// noise and
//   slow light do not move it; beyond, it *slides* just far enough, as if pushed by the light. Lights outside
//   of the pushing light then turn no faster than it does, and the ones inside stay in it;
// - where sliding would take it over more than 30° (a lamp was switched on beside it), it *jumps* to the
// least, and the
//   circle of s is turned back by the share of power jumped over (median over rings, weighted by power), so
//   that the lights of most of the energy stay where they are.
// Nothing here allocates after construction. Deterministic in the sequence of maps.
class AzimuthSeam {
 public:
  explicit AzimuthSeam(const PolarGrid& grid);

  // Chooses the seam for this frame's map.
  void follow(const RingDistribution& map) noexcept;
  // A seam that stays where it is put, azimuth in turns.
  void fix(const RingDistribution& map, double turns) noexcept;
  void reset() noexcept;

  [[nodiscard]] double turns() const { return turns_; }  // azimuth of the seam, in [0, 1)
  // s at the seam, in [0, 1).
  [[nodiscard]] double offset() const { return offset_; }

  // For the kernels that locate lights.
  [[nodiscard]] light_kernel::Seam tables() const noexcept {
    return {offset_, turns_ * sectors_, seam_power_.data()};
  }
  // The light's place s to the ring blend's cumulative power from λ = 0, and back.
  [[nodiscard]] double power_target(const RingDistribution& map, const RingBlend& blend,
                                    double s) const noexcept;
  [[nodiscard]] double place(const RingDistribution& map, const RingBlend& blend,
                             double power_before) const noexcept;

 private:
  struct NearEnergy;  // the kernel's sums, as two harmonics
  NearEnergy near_energy(const RingDistribution& map) noexcept;
  bool slide(const NearEnergy& near, double level) noexcept;
  void jump(const RingDistribution& map, double turns) noexcept;
  void update_seam_power(const RingDistribution& map) noexcept;
  [[nodiscard]] double seam_power(const RingBlend& blend) const noexcept {
    return blend.weight_a * seam_power_[static_cast<std::size_t>(blend.a)] +
           blend.weight_b * seam_power_[static_cast<std::size_t>(blend.b)] +
           blend.uniform * turns_ * sectors_;
  }

  bool placed_ = false;
  double turns_ = 0;
  double offset_ = 0;
  int sectors_ = 1;
  std::vector<double> seam_power_;  // [rings], the ring's power over [0, seam)
  struct Share {
    double share;  // of the ring's power between two seams
    double power;
  };
  std::vector<Share> shares_;                        // scratch of jump
  std::vector<double> column_start_;                 // [blocks + 1], scratch of follow
  std::vector<std::complex<double>> block_azimuth_;  // [blocks], e^{iλ} of their middles
  std::vector<std::complex<double>> candidates_;     // e^{−iλ} of the places a seam may first be put
};

}  // namespace lightwell
