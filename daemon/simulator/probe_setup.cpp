// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/probe_setup.h"

#include <algorithm>
#include <cstdio>

#include "interface/calibration_io.h"

namespace lightwell::simulator {
namespace {

Error out_of_range(const char* field, double value, const char* allowed) {
  char text[160];
  std::snprintf(text, sizeof text, "%s = %g: allowed %s", field, value, allowed);
  return {ErrorKind::usage, text};
}

Result<FrameFormat> frame_format(const ProbeOptions& options) {
  constexpr int kLargest = 4096;
  if (options.width < 1 || options.width > kLargest)
    return out_of_range("width", options.width, "1 to 4096 pixels");
  if (options.height < 1 || options.height > kLargest)
    return out_of_range("height", options.height, "1 to 4096 pixels");
  const auto format = pixel_format_from_name(options.pixel_format);
  if (!format)
    return Error{
        ErrorKind::usage,
        "pixel format = " + options.pixel_format +
            ": allowed Mono8, Mono10, Mono12, Mono12p, Mono16, BayerRG8, BayerRG10, BayerRG12, BayerRG16"};
  // Half a byte at the end would be left out of the protocol's payload.
  if (*format == PixelFormat::mono12p && options.width % 2 != 0 && options.height % 2 != 0)
    return out_of_range("width of a Mono12p frame of odd height", options.width, "an even number of pixels");
  return FrameFormat{options.width, options.height, *format};
}

Status check_numbers(const ProbeOptions& o) {
  if (!(o.rate_hz >= 0.01 && o.rate_hz <= 1000)) return out_of_range("rate", o.rate_hz, "0.01 to 1000 Hz");
  if (!(o.exposure_us == 0 || (o.exposure_us >= 10 && o.exposure_us <= 1e7)))
    return out_of_range("exposure", o.exposure_us, "10 to 1e7 us");
  if (!(o.noise_codes >= 0 && o.noise_codes <= 100))
    return out_of_range("noise", o.noise_codes, "0 to 100 codes");
  if (!(o.hold_s > 0 && o.hold_s <= 86400)) return out_of_range("hold", o.hold_s, "above 0, at most 86400 s");
  return {};
}

Status set_calibration(const ProbeOptions& options, ProbeSetup& setup) {
  const FrameFormat& format = setup.model.format;
  const int bits = significant_bits(format.pixel_format);
  Calibration& calibration = setup.model.calibration;
  calibration.response = default_response(setup.scene->brightest_cd_m2(), bits);
  if (!options.response.empty()) {
    const auto response = read_response(options.response);
    if (!response) return response.error();
    calibration.response = with_bits(*response, bits);
  }
  calibration.lens = default_lens(format.width, format.height);
  if (!options.lens.empty()) {
    const auto lens = read_lens(options.lens);
    if (!lens) return lens.error();
    if (lens->image_size != calibration.lens.image_size)
      return Error{ErrorKind::bad_input,
                   options.lens.string() + ": image_size = " + std::to_string(lens->image_size[0]) + "x" +
                       std::to_string(lens->image_size[1]) + ": allowed the camera's " +
                       std::to_string(format.width) + "x" + std::to_string(format.height)};
    calibration.lens = *lens;
  }
  calibration.flat = default_flat_field(format.width, format.height, bits, options.seed);
  if (Status status = check(calibration.flat, calibration.lens); !status) return status;
  calibration.id = calibration_id(calibration);
  return {};
}

}  // namespace

Result<ProbeSetup> set_up_probe(const ProbeOptions& options) {
  if (Status status = check_numbers(options); !status) return status.error();
  const auto format = frame_format(options);
  if (!format) return format.error();
  ProbeSetup setup;
  auto scene = options.environments.empty()
                   ? make_scenario(options.scenario)
                   : make_environment_scene(options.environments, options.hold_s, setup.messages);
  if (!scene) return scene.error();
  setup.scene = *std::move(scene);
  setup.model.format = *format;
  setup.model.noise_codes = options.noise_codes;
  setup.model.seed = options.seed;
  if (Status status = set_calibration(options, setup); !status) return status.error();
  setup.rate_hz = options.rate_hz;
  setup.exposure_us = options.exposure_us > 0 ? options.exposure_us
                                              : std::clamp(setup.scene->default_exposure_us(), 10.0,
                                                           std::max(10.0, 0.8e6 / options.rate_hz));
  return setup;
}

}  // namespace lightwell::simulator
