// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibration/detection/picture_views.h"
#include "calibration/lens/lens_calibration.h"
#include "calibration/lens/lens_report.h"
#include "cli/gravity_option.h"
#include "cli/progress.h"
#include "interface/atomic_file.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct LensOptions {
  std::vector<std::string> pictures;
  std::string board;
  std::optional<double> marker_mm;  // none: the board's usual one
  std::string corners;
  std::string corners_out;
  std::string target;        // exact, printed; empty: printed in pictures, exact in CORNERS.json
  double max_theta_deg = 0;  // 0: to the farthest point that counts
  std::string gravity;
  std::string out;
  bool json = false;
};

std::string in_words(const calibration::TargetShape& shape) {
  char text[128];
  std::snprintf(text, sizeof text,
                "stretched by %.2f mm, sheared by %.2f mm, bent by up to %.2f mm on half its width",
                shape.change_mm[0], shape.change_mm[1], shape.change_mm.tail<3>().cwiseAbs().maxCoeff());
  return text;
}

void print_text(const calibration::LensCalibration& c, const calibration::TargetViews& target_views,
                const std::string& out) {
  std::size_t used = 0;
  for (const calibration::ViewResult& view : c.views) {
    used += view.used;
    if (!view.used) std::printf("not used: %s: %s\n", view.name.c_str(), view.reason.c_str());
  }
  std::printf("views             %zu of %zu\n", used, c.views.size());
  std::printf("focal             %.3f %.3f px a radian\n", c.lens.focal.x(), c.lens.focal.y());
  std::printf("center            %.3f %.3f\n", c.lens.center.x(), c.lens.center.y());
  std::printf("k                ");
  for (int i = 0; i < c.freedom.coefficients; ++i)
    std::printf(" %.6f", c.lens.k[static_cast<std::size_t>(i)]);
  std::printf("\nerror             %.3f px rms, ", c.rms_px);
  if (std::isfinite(c.held_out_rms_px))
    std::printf("%.3f px on views held out\n", c.held_out_rms_px);
  else
    std::printf("too few views to hold some out\n");
  if (c.shape) std::printf("board             %s\n", in_words(*c.shape).c_str());
  std::printf("field             to %.1f degrees off axis", c.lens.max_theta_rad * 180 / kPi);
  if (c.lens.max_theta_rad > c.supported_theta_rad)
    std::printf(", extrapolated beyond %.1f", c.supported_theta_rad * 180 / kPi);
  std::printf("\n");
  if (const std::string gaps = calibration::coverage_gaps(c, target_views); !gaps.empty())
    std::printf("no points         %s\n", gaps.c_str());
  std::printf("written           %s\n", out.c_str());
}

struct Input {
  calibration::PictureViews views;
  std::string name;  // for messages
};

Result<calibration::Board> board_of(const LensOptions& options) {
  auto board = calibration::board_from_text(options.board);
  if (!board || !options.marker_mm) return board;
  if (board->kind == calibration::BoardKind::chessboard)
    return usage("--marker goes with a charuco or aprilgrid board, --board is " + options.board);
  if (!(*options.marker_mm > 0 && *options.marker_mm < board->pitch_mm))
    return usage("--marker is " + std::to_string(*options.marker_mm) +
                 ", allowed above 0, below the pitch of " + std::to_string(board->pitch_mm) + " mm");
  board->marker_mm = *options.marker_mm;
  return board;
}

Result<Input> read_input(const LensOptions& options) {
  const bool pictures = !options.pictures.empty();
  if (pictures == !options.corners.empty())
    return usage(pictures ? "pictures and --corners cannot be given together"
                          : "pictures with --board, or --corners, are required");
  if (!pictures) {
    if (!options.board.empty()) return usage("--board goes with pictures, not with --corners");
    if (options.marker_mm) return usage("--marker goes with pictures, not with --corners");
    auto views = calibration::read_target_views(options.corners);
    if (!views) return views.error();
    return Input{{*std::move(views), {}}, options.corners + ": "};
  }
  if (options.board.empty()) return usage("--board is required with pictures");
  const auto board = board_of(options);
  if (!board) return board.error();
  Progress progress(options.pictures.size());
  auto views =
      calibration::views_of_pictures(options.pictures, *board, [&](std::size_t n) { progress.done(n); });
  if (!views) return views.error();
  return Input{*std::move(views), ""};
}

// Two outputs of one name overwrite each other; one that is an input loses it.
Status check_outputs(const LensOptions& options) {
  if (!options.corners_out.empty() && options.corners_out == options.out)
    return usage("--corners-out and --out name one file, " + options.out + ", allowed two");
  for (const std::string& output : {options.out, options.corners_out}) {
    if (const Status other = check_output_is_no_input(output, {options.corners}); !other) return other;
    for (const auto& picture : options.pictures)
      if (const Status other = check_output_is_no_input(output, {picture}); !other) return other;
  }
  return {};
}

// Both files or neither: nothing is renamed into place before both are written.
Status write(const LensOptions& options, const std::string& lens,
             const calibration::TargetViews& target_views) {
  auto out = AtomicFileWriter::create(options.out);
  if (!out) return out.error();
  if (Status status = out->append(lens + "\n"); !status) return status;
  if (options.corners_out.empty()) return out->commit();
  auto corners = AtomicFileWriter::create(options.corners_out);
  if (!corners) return corners.error();
  if (Status status = corners->append(calibration::to_json(target_views)); !status) return status;
  if (Status status = corners->commit(); !status) return status;
  return out->commit();
}

bool is_exact(const LensOptions& options) {
  return options.target.empty() ? options.pictures.empty() : options.target == "exact";
}

int run(const LensOptions& options) {
  if (const Status outputs = check_outputs(options); !outputs) return fail(outputs.error());
  const auto zenith =
      options.gravity.empty() ? Result<Vec3d>(Lens{}.zenith) : zenith_of_option(options.gravity);
  if (!zenith) return fail(zenith.error());
  const auto input = read_input(options);
  if (!input) return fail(input.error());
  const calibration::TargetViews& target_views = input->views.target_views;
  auto solved = calibration::calibrate_lens(
      target_views, is_exact(options) ? calibration::TargetTrust::exact : calibration::TargetTrust::printed);
  if (!solved) return fail({solved.error().kind, input->name + solved.error().message});
  for (std::size_t i = 0; i < input->views.reasons.size(); ++i)
    if (!input->views.reasons[i].empty()) solved->views[i].reason = input->views.reasons[i];
  solved->lens.zenith = *zenith;
  if (options.max_theta_deg > 0)
    if (const Status set = calibration::set_field(*solved, options.max_theta_deg * kPi / 180); !set)
      return fail(usage("--max-theta: " + set.error().message));
  // A picture's name may be no UTF-8: its bytes are then replaced.
  const std::string report = calibration::lens_report(*solved, target_views)
                                 .dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  if (const Status status = write(options, report, target_views); !status) return fail(status.error());
  if (solved->doubted_shape)
    std::fprintf(stderr,
                 "lightwell: the board is not as exact as --target exact says, it is %s: the lens is less "
                 "sure than it "
                 "says; --target printed takes that into account\n",
                 in_words(*solved->doubted_shape).c_str());
  for (const std::string& warning : calibration::lens_warnings(*solved))
    std::fprintf(stderr, "lightwell: %s\n", printable(warning).c_str());
  if (options.json)
    std::printf("%s\n", report.c_str());
  else
    print_text(*solved, target_views, options.out);
  return 0;
}

}  // namespace

Command add_calibrate_lens(CLI::App& calibrate) {
  const auto o = std::make_shared<LensOptions>();
  CLI::App* command = calibrate.add_subcommand(
      "lens", "Kannala-Brandt lens, to 180 degrees and beyond, from views of a board");
  command->footer("Example: lightwell calibrate lens board_*.png --board 9x6:30 --out lens.json");
  command->add_option("pictures", o->pictures, "Pictures of the board, JPEG or PNG, all from one camera");
  command->add_option(
      "--board", o->board,
      "COLSxROWS:PITCH_MM[:chessboard|charuco|aprilgrid]: inner corners of a chessboard (the default), "
      "squares of a ChArUco board, tags of an AprilGrid; pitch from one to the next");
  command->add_option("--marker", o->marker_mm,
                      "Side of a marker, mm; else 3/4 of the pitch (charuco), pitch / 1.3 (aprilgrid)");
  command->add_option(
      "--corners", o->corners,
      "Points of the target and their pixels: {\"image_size\": [w, h], \"views\": [{\"name\": .., "
      "\"points\": [[X, Y, Z, u, v], ..]}]}, mm and pixels");
  command
      ->add_option(
          "--target", o->target,
          "exact: the points are where they are said to be; printed: the board's stretch, shear and bow are "
          "found too; else printed with pictures, exact with --corners")
      ->check(CLI::IsMember({"exact", "printed"}));
  command->add_option("--corners-out", o->corners_out, "What was found in the pictures, as for --corners")
      ->check(output_file());
  command
      ->add_option("--max-theta", o->max_theta_deg,
                   "Where the field ends, degrees off axis; else at the farthest point of the board. Beyond "
                   "that point the lens is extrapolated, and the file says so")
      ->check(numbers_above_0_to(180, "above 0, at most 180 degrees"));
  command->add_option("--gravity", o->gravity, kGravityHelp);
  command->add_option("--out", o->out, "The lens, with its uncertainty, JSON")
      ->required()
      ->check(output_file());
  command->add_flag("--json", o->json, "The same on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
