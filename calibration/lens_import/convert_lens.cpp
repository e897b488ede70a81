// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens_import/convert_lens.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "interface/lens_json.h"

namespace lightwell::calibration {
namespace {

constexpr int kSectors = 72;
constexpr int kRings = 200;
constexpr double kStep = kPi / 1440;  // of a search along an azimuth, an eighth of a degree

Vec3d direction_at(double theta, int sector) {
  const double phi = 2 * kPi * (sector + 0.5) / kSectors;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// Even–odd rule.
bool inside_outline(const std::vector<Vec2d>& outline, const Vec2d& p) {
  bool inside = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Vec2d &a = outline[i], &b = outline[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      inside = !inside;
  }
  return inside;
}

bool shows(const SourceLens& source, const Vec2d& pixel) {
  for (Eigen::Index i = 0; i < 2; ++i)
    if (!(pixel[i] >= -0.5 && pixel[i] <= source.image_size[static_cast<std::size_t>(i)] - 0.5)) return false;
  return source.valid_region.empty() || inside_outline(source.valid_region, pixel);
}

// Along one azimuth: up to which angle the source's pixels move away from its axis, and the last that it shows before
// it leaves the image; a model that comes back into it is outside its range.
struct Reach {
  double grows_rad = 0;
  double shows_rad = 0;
};
Reach reach_along(const SourceLens& source, const Vec2d& axis, int sector) {
  Reach reach;
  double distance = 0;
  bool left = false;
  for (double theta = kStep; theta <= kPi; theta += kStep) {
    const auto pixel = source.project(direction_at(theta, sector));
    if (!pixel || !((*pixel - axis).norm() > distance)) break;
    distance = (*pixel - axis).norm();
    reach.grows_rad = theta;
    if (left) continue;
    if (shows(source, *pixel))
      reach.shows_rad = theta;
    else
      left = reach.shows_rad > 0;
  }
  return reach;
}

struct Sample {
  Vec3d direction;
  Vec2d pixel;
  double weight = 0;
};

std::vector<Sample> samples_of(const SourceLens& source, const std::vector<Reach>& reach, double field) {
  std::vector<Sample> out;
  for (int sector = 0; sector < kSectors; ++sector)
    for (int ring = 1; ring <= kRings; ++ring) {
      const double theta = field * ring / kRings;  // the trapezoidal rule: the first is 0, the last half
      if (theta > reach[static_cast<std::size_t>(sector)].shows_rad + 1e-12) break;
      const Vec3d direction = direction_at(theta, sector);
      const auto pixel = source.project(direction);
      if (pixel && shows(source, *pixel))
        out.push_back({direction, *pixel, std::sin(theta) * (ring < kRings ? 1 : 0.5)});
    }
  return out;
}

// A lens, and how the camera it belongs to is turned against the source's.
struct Fit {
  Lens lens;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
};

double squared_error(const Fit& fit, const std::vector<Sample>& samples) {
  double sum = 0;
  for (const Sample& s : samples)
    sum += s.weight * (fit.lens.project(fit.turn * s.direction) - s.pixel).squaredNorm();
  return sum;
}

// By fx, fy, cx, cy, k1 …, and a small turn about x, y, z where it is free.
Eigen::MatrixXd by_unknowns(const LensJacobian& j, const Vec3d& d, int coefficients, bool turns) {
  Eigen::MatrixXd by(2, 4 + coefficients + (turns ? 3 : 0));
  by.leftCols(4 + coefficients) = j.dpixel_dlens.leftCols(4 + coefficients);
  if (turns)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      by.col(4 + coefficients + axis) = j.dpixel_ddirection * Vec3d::Unit(axis).cross(d);
  return by;
}

Fit moved(Fit fit, const Eigen::VectorXd& change, int coefficients, bool turns) {
  fit.lens.focal += change.head<2>();
  fit.lens.center += change.segment<2>(2);
  for (int i = 0; i < coefficients; ++i) fit.lens.k[static_cast<std::size_t>(i)] += change[4 + i];
  if (!turns) return fit;
  const Vec3d turn = change.tail<3>();
  if (const double angle = turn.norm(); angle > 0)
    fit.turn = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * fit.turn;
  return fit;
}

// Levenberg and Marquardt over focal, centre, the first coefficients, and the turn where it is free.
Fit fitted(Fit fit, const std::vector<Sample>& samples, int coefficients, bool turns) {
  const Eigen::Index n = 4 + coefficients + (turns ? 3 : 0);
  double error = squared_error(fit, samples);
  double damping = 1e-4;
  for (int step = 0; step < 100 && damping < 1e12; ++step) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
    for (const Sample& s : samples) {
      const Vec3d d = fit.turn * s.direction;
      const LensJacobian j = project_with_jacobian(fit.lens, d);
      const Eigen::MatrixXd by = by_unknowns(j, d, coefficients, turns);
      normal += s.weight * by.transpose() * by;
      slope += s.weight * by.transpose() * (j.pixel - s.pixel);
    }
    // To a unit diagonal first: pixels and ninth powers of an angle differ by decades.
    const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    normal = (scale.asDiagonal() * normal * scale.asDiagonal()).eval();
    normal.diagonal().array() += damping;
    const Eigen::VectorXd change = -scale.cwiseProduct(normal.ldlt().solve(scale.cwiseProduct(slope)));
    const Fit next = moved(fit, change, coefficients, turns);
    const double next_error = squared_error(next, samples);
    if (!(next_error < error)) {
      damping *= 10;
      continue;
    }
    const bool done = error - next_error < 1e-12 * error;
    fit = next;
    error = next_error;
    damping = std::max(damping / 10, 1e-15);
    if (done) break;
  }
  return fit;
}

// The farthest angle off the fit's own axis that the samples reach.
double reach_of(const Fit& fit, const std::vector<Sample>& samples) {
  double farthest = 0;
  for (const Sample& s : samples) {
    const Vec3d d = fit.turn * s.direction;
    farthest = std::max(farthest, std::atan2(d.head<2>().norm(), d.z()));
  }
  return std::min(farthest, kPi);
}

// How far the lens is held by what the source shows: a search's step more is no extrapolation.
double supported_by(const Fit& fit, const std::vector<Sample>& samples, const std::vector<Reach>& reach) {
  double shown = 0;
  for (const Reach& r : reach) shown = std::max(shown, r.shows_rad);
  if (!fit.turn.isIdentity(0)) shown = reach_of(fit, samples);
  return shown + kStep < fit.lens.max_theta_rad ? shown : fit.lens.max_theta_rad;
}

// Where a fit begins: the axis and the scale around it.
Lens start_of(const SourceLens& source, const Vec2d& axis) {
  Lens lens;
  lens.image_size = source.image_size;
  lens.center = axis;
  constexpr double kSmall = 1e-3;
  const auto x = source.project({std::sin(kSmall), 0, std::cos(kSmall)});
  const auto y = source.project({0, std::sin(kSmall), std::cos(kSmall)});
  if (x && y) lens.focal = {(*x - axis).norm() / kSmall, (*y - axis).norm() / kSmall};
  return lens;
}

ConversionError error_of(const Fit& fit, const std::vector<Sample>& samples) {
  ConversionError e;
  e.directions = samples.size();
  double weight = 0, px2 = 0, deg2 = 0;
  for (const Sample& s : samples) {
    const Vec3d d = fit.turn * s.direction;
    const double px = (fit.lens.project(d) - s.pixel).norm();
    const Vec3d ours = fit.lens.unproject(s.pixel);
    const double deg = std::atan2(ours.cross(d).norm(), ours.dot(d)) * 180 / kPi;
    weight += s.weight;
    px2 += s.weight * px * px;
    deg2 += s.weight * deg * deg;
    e.max_deg = std::max(e.max_deg, deg);
    if (px < e.max_px) continue;
    e.max_px = px;
    e.max_at_deg = std::atan2(d.head<2>().norm(), d.z()) * 180 / kPi;
  }
  e.rms_px = std::sqrt(px2 / weight);
  e.rms_deg = std::sqrt(deg2 / weight);
  return e;
}

std::string degrees(double rad) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", rad * 180 / kPi);
  return text;
}

// The field in question: as asked, or what the source shows.
Result<double> field_of(const std::vector<Reach>& reach, std::optional<double> asked) {
  double farthest = 0, grows = 0;
  for (const Reach& r : reach) {
    farthest = std::max(farthest, r.shows_rad);
    grows = std::max(grows, r.grows_rad);
  }
  if (!(farthest > 0)) return Error{ErrorKind::bad_input, "the model shows no direction inside its image"};
  if (!asked) return farthest;
  if (*asked > grows)
    return Error{ErrorKind::usage, "--max-theta is " + degrees(*asked) + " degrees, allowed at most " +
                                       degrees(grows) +
                                       ": beyond it the file's own projection stops growing"};
  return *asked;
}

// The best fit that keeps growing over its field, and with how many coefficients.
Status fit_lens(const SourceLens& source, const Vec2d& axis, const std::vector<Sample>& samples,
                std::optional<double> asked_rad, Fit& fit, int& coefficients) {
  Status good;
  for (coefficients = 4; coefficients >= 0; --coefficients) {
    fit = fitted({start_of(source, axis), Eigen::Matrix3d::Identity()}, samples, coefficients, false);
    const Fit turned = fitted(fit, samples, coefficients, true);
    constexpr double kHalved = 0.25;  // of squares
    if (squared_error(turned, samples) < kHalved * squared_error(fit, samples)) fit = turned;
    fit.lens.max_theta_rad = asked_rad ? *asked_rad : reach_of(fit, samples);
    good = check(fit.lens);
    if (good) break;
  }
  return good;
}

}  // namespace

Result<LensConversion> convert_lens(const SourceLens& source, std::optional<double> max_theta_rad) {
  const auto axis = source.project({0, 0, 1});
  if (!axis || !axis->allFinite()) return Error{ErrorKind::bad_input, "the model does not see its own axis"};
  const auto& [width, height] = source.image_size;
  if (axis->x() < 0 || axis->y() < 0 || axis->x() > width - 1 || axis->y() > height - 1) {
    char text[160];
    std::snprintf(
        text, sizeof text,
        "the centre (%.1f, %.1f) lies outside the image of %dx%d pixels: was the lens calibrated at another "
        "size?",
        axis->x(), axis->y(), width, height);
    return Error{ErrorKind::bad_input, text};
  }
  std::vector<Reach> reach;
  for (int sector = 0; sector < kSectors; ++sector) reach.push_back(reach_along(source, *axis, sector));
  const auto field = field_of(reach, max_theta_rad);
  if (!field) return field.error();
  LensConversion out;
  out.exact = source.same.has_value();
  if (out.exact) {
    out.lens = *source.same;
    const double limit = increasing_to_rad(out.lens);
    if (max_theta_rad && *field > limit)
      return Error{ErrorKind::usage, "--max-theta is " + degrees(*field) + " degrees, allowed at most " +
                                         degrees(limit) + ": beyond it the projection stops growing"};
    out.lens.max_theta_rad = std::min(*field, limit);
  }
  const std::vector<Sample> samples = samples_of(source, reach, out.exact ? out.lens.max_theta_rad : *field);
  if (samples.size() < 100)
    return Error{ErrorKind::bad_input,
                 "the image shows next to nothing of the field of " + degrees(*field) + " degrees"};
  Fit fit{out.lens, Eigen::Matrix3d::Identity()};
  Status good = check(fit.lens);
  if (!out.exact) good = fit_lens(source, *axis, samples, max_theta_rad, fit, out.coefficients);
  if (!good) return Error{ErrorKind::bad_input, "no Kannala-Brandt lens follows it: " + good.error().message};
  out.lens = fit.lens;
  if (!fit.turn.isIdentity(0)) {
    const Eigen::AngleAxisd turn(fit.turn);
    out.turn = turn.angle() * turn.axis();
  }
  out.supported_theta_rad = supported_by(fit, samples, reach);
  out.error = error_of(fit, samples);
  return out;
}

Vec3d turned(const LensConversion& conversion, const Vec3d& direction) {
  const double angle = conversion.turn.norm();
  return angle > 0 ? Vec3d(Eigen::AngleAxisd(angle, conversion.turn / angle) * direction) : direction;
}

nlohmann::ordered_json import_report(const SourceLens& source, const LensConversion& conversion) {
  const nlohmann::json lens = lens_to_json(conversion.lens);
  nlohmann::ordered_json out;
  for (const char* key : {"schema", "model", "image_size", "focal", "center", "k", "max_theta_deg"})
    out[key] = lens.at(key);
  out["supported_theta_deg"] = conversion.supported_theta_rad * 180 / kPi;
  if (lens.contains("zenith")) out["zenith"] = lens.at("zenith");
  const ConversionError& e = conversion.error;
  out["imported"] = {{"format", std::string(name(source.format))},
                     {"model", source.model},
                     {"exact", conversion.exact},
                     {"coefficients", conversion.coefficients},
                     {"turn_rad", {conversion.turn.x(), conversion.turn.y(), conversion.turn.z()}},
                     {"weighting", "solid angle"},
                     {"directions", e.directions},
                     {"rms_px", e.rms_px},
                     {"max_px", e.max_px},
                     {"rms_deg", e.rms_deg},
                     {"max_deg", e.max_deg},
                     {"max_at_deg", e.max_at_deg}};
  if (source.assumed) out["imported"]["assumed"] = source.model;
  return out;
}

}  // namespace lightwell::calibration
