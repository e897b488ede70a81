// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/colour_fit.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "interface/csv_table.h"

namespace lightwell::calibration {
namespace {

constexpr std::size_t kFewestPatches = 4;  // three for the matrix, and one that checks
const Eigen::RowVector3d kLuminance(0.2126, 0.7152, 0.0722);

// IEC 61966-2-1, from the primaries' and D65's chromaticities.
Eigen::Matrix3d rec709_from_xyz() {
  Eigen::Matrix3d xyz_from_rec709;
  const std::array<std::array<double, 2>, 3> xy = {{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}}};
  for (std::size_t c = 0; c < 3; ++c)
    xyz_from_rec709.col(static_cast<Eigen::Index>(c)) =
        Eigen::Vector3d(xy[c][0], xy[c][1], 1 - xy[c][0] - xy[c][1]) / xy[c][1];
  const Eigen::Vector3d white(0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290);
  const Eigen::Vector3d scale = xyz_from_rec709.inverse() * white;
  return (xyz_from_rec709 * scale.asDiagonal()).inverse();
}

Result<Eigen::Vector3d> three(const CsvTable& table, std::size_t row,
                              const std::array<const char*, 3>& columns, double lowest, double highest,
                              const char* allowed) {
  Eigen::Vector3d out;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto value = table.number(row, columns[c], lowest, highest, allowed);
    if (!value) return value.error();
    out[static_cast<Eigen::Index>(c)] = *value;
  }
  return out;
}

Result<Eigen::Vector3d> camera_of(const CsvTable& table, std::size_t row, const Response& response,
                                  bool codes) {
  if (!codes)
    return three(table, row, {"camera_r", "camera_g", "camera_b"}, -1e9, 1e9, "a number from -1e9 to 1e9");
  auto value = three(table, row, {"code_r", "code_g", "code_b"}, 0, 65535, "a number from 0 to 65535");
  if (!value) return value;
  for (Eigen::Index c = 0; c < 3; ++c) {
    if ((*value)[c] >= response.clip_code)
      return Error{ErrorKind::bad_input, table.place(row) + ": code = " + std::to_string((*value)[c]) +
                                             " is clipped: allowed below " +
                                             std::to_string(response.clip_code)};
    (*value)[c] = response.luminance_cd_m2((*value)[c]);
  }
  return value;
}

std::size_t white_of(const std::vector<ColourPatch>& patches) {
  std::size_t best = 0;
  double least = 1e300;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    std::string name = patches[i].name.substr(0, 5);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
    if (name == "white") return i;
    const double y = kLuminance * patches[i].rec709;
    const double colourful = (patches[i].rec709.maxCoeff() - patches[i].rec709.minCoeff()) / y;
    // A patch twice as bright may be 2 % more colourful.
    const double cost = colourful - 0.02 * std::log2(y);
    if (cost < least) least = cost, best = i;
  }
  return best;
}

constexpr double kMostGain = 10;     // between the chart's cd/m² and the response's
constexpr double kMostError = 0.25;  // of the luminance; charts seen by RGB sensors leave 2 to 10 %

double luminance_of(const Eigen::Vector3d& rec709) {
  return kLuminance * rec709;
}

Eigen::Vector3d error_of(const Eigen::Matrix3d& matrix, const ColourPatch& p) {
  return (matrix * p.camera - p.rec709) / luminance_of(p.rec709);
}

double rms_error(const Eigen::Matrix3d& matrix, const std::vector<ColourPatch>& patches) {
  double square = 0;
  for (const ColourPatch& p : patches) square += error_of(matrix, p).squaredNorm();
  return std::sqrt(square / static_cast<double>(3 * patches.size()));
}

// Each row of the matrix: normal equations with the white patch as a Lagrange condition.
Result<Eigen::Matrix3d> solve_matrix(const std::vector<ColourPatch>& patches, const ColourPatch& white,
                                     const std::string& name) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, name + ": " + what}; };
  const auto n = static_cast<Eigen::Index>(patches.size());
  Eigen::MatrixXd camera(n, 3), target(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ColourPatch& p = patches[static_cast<std::size_t>(i)];
    const double y = kLuminance * p.rec709;
    camera.row(i) = p.camera.transpose() / y;
    target.row(i) = p.rec709.transpose() / y;
  }
  const Eigen::VectorXd sizes = camera.jacobiSvd().singularValues();
  if (!(sizes[2] > 1e-4 * sizes[0]))
    return bad("the camera's colours lie in a plane: allowed patches of red, green and blue beside grey");
  Eigen::Matrix4d kkt = Eigen::Matrix4d::Zero();
  kkt.topLeftCorner<3, 3>() = camera.transpose() * camera;
  const double scale = kkt(0, 0) / white.camera.norm();
  kkt.topRightCorner<3, 1>() = scale * white.camera;
  kkt.bottomLeftCorner<1, 3>() = scale * white.camera.transpose();
  const Eigen::FullPivLU<Eigen::Matrix4d> solver(kkt);
  Eigen::Matrix3d out;
  for (Eigen::Index r = 0; r < 3; ++r) {
    Eigen::Vector4d right;
    right << camera.transpose() * target.col(r), scale * white.rec709[r];
    out.row(r) = solver.solve(right).head<3>().transpose();
  }
  if (!(out.cwiseAbs().maxCoeff() < 1e3))
    return bad(
        "the matrix has coefficients above 1000: allowed patches whose colours the camera tells apart");
  return out;
}

// The one patch without which the others agree: their error falls below a third. The white one stays.
std::optional<std::size_t> contradicting(const std::vector<ColourPatch>& patches, const ColourPatch& white,
                                         double rms) {
  constexpr double kAgree = 1.0 / 3;
  constexpr double kAnyway = 0.02;  // what a good chart and camera leave: nothing is wrong there
  if (patches.size() <= kFewestPatches + 1 || rms < kAnyway) return {};
  std::optional<std::size_t> out;
  double least = kAgree * rms;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (patches[i].name == white.name) continue;
    std::vector<ColourPatch> others = patches;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const auto matrix = solve_matrix(others, white, "");
    if (!matrix) continue;
    if (const double left = rms_error(*matrix, others); left < least) least = left, out = i;
  }
  return out;
}

}  // namespace

Result<std::vector<ColourPatch>> read_chart(const std::filesystem::path& file, const Response& response) {
  const auto table = CsvTable::read(file);
  if (!table) return table.error();
  const bool codes = table->has("code_r"), xyz = table->has("X");
  if (const Status status = codes ? table->require({"code_r", "code_g", "code_b"})
                                  : table->require({"camera_r", "camera_g", "camera_b"});
      !status)
    return status.error();
  if (const Status status =
          xyz ? table->require({"X", "Y", "Z"}) : table->require({"rec709_r", "rec709_g", "rec709_b"});
      !status)
    return status.error();
  std::vector<ColourPatch> patches;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto camera = camera_of(*table, row, response, codes);
    if (!camera) return camera.error();
    const auto target = xyz ? three(*table, row, {"X", "Y", "Z"}, 0, 1e9, "a number from 0 to 1e9")
                            : three(*table, row, {"rec709_r", "rec709_g", "rec709_b"}, -1e9, 1e9,
                                    "a number from -1e9 to 1e9");
    if (!target) return target.error();
    ColourPatch patch{table->text(row, "name"), *camera,
                      xyz ? Eigen::Vector3d(rec709_from_xyz() * *target) : *target, false};
    if (patch.name.empty()) patch.name = "line " + std::to_string(table->line(row));
    if (!(kLuminance * patch.rec709 > 0))
      return Error{ErrorKind::bad_input, table->place(row) + ": luminance = " +
                                             std::to_string(kLuminance * patch.rec709) + ": allowed above 0"};
    const std::string use = table->text(row, "use");
    if (!use.empty() && use != "fit" && use != "check")
      return Error{ErrorKind::bad_input,
                   table->place(row) + ": use = " + use.substr(0, 40) + ": allowed fit, check"};
    patch.check = use == "check";
    patches.push_back(std::move(patch));
  }
  return patches;
}

Result<ColourFit> fit_colour(const std::vector<ColourPatch>& all, const std::string& name) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, name + ": " + what}; };
  std::vector<ColourPatch> patches;
  std::copy_if(all.begin(), all.end(), std::back_inserter(patches),
               [](const ColourPatch& p) { return !p.check; });
  if (patches.size() < kFewestPatches)
    return bad("number of patches to fit = " + std::to_string(patches.size()) +
               ": allowed at least 4; a chart has 24");
  const ColourPatch white = patches[white_of(patches)];
  const double gain = luminance_of(white.rec709) / luminance_of(white.camera);
  if (!(gain > 1 / kMostGain && gain < kMostGain))
    return bad("luminance of " + white.name + " = " + std::to_string(luminance_of(white.rec709)) +
               " cd/m2 where the camera's response says " + std::to_string(luminance_of(white.camera)) +
               ": allowed within a factor of " + std::to_string(static_cast<int>(kMostGain)));
  auto matrix = solve_matrix(patches, white, name);
  if (!matrix) return matrix.error();
  ColourFit fit;
  if (const auto wrong = contradicting(patches, white, rms_error(*matrix, patches))) {
    fit.rejected = patches[*wrong].name;
    patches.erase(patches.begin() + static_cast<std::ptrdiff_t>(*wrong));
    matrix = solve_matrix(patches, white, name);
    if (!matrix) return matrix.error();
  }
  fit.rec709_from_camera = *matrix;
  fit.white = white.name;
  fit.rms_error = rms_error(*matrix, patches);
  if (!(fit.rms_error < kMostError))
    return bad("the colours fit no matrix, they are off by " + std::to_string(100 * fit.rms_error) +
               " % of their luminance: allowed below " + std::to_string(100 * kMostError).substr(0, 2) +
               " %; are the patches in the chart's order?");
  for (const ColourPatch& p : all) {
    const Eigen::Vector3d error = error_of(*matrix, p);
    fit.residuals.push_back({p.name, p.check, error, luminance_of(error)});
  }
  return fit;
}

nlohmann::ordered_json report_to_json(const ColourFit& fit) {
  nlohmann::ordered_json out = {
      {"schema", "lightwell.colour-fit/1"}, {"white", fit.white}, {"rms_error", fit.rms_error}};
  if (!fit.rejected.empty()) out["rejected"] = fit.rejected;
  for (Eigen::Index r = 0; r < 3; ++r)
    out["rec709_from_camera"].push_back(
        {fit.rec709_from_camera(r, 0), fit.rec709_from_camera(r, 1), fit.rec709_from_camera(r, 2)});
  for (const auto& p : fit.residuals)
    out["patches"].push_back({{"patch", p.name},
                              {"use", p.check ? "check" : "fit"},
                              {"error", {p.error[0], p.error[1], p.error[2]}},
                              {"luminance_error", p.luminance_error}});
  return out;
}

}  // namespace lightwell::calibration
