// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "cli/command.h"
#include "lighting/temporal/fir_design.h"

namespace lightwell::cli {
namespace {

std::string_view name(FirPhase phase) {
  return phase == FirPhase::linear ? "linear" : "minimum";
}

void print_json(const FirSpecification& asked, FirPhase phase, const FirDesign& design) {
  const nlohmann::ordered_json json = {{"schema", "lightwell.filter/1"},
                                       {"rate_hz", asked.rate_hz},
                                       {"pass_hz", asked.pass_hz},
                                       {"stop_hz", asked.stop_hz},
                                       {"order", asked.order},
                                       {"phase", name(phase)},
                                       {"taps", design.taps},
                                       {"dc_gain", design.dc_gain},
                                       {"delay_frames", design.delay_frames},
                                       {"delay_ms", 1000 * design.delay_frames / asked.rate_hz},
                                       {"pass_ripple_db", design.pass_ripple_db},
                                       {"stop_attenuation_db", design.stop_attenuation_db}};
  std::printf("%s\n", json.dump(2).c_str());
}

void print_text(const FirSpecification& asked, const FirDesign& design) {
  std::printf("taps");
  for (const double tap : design.taps) std::printf(" %.7f", tap);
  std::printf("\nDC gain           %.9f\n", design.dc_gain);
  std::printf("delay             %.4g frames, %.2f ms\n", design.delay_frames,
              1000 * design.delay_frames / asked.rate_hz);
  std::printf("pass-band ripple  %.3f dB up to %g Hz\n", design.pass_ripple_db, asked.pass_hz);
  std::printf("stop band         %.2f dB down from %g Hz\n", design.stop_attenuation_db, asked.stop_hz);
}

}  // namespace

Command add_filter(CLI::App& app) {
  struct Options {
    FirSpecification specification;
    std::string phase = "linear";
    bool json = false;
  };
  const auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("filter", "Design the temporal filter of the lights (equiripple low-pass)");
  command->footer("Example: lightwell filter --rate 60 --pass 12 --stop 20 --order 16 --json");
  command->add_option("--rate", options->specification.rate_hz, "Frames a second, above 0 to 100000 Hz")
      ->required();
  command
      ->add_option("--pass", options->specification.pass_hz,
                   "Changes up to here pass, Hz, above 0 and below --stop")
      ->required();
  command
      ->add_option("--stop", options->specification.stop_hz,
                   "Changes from here on are suppressed, Hz, below half of --rate")
      ->required();
  command
      ->add_option("--order", options->specification.order,
                   "Taps less one, 1 to 128; the delay is half of it")
      ->required();
  command
      ->add_option("--phase", options->phase,
                   "linear: every frequency equally late; minimum: the same gains with the least delay")
      ->capture_default_str()
      ->type_name("PHASE");
  command->add_flag("--json", options->json, "Machine-readable result on stdout");
  return {command, [options] {
            if (options->phase != "linear" && options->phase != "minimum")
              return fail(usage("--phase is " + options->phase + ", allowed: linear, minimum"));
            const FirPhase phase = options->phase == "linear" ? FirPhase::linear : FirPhase::minimum;
            const auto design = design_fir(options->specification, phase);
            if (!design) return fail(design.error());
            if (options->json)
              print_json(options->specification, phase, *design);
            else
              print_text(options->specification, *design);
            return 0;
          }};
}

}  // namespace lightwell::cli
