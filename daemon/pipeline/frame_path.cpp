// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/frame_path.h"

#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "daemon/clock.h"
#include "lighting/decomposition/decompose.h"

namespace lightwell {
namespace {

std::uint64_t next_shape_number() {
  static std::atomic<std::uint64_t> next{0};
  return ++next;
}

double ms(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) * 1e-6;
}

}  // namespace

FramePath::FramePath(Calibration calibration, const FramePathOptions& options, SnapshotChannel& snapshots)
    : calibration_(std::move(calibration)), options_(options), snapshots_(snapshots) {}

Snapshot FramePath::prototype(const FramePathOptions& options) {
  Snapshot snapshot;
  snapshot.map = PolarMap::make(options.radiometer.grid, 1);
  snapshot.lights.reserve(static_cast<std::size_t>(options.lights.count));
  return snapshot;
}

// The filter belongs to the rate: frequencies that nobody chose keep the paper's proportion to it
// (section 3.3).
LightPipelineOptions FramePath::filter_for(double rate_hz) const {
  LightPipelineOptions lights = options_.lights;
  if (lights.pass_hz > 0) {
    lights.rate_hz = rate_hz > 0 ? rate_hz : lights.rate_hz;
    return lights;
  }
  lights.rate_hz = rate_hz > 0 ? rate_hz : 21;  // proportions alone decide the taps
  lights.pass_hz = lights.rate_hz * 7 / 21;
  lights.stop_hz = lights.rate_hz * 9 / 21;
  return lights;
}

bool FramePath::prepared_for(const FrameFormat& format, double rate_hz) const {
  const bool same_rate = std::abs(rate_hz - rate_hz_) <= 0.02 * std::max(rate_hz, rate_hz_);
  return radiometer_.has_value() && format == format_ && same_rate && lights_;
}

Status FramePath::prepare(const FrameFormat& format, double rate_hz) {
  if (prepared_for(format, rate_hz)) return {};
  const bool same_format = radiometer_.has_value() && format == format_;

  if (!same_format) {
    radiometer_.reset();
    lights_.reset();
    auto radiometer = Radiometer::create(calibration_, format, options_.radiometer);
    if (!radiometer) return radiometer.error();
    radiometer_ = std::move(*radiometer);
    shape_ = radiometer_->make_map();
    shape_number_ = next_shape_number();
    harmonics_.emplace(shape_.grid);
    format_ = format;
  }
  // best has no filter that a rate would change, and its lights' history would be lost with it.
  if (!lights_ || options_.lights.sampler != LightPipelineOptions::Sampler::best) {
    auto lights = LightPipeline::create(shape_.grid, shape_.channels, filter_for(rate_hz));
    if (!lights) return lights.error();
    lights_ = std::move(*lights);
  }
  flicker_.reset();
  if (options_.flicker_hz > 0 && rate_hz > 0) {
    auto flicker = FlickerFilter::create(shape_.radiance.size(), {options_.flicker_hz, rate_hz, 0});
    if (!flicker) return flicker.error();
    flicker_ = std::move(*flicker);
  }
  rate_hz_ = rate_hz;
  malloc_trim(0);  // making tables takes several times the memory of keeping them: 40 MB at 1024²
  return {};
}

// Lights of before a pause say nothing about now; filtering across it would drag them in.
void FramePath::forget_after_gap(std::int64_t capture_mono_ns) noexcept {
  const double period_ns = rate_hz_ > 0 ? 1e9 / rate_hz_ : 0;
  const double gap_ns = static_cast<double>(capture_mono_ns - last_capture_mono_ns_);
  if (last_capture_mono_ns_ != 0 && std::abs(gap_ns) > std::max(5e8, 10 * period_ns)) lights_->reset();
  last_capture_mono_ns_ = capture_mono_ns;
}

void FramePath::process(const FrameInfo& info, std::span<const std::byte> codes) noexcept {
  Snapshot& out = snapshots_.begin_write();
  if (out.shape != shape_number_) {  // first frames after a change of camera or calibration
    out.map = shape_;
    out.shape = shape_number_;
    out.lights.reserve(static_cast<std::size_t>(options_.lights.count));
    out.method = options_.method;
    std::strncpy(out.calibration_id.data(), calibration_.id.c_str(), out.calibration_id.size() - 1);
  }

  const std::int64_t start_ns = mono_now_ns();
  radiometer_->develop(codes, info.exposure_us, out.map);
  const std::int64_t developed_ns = mono_now_ns();

  if (flicker_)
    flicker_->apply(static_cast<double>(info.capture_mono_ns) * 1e-9, info.exposure_us * 1e-6,
                    out.map.radiance);
  forget_after_gap(info.capture_mono_ns);
  const std::span<const DirectionalLight> lights = lights_->process(out.map);
  out.lights.assign(lights.begin(), lights.end());

  const RadianceHarmonics& harmonics = harmonics_->project(out.map);
  for (std::size_t i = 0; i < out.harmonics.size(); ++i)
    out.harmonics[i] = harmonics.row(static_cast<Eigen::Index>(i)).transpose().cast<float>();

  out.number = published() + 1;
  out.sequence = info.sequence;
  out.capture_mono_ns = info.capture_mono_ns;
  out.capture_utc_ns = info.capture_utc_ns;
  out.received_mono_ns = info.received_mono_ns;
  out.format = info.format;
  out.exposure_us = info.exposure_us;
  out.timecode = info.timecode;
  out.temperature_c = info.temperature_c;
  out.coverage = coverage_of(out.map.grid);
  out.total_illuminance = lights_->total_illuminance();
  out.measured_illuminance = lights_->map_illuminance();
  out.delay_frames = static_cast<float>(lights_->delay_frames());
  out.publish_mono_ns = mono_now_ns();
  snapshots_.end_write();

  published_.store(out.number, std::memory_order_relaxed);
  develop_ms_.add(ms(start_ns, developed_ns));
  lights_ms_.add(ms(developed_ns, out.publish_mono_ns));
  latency_ms_.add(ms(info.received_mono_ns, out.publish_mono_ns));
}

}  // namespace lightwell
