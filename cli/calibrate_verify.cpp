// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "calibration/photometric/illuminance_check.h"
#include "calibration/photometric/take_frames.h"
#include "cli/command.h"
#include "interface/calibration_io.h"
#include "interface/environment_io.h"
#include "interface/option_range.h"

namespace lightwell::cli {
namespace {

struct Options {
  double lux = 0;
  double tolerance_percent = 0;  // 0: none
  std::string environment, recording, calibration;
  std::array<double, 3> toward = {0, 1, 0};
  bool no_cosine = false, json = false;
};

Result<Calibration> calibration_for(const Options& o) {
  if (!o.calibration.empty()) return read_calibration(o.calibration);
  const auto take = calibration::TakeFrames::open(o.recording);
  if (!take) return take.error();
  const std::string& text = take->header().calibration_json;
  if (text.empty()) return usage("--calibration is missing, and " + o.recording + " carries none");
  return calibration_from_json(text, o.recording + " (attached calibration.json)");
}

// remark: what reading the map has to say.
Result<calibration::RecordedIlluminance> measure(const Options& o, const calibration::Meter& meter,
                                                 std::string& remark) {
  if (!o.environment.empty()) {
    const auto environment = read_environment(o.environment);
    if (!environment) return environment.error();
    remark = environment->remark(o.environment);
    calibration::RecordedIlluminance out;
    out.lux = calibration::illuminance_lux(environment->image, meter);
    out.measured_part = calibration::lit_part(environment->image, meter);
    return out;
  }
  const auto calibration = calibration_for(o);
  if (!calibration) return calibration.error();
  return calibration::recorded_illuminance(o.recording, *calibration, meter);
}

void print_json(const Options& o, const calibration::RecordedIlluminance& measured, double ratio) {
  nlohmann::ordered_json json = {{"schema", "lightwell.verify/1"},
                                 {"meter_lux", o.lux},
                                 {"map_lux", measured.lux},
                                 {"map_sigma_lux", measured.sigma_lux},
                                 {"error", ratio - 1},
                                 {"stops", std::log2(ratio)},
                                 {"scale", 1 / ratio},
                                 {"frames", measured.frames},
                                 {"clipped_pixels", measured.clipped},
                                 {"measured_part", measured.measured_part}};
  if (o.tolerance_percent > 0) json["tolerance"] = o.tolerance_percent / 100;
  std::printf("%s\n", json.dump(2).c_str());
}

void print_text(const Options& o, const calibration::RecordedIlluminance& measured, double ratio) {
  std::printf("map %.6g lux, meter %.6g lux: error %+.2f %%, %+.3f stops (times %.6g would agree)\n",
              measured.lux, o.lux, 100 * (ratio - 1), std::log2(ratio), 1 / ratio);
  if (measured.clipped > 0)
    std::printf(
        "%llu pixels are clipped, by lamps or as hot pixels: where it was light, there is more than was "
        "measured\n",
        static_cast<unsigned long long>(measured.clipped));
  if (measured.measured_part < 0.99)
    std::printf(o.environment.empty() ? "only %.1f %% of what the meter sees lies in the lens's field\n"
                                      : "only %.1f %% of what the meter sees is not black in the map\n",
                100 * measured.measured_part);
}

Status check_usage(const Options& o) {
  if (!(o.lux > 0 && o.lux <= 1e9)) return usage("--lux: allowed above 0, at most 1e9");
  if (o.environment.empty() == o.recording.empty())
    return usage("one of --environment and --recording is needed");
  if (!o.environment.empty() && !o.calibration.empty())
    return usage("--calibration goes with --recording: a map is calibrated");
  return {};
}

int run(const Options& o) {
  if (const Status status = check_usage(o); !status) return fail(status.error());
  calibration::Meter meter;
  meter.toward = Vec3d(o.toward[0], o.toward[1], o.toward[2]);
  if (!(meter.toward.norm() > 0 && meter.toward.norm() < 1e9))
    return fail(usage("--toward: allowed three numbers that are not all 0"));
  meter.toward.normalize();
  meter.cosine = !o.no_cosine;
  std::string remark;
  const auto measured = measure(o, meter, remark);
  if (!measured) return fail(measured.error());
  const std::string source = (o.environment.empty() ? o.recording : o.environment) + ": ";
  // A refusal is one line: what reading the map has to say stands in it.
  const std::string aside = remark.empty() ? "" : "; " + remark.substr(source.size());
  if (!(measured->lux > 0))
    return fail(
        {ErrorKind::bad_input,
         source + "no light at all reaches the meter: allowed a map that is not black there" + aside});
  if (!(measured->lux > measured->darkness_lux)) {
    char error[200];
    std::snprintf(error, sizeof error,
                  "%.3g lux in the take, which is dark: allowed above %.3g, one code of light all over",
                  measured->lux, measured->darkness_lux);
    return fail({ErrorKind::bad_input, source + error});
  }
  const double ratio = measured->lux / o.lux;
  if (o.json)
    print_json(o, *measured, ratio);
  else
    print_text(o, *measured, ratio);
  if (o.tolerance_percent > 0 && !(std::abs(ratio - 1) <= o.tolerance_percent / 100)) {
    char error[64];
    std::snprintf(error, sizeof error, "error %+.2f %%: allowed up to %g %%", 100 * (ratio - 1),
                  o.tolerance_percent);
    return fail({ErrorKind::bad_input, source + error + aside});
  }
  if (!remark.empty()) std::fprintf(stderr, "lightwell: %s\n", remark.c_str());
  return 0;
}

}  // namespace

Command add_calibrate_verify(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      group.add_subcommand("verify", "Compare the integral of a map with a lux meter's reading");
  command->footer(
      "Example: lightwell calibrate verify --lux 903 --recording take.mkv --calibration calibration");
  command->add_option("--lux", options->lux, "What the meter reads, lying level beside the probe")
      ->required();
  command->add_option("--environment", options->environment, "Latitude–longitude map, EXR or Radiance HDR")
      ->type_name("ENV");
  command->add_option("--recording", options->recording, "Take; every frame is developed")
      ->type_name("TAKE.mkv");
  command->add_option("--calibration", options->calibration, "Folder; default: the one in the take")
      ->type_name("DIR");
  command->add_option("--toward", options->toward, "Where the meter faces, default straight up (0,1,0)")
      ->delimiter(',')
      ->type_name("X,Y,Z");
  command
      ->add_option("--tolerance", options->tolerance_percent,
                   "Exit with 3 where the map is farther off than this")
      ->check(numbers_above_0_to(100, "above 0, at most 100 percent"))
      ->type_name("PERCENT");
  command->add_flag("--no-cosine", options->no_cosine,
                    "A diode that counts every direction of its hemisphere alike");
  command->add_flag("--json", options->json, "Machine-readable result on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
