// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "lighting/light_set.h"
#include "lighting/polar_map.h"
#include "lighting/result.h"

namespace lightwell {

enum class TemporalFilter { none, fir };

struct LightPipelineOptions {
  int count = 300;  // lights a frame, 1 to 100,000; best: to kMostPlacedLights
  // best: the project's own (lighting/decomposition/best_lights.h), steady by itself and a tree: of what follows here
  // nothing applies to it
  enum class Sampler { standard, havran, best } sampler = Sampler::havran;
  bool relaxed = true;     // Lloyd relaxation of the Halton points, once (section 3.2)
  std::uint32_t seed = 0;  // Cranley–Patterson rotation of the sequence; 0: none
  TemporalFilter filter = TemporalFilter::fir;
  double rate_hz = 60;      // the camera's
  double pass_hz = 20;      // the paper's 7/21 of the rate
  double stop_hz = 25.714;  // the paper's 9/21
  int filter_order = 8;     // taps − 1; the delay is half of it, in frames
  int clusters = 72;        // Q, bound on the lights after clustering; 0: no clustering
};

// Map to published lights: the project's own, or sample → temporal filter → cluster (Havran et al. 2005, sections 3
// and 4.3). Keeps the state between frames. Once lights have been placed process allocates nothing, and it never fails:
// a black map gives lights of no power.
class LightPipeline {
 public:
  static Result<LightPipeline> create(const PolarGrid& grid, int channels,
                                      const LightPipelineOptions& options);
  LightPipeline(LightPipeline&&) noexcept;
  LightPipeline& operator=(LightPipeline&&) noexcept;
  ~LightPipeline();

  // map: of the grid and channels given to create. The lights stay valid until the next call.
  std::span<const DirectionalLight> process(const PolarMap& map) noexcept;
  // Sampled and filtered, before clustering: light i is the same light in every frame. Of best there are none.
  [[nodiscard]] std::span<const DirectionalLight> unclustered() const noexcept;
  // Total illuminance the lights stand for: filtered, equal to the sum over process()'s lights.
  [[nodiscard]] Rgb total_illuminance() const noexcept;
  // Total illuminance of the last map itself.
  [[nodiscard]] Rgb map_illuminance() const noexcept;
  // Frames by which the lights lag the map.
  [[nodiscard]] double delay_frames() const noexcept;
  // Forgets all history (camera changed, long gap).
  void reset() noexcept;

 private:
  struct State;
  explicit LightPipeline(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace lightwell
