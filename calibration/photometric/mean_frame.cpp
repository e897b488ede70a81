// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/mean_frame.h"

#include <cmath>
#include <string>

#include "interface/recording.h"
#include "lighting/radiometer/row_decoder.h"

namespace lightwell::calibration {
namespace {

radiometer::Storage storage_of(PixelFormat format) {
  const int bits = storage_bits(format);
  return bits == 8    ? radiometer::Storage::u8
         : bits == 12 ? radiometer::Storage::p12
                      : radiometer::Storage::u16;
}

}  // namespace

Result<MeanFrame> mean_frame(const std::filesystem::path& recording) {
  const auto opened = RecordingReader::open(recording);
  if (!opened) return opened.error();
  RecordingReader& reader = **opened;
  MeanFrame mean;
  mean.format = reader.header().format;
  const auto pixels =
      static_cast<std::size_t>(mean.format.width) * static_cast<std::size_t>(mean.format.height);
  mean.code.assign(pixels, 0);
  mean.sigma.assign(pixels, 0);
  std::vector<std::byte> codes(mean.format.bytes());
  const radiometer::Storage storage = storage_of(mean.format.pixel_format);
  double temperature = 0;
  for (;;) {
    const auto frame = reader.read(codes);
    if (!frame) return frame.error();
    if (!*frame) break;
    if (mean.frames == 0) mean.exposure_us = (*frame)->exposure_us;
    if (std::abs((*frame)->exposure_us - mean.exposure_us) > 1e-3 * mean.exposure_us)
      return Error{ErrorKind::bad_input, recording.string() +
                                             ": exposure_us = " + std::to_string((*frame)->exposure_us) +
                                             " in frame " + std::to_string(mean.frames) + ": allowed " +
                                             std::to_string(mean.exposure_us) + ", that of the first frame"};
    temperature += static_cast<double>((*frame)->temperature_c);
    ++mean.frames;
    const auto n = static_cast<double>(mean.frames);
    for (std::size_t i = 0; i < pixels; ++i) {  // Welford
      const auto code = static_cast<double>(radiometer::code_at(codes.data(), storage, i));
      const double step = code - mean.code[i];
      mean.code[i] += step / n;
      mean.sigma[i] += step * (code - mean.code[i]);
    }
  }
  if (mean.frames == 0) return Error{ErrorKind::bad_input, recording.string() + ": holds no whole frame"};
  const auto n = static_cast<double>(mean.frames);
  for (double& s : mean.sigma) s = mean.frames > 1 ? std::sqrt(s / (n - 1)) : 0;
  if (std::isfinite(temperature)) mean.temperature_c = temperature / n;
  return mean;
}

}  // namespace lightwell::calibration
