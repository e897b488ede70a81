// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/mean_frame.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace lightwell::calibration {
namespace {

bool same_exposure(double a, double b) {
  return std::abs(a - b) <= kOneExposure * std::max(a, b);
}

MeanFrame empty_mean(const TakeFrames& take, double exposure_us) {
  MeanFrame mean;
  mean.format = take.format();
  mean.exposure_us = exposure_us;
  mean.code.assign(take.pixels(), 0);
  mean.sigma.assign(take.pixels(), 0);
  mean.temperature_c = 0;
  return mean;
}

}  // namespace

Result<std::vector<MeanFrame>> mean_frames(TakeFrames& take) {
  std::vector<MeanFrame> means;
  const Status status = take.for_each([&](const RecordedFrame& frame, std::span<const std::byte> codes) {
    auto mean = std::find_if(means.begin(), means.end(), [&](const MeanFrame& m) {
      return same_exposure(m.exposure_us, frame.exposure_us);
    });
    if (mean == means.end()) {
      if (means.size() == kMostExposures)
        return Status(Error{ErrorKind::bad_input, "more than " + std::to_string(kMostExposures) +
                                                      " different exposures: allowed that many"});
      mean = means.insert(mean, empty_mean(take, frame.exposure_us));
    }
    *mean->temperature_c += static_cast<double>(frame.temperature_c);
    const auto n = static_cast<double>(++mean->frames);
    for (std::size_t i = 0; i < take.pixels(); ++i) {  // Welford
      const auto code = static_cast<double>(take.code(codes, i));
      const double step = code - mean->code[i];
      mean->code[i] += step / n;
      mean->sigma[i] += step * (code - mean->code[i]);
    }
    return Status();
  });
  if (!status) return status.error();
  for (MeanFrame& mean : means) {
    const auto n = static_cast<double>(mean.frames);
    for (double& s : mean.sigma) s = mean.frames > 1 ? std::sqrt(s / (n - 1)) : 0;
    *mean.temperature_c /= n;
    if (!std::isfinite(*mean.temperature_c)) mean.temperature_c.reset();
  }
  return means;
}

Result<MeanFrame> mean_frame(const std::filesystem::path& recording) {
  auto take = TakeFrames::open(recording);
  if (!take) return take.error();
  auto means = mean_frames(*take);
  if (!means) return means.error();
  if (means->size() > 1)
    return Error{ErrorKind::bad_input,
                 recording.string() + ": exposure_us = " + std::to_string((*means)[1].exposure_us) +
                     " in a later frame: allowed " + std::to_string((*means)[0].exposure_us) +
                     ", that of the first frame"};
  means->front().name = recording.string();
  return std::move(means->front());
}

}  // namespace lightwell::calibration
