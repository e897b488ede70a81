// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "calibration/photometric/flat_fit.h"
#include "calibration/photometric/take_level.h"
#include "cli/command.h"
#include "cli/progress.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/option_range.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct Options {
  std::vector<std::string> recordings;
  std::vector<double> turned_deg;
  std::string dark, lens, response, out;
  bool json = false;
};

Status check_usage(const Options& o) {
  if (!o.turned_deg.empty() && o.turned_deg.size() != o.recordings.size())
    return usage("--turning: " + std::to_string(o.turned_deg.size()) +
                 " angles: allowed one for each of the " + std::to_string(o.recordings.size()) +
                 " recordings");
  for (const double angle : o.turned_deg)
    if (!(std::abs(angle) <= 360)) return usage("--turning: allowed degrees from -360 to 360");
  for (const std::string& recording : o.recordings)
    if (const Status status = check_output_is_no_input(o.out, {recording, o.dark, o.lens, o.response});
        !status)
      return status;
  return {};
}

Result<calibration::FlatFit> fit(const Options& o, const Lens& lens, const Response& response) {
  std::vector<calibration::FlatTake> takes;
  Progress progress(o.recordings.size());
  for (const std::string& recording : o.recordings) {
    auto mean = calibration::mean_frame(recording);
    if (!mean) return mean.error();
    takes.push_back({recording, *std::move(mean)});
    progress.done(takes.size());
  }
  std::optional<calibration::MeanFrame> dark;
  if (!o.dark.empty()) {
    auto read = calibration::mean_frame(o.dark);
    if (!read) return read.error();
    dark = *std::move(read);
  }
  const bool mosaic = is_bayer(takes[0].mean.format.pixel_format);
  if (const Status status = calibration::check_field(lens, mosaic); !status)
    return Error{status.error().kind, o.lens + ": " + status.error().message};
  if (!o.turned_deg.empty()) return fit_turned_flat_field(takes, o.turned_deg, dark, lens, response);
  return fit_flat_field(takes, dark, lens, response);
}

void print(const calibration::FlatFit& fit, const Lens& lens) {
  std::printf("vignetting   T(t) = 1");
  for (std::size_t i = 0; i < 3; ++i)
    if (static_cast<int>(i) < fit.vignetting_terms)
      std::printf(" %+.5f t^%zu", fit.flat.vignetting[i], 2 * (i + 1));
  std::printf(", %.1f %% left at the edge\n", 100 * fit.flat.transmission(lens.max_theta_rad));
  const bool turned = !fit.turned_deg.empty();
  if (!turned || fit.from_dark)
    std::printf("offsets      %.3f codes rms, known to %.3f codes, from %s\n", fit.offset_rms_codes,
                std::hypot(fit.offset_sigma_codes, fit.offset_shared_sigma_codes),
                fit.from_dark ? "dark frames" : "the even frames");
  else
    std::printf("offsets      none: they need --dark\n");
  if (fit.from_dark) {
    const auto& d = fit.dark_level_error_codes;
    if (is_bayer(fit.takes[0].mean.format.pixel_format))
      std::printf("darkness     %+.2f %+.2f %+.2f codes (red, green, blue)", d[0], d[1], d[2]);
    else
      std::printf("darkness     %+.2f codes", d[0]);
    std::printf(" from where the response has it; not counted as offsets\n");
  }
  if (!fit.flat.gain.empty())
    std::printf("gains        %.2f %% rms, known to %.2f %%\n", 100 * fit.gain_rms, 100 * fit.gain_sigma);
  else if (std::isfinite(fit.gain_sigma))
    std::printf("gains        left out: their spread of %.2f %% is no more than the noise, %.2f %%\n",
                100 * fit.gain_rms, 100 * fit.gain_sigma);
  else
    std::printf("gains        left out: these takes do not tell them from offsets\n");
  if (turned)
    std::printf("scene        %zu places, seen alike to %.1f %% by %zu takes", fit.pixels,
                100 * fit.scene_scatter, fit.takes.size());
  else
    std::printf("scene        even to %.1f %%, %zu pixels, %zu take%s", 100 * fit.tilt, fit.pixels,
                fit.takes.size(), fit.takes.size() > 1 ? "s" : "");
  if (fit.masked_pixels > 0) std::printf(", %zu pixels of lamps or dust left out", fit.masked_pixels);
  if (const auto& c = fit.takes[0].mean.temperature_c) std::printf(", %.1f degrees C", *c);
  std::printf("\n");
  if (!turned)
    std::printf(
        "             what darkens toward the scene's own edge, as skies do, is taken for vignetting\n");
}

// Light that changed between the takes, or angles other than stated, pass for vignetting.
void warn_of_disagreement(const calibration::FlatFit& fit) {
  constexpr double kMost = 0.03;
  if (!fit.turned_deg.empty() && fit.scene_scatter > kMost)
    std::fprintf(stderr,
                 "lightwell: the takes disagree on the scene by %.1f %%, good is up to %.0f %%: did the "
                 "light change, or "
                 "are the angles of --turning other than stated? The vignetting is not to be trusted\n",
                 100 * fit.scene_scatter, 100 * kMost);
}

// Fixed patterns go with temperature.
void warn_of_temperature(const calibration::FlatFit& fit) {
  constexpr double kMost = 5;
  const auto& even = fit.takes[0].mean.temperature_c;
  if (even && fit.dark_temperature_c && std::abs(*even - *fit.dark_temperature_c) > kMost)
    std::fprintf(
        stderr,
        "lightwell: the dark frames were taken at %.1f degrees C, the others at %.1f: offsets may differ\n",
        *fit.dark_temperature_c, *even);
}

int run(const Options& o) {
  if (const Status status = check_usage(o); !status) return fail(status.error());
  const auto lens = read_lens(o.lens);
  if (!lens) return fail(lens.error());
  const auto response = read_response(o.response);
  if (!response) return fail(response.error());
  const auto flat = fit(o, *lens, *response);
  if (!flat) return fail(flat.error());
  if (const Status status = write_file_atomically(o.out, calibration::flat_file(*flat)); !status)
    return fail(status.error());
  warn_of_disagreement(*flat);
  warn_of_temperature(*flat);
  if (o.json)
    std::printf("%s\n", calibration::report_to_json(*flat)
                            .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
                            .c_str());
  else
    print(*flat, *lens);
  return 0;
}

}  // namespace

Command add_calibrate_flat(CLI::App& group) {
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      group.add_subcommand("flat", "Measure fixed pattern and vignetting from frames of an even scene");
  command->footer(
      "Example: lightwell calibrate flat even.mkv --lens lens.json --response response.json --out flat.json");
  command
      ->add_option("RECORDINGS", options->recordings,
                   "Take of an even scene, a diffuser before the lens; several, of different brightness, "
                   "tell gains from offsets")
      ->required();
  command->add_option("--lens", options->lens, "lens.json")->required()->type_name("FILE");
  command->add_option("--response", options->response, "response.json")->required()->type_name("FILE");
  command->add_option("--dark", options->dark, "Take with the lens capped: the fixed pattern from it")
      ->type_name("RECORDING");
  command
      ->add_option(
          "--turning", options->turned_deg,
          "The takes show one still scene instead, the camera lying on its side and turned to the right by "
          "these angles about the image's vertical: vignetting without an even scene")
      ->delimiter(',')
      ->type_name("DEG,DEG,...");
  command->add_option("--out", options->out, "flat.json to write")
      ->required()
      ->check(output_file())
      ->type_name("FILE");
  command->add_flag("--json", options->json, "The report as JSON on stdout");
  return {command, [options] { return run(*options); }};
}

}  // namespace lightwell::cli
