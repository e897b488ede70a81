// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include "cli/gravity_option.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/lens_json.h"
#include "interface/option_range.h"

namespace lightwell::cli {
namespace {

struct OrientOptions {
  std::string lens, gravity, out;
  bool json = false;
};

int run(const OrientOptions& o) {
  auto lens = read_lens(o.lens);
  if (!lens) return fail(lens.error());
  const auto zenith = zenith_of_option(o.gravity);
  if (!zenith) return fail(zenith.error());
  lens->zenith = *zenith;
  // All that stands in the file stays: what its calibration says of it is true of it still.
  const auto text = read_text_file(o.lens);
  if (!text) return fail(text.error());
  auto file = parse_json(*text, o.lens);
  if (!file) return fail(file.error());
  file->erase("zenith");
  file->update(lens_to_json(*lens));
  if (const Status status = write_file_atomically(o.out, file->dump() + "\n"); !status)
    return fail(status.error());
  const double tilt_deg = std::atan2(zenith->head<2>().norm(), zenith->z()) * 180 / kPi;
  if (o.json)
    std::printf("%s\n",
                nlohmann::json{{"zenith", {zenith->x(), zenith->y(), zenith->z()}}, {"tilt_deg", tilt_deg}}
                    .dump()
                    .c_str());
  else
    std::printf("tilt              %.2f degrees\nwritten           %s\n", tilt_deg, o.out.c_str());
  return 0;
}

}  // namespace

Command add_calibrate_orient(CLI::App& calibrate) {
  const auto o = std::make_shared<OrientOptions>();
  CLI::App* command =
      calibrate.add_subcommand("orient", "Tell a calibrated lens how the camera is tilted, from gravity");
  command->footer("Example: lightwell calibrate orient lens.json --gravity 0.12,-0.31,9.79 --out lens.json");
  command->add_option("lens", o->lens, "lens.json of the camera")->required();
  command->add_option("--gravity", o->gravity, kGravityHelp)->required();
  command->add_option("--out", o->out, "The lens with its zenith, JSON; may be the same file")
      ->required()
      ->check(output_file());
  command->add_flag("--json", o->json, "Zenith and tilt on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
