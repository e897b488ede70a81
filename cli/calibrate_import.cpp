// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <string>

#include "calibration/lens_import/convert_lens.h"
#include "cli/gravity_option.h"
#include "interface/atomic_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct ImportOptions {
  std::string file;
  std::string format;
  std::string camera;
  std::string model;
  double max_theta_deg = 0;  // 0: as far as the image shows
  std::string gravity;
  std::string out;
  bool json = false;
};

void print_text(const calibration::SourceLens& source, const calibration::LensConversion& c,
                const ImportOptions& o) {
  std::printf("read as           %s, %s\n", std::string(calibration::name(source.format)).c_str(),
              source.model.c_str());
  std::printf("focal             %.3f %.3f px a radian\n", c.lens.focal.x(), c.lens.focal.y());
  std::printf("center            %.3f %.3f\n", c.lens.center.x(), c.lens.center.y());
  std::printf("k                 %.6f %.6f %.6f %.6f\n", c.lens.k[0], c.lens.k[1], c.lens.k[2], c.lens.k[3]);
  std::printf(
      "conversion        %s: %.3g px rms, %.3g px at most, at %.1f degrees off axis; %.3g degrees rms, "
      "%.3g at most\n",
      c.exact ? "exact" : "fitted, by solid angle", c.error.rms_px, c.error.max_px, c.error.max_at_deg,
      c.error.rms_deg, c.error.max_deg);
  if (c.turn.norm() > 0)
    std::printf("turned            by %.2f degrees against the file's camera frame\n",
                c.turn.norm() * 180 / kPi);
  std::printf("field             to %.1f degrees off axis", c.lens.max_theta_rad * 180 / kPi);
  if (o.max_theta_deg <= 0 && c.lens.max_theta_rad >= increasing_to_rad(c.lens))
    std::printf(", where its projection stops growing: the image goes on, but no lens is like that");
  else if (o.max_theta_deg <= 0)
    std::printf(", the farthest that the image shows; --max-theta ends it at the lens's circle");
  if (c.lens.max_theta_rad > c.supported_theta_rad)
    std::printf(", extrapolated beyond %.1f, the farthest that the image shows",
                c.supported_theta_rad * 180 / kPi);
  std::printf("\n");
  std::printf("written           %s\n", o.out.c_str());
}

int run(const ImportOptions& o) {
  if (const Status other = check_output_is_no_input(o.out, {o.file}); !other) return fail(other.error());
  const auto zenith = o.gravity.empty() ? Result<Vec3d>(Vec3d::UnitZ()) : zenith_of_option(o.gravity);
  if (!zenith) return fail(zenith.error());
  calibration::SourceLensOptions options;
  if (!o.format.empty()) options.format = calibration::lens_format(o.format);
  options.camera = o.camera;
  options.model = o.model;
  const auto source = calibration::read_source_lens(o.file, options);
  if (!source) return fail(source.error());
  const std::optional<double> field =
      o.max_theta_deg > 0 ? std::optional(o.max_theta_deg * kPi / 180) : std::nullopt;
  auto converted = calibration::convert_lens(*source, field);
  if (!converted) return fail({converted.error().kind, o.file + ": " + converted.error().message});
  if (!o.gravity.empty()) converted->lens.zenith = calibration::turned(*converted, *zenith);
  const std::string report = calibration::import_report(*source, *converted).dump();
  if (const Status status = write_file_atomically(o.out, report + "\n"); !status) return fail(status.error());
  if (source->assumed)
    std::fprintf(stderr,
                 "lightwell: %s: names no lens model: %s is assumed, for its image is too wide for a "
                 "perspective lens; "
                 "state it by --model fisheye\n",
                 printable(o.file).c_str(), source->model.c_str());
  if (o.json)
    std::printf("%s\n", report.c_str());
  else
    print_text(*source, *converted, o);
  return 0;
}

}  // namespace

Command add_calibrate_import(CLI::App& calibrate) {
  const auto o = std::make_shared<ImportOptions>();
  CLI::App* command = calibrate.add_subcommand(
      "import", "A lens that OpenCV, Kalibr, OCamCalib or mrcal calibrated, with the conversion's error");
  command->footer("Example: lightwell calibrate import camchain.yaml --camera cam0 --out lens.json");
  command
      ->add_option("file", o->file,
                   "OpenCV fisheye (YAML, XML, JSON), Kalibr camchain, OCamCalib calib_results.txt, mrcal "
                   ".cameramodel")
      ->required();
  command->add_option("--format", o->format, "opencv|kalibr|ocamcalib|mrcal; else by the content")
      ->check([](const std::string& text) {
        return calibration::lens_format(text)
                   ? std::string()
                   : "value '" + text + "', allowed opencv, kalibr, ocamcalib, mrcal";
      });
  command->add_option("--camera", o->camera, "Of a Kalibr file with several cameras: cam0, cam1, ..");
  command
      ->add_option("--model", o->model,
                   "Of an OpenCV file that names none: fisheye|omnidir; else fisheye where the image is too "
                   "wide for a "
                   "perspective lens")
      ->check(CLI::IsMember({"fisheye", "omnidir"}));
  command
      ->add_option("--max-theta", o->max_theta_deg,
                   "Where the field ends, degrees off axis; else the farthest angle that the image shows")
      ->check(numbers_above_0_to(180, "above 0, at most 180 degrees"));
  command->add_option(
      "--gravity", o->gravity,
      std::string(kGravityHelp) + ". Of the file's camera: where the import turns it, so is this");
  command->add_option("--out", o->out, "The lens, with the conversion's error, JSON")
      ->required()
      ->check(output_file());
  command->add_flag("--json", o->json, "The same on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
