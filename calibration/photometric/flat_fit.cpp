// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/flat_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "interface/flat_field_json.h"

namespace lightwell::calibration {
namespace {

constexpr double kMostTilt = 0.2;      // of the scene, from the centre to the edge
constexpr double kMostClipped = 0.01;  // of the pixels in the field
constexpr double kTukey = 4.685;       // 95 % efficient where the noise is normal

// A pixel wholly inside the field.
struct Sample {
  std::size_t index = 0;
  int colour = 0;
  double t = 0;         // θ²
  double x = 0, y = 0;  // from the centre to the edge, −1 … 1
  double code = 0;
};

Status check_input(const MeanFrame& even, const Lens& lens, const Response& response,
                   const std::string& name) {
  const auto bad = [&](const std::string& what) { return Error{ErrorKind::bad_input, name + ": " + what}; };
  if (even.format.width != lens.image_size[0] || even.format.height != lens.image_size[1])
    return bad("frames of " + std::to_string(even.format.width) + "x" + std::to_string(even.format.height) +
               ": allowed " + std::to_string(lens.image_size[0]) + "x" + std::to_string(lens.image_size[1]) +
               ", the lens's image_size");
  const int bits = significant_bits(even.format.pixel_format);
  if (bits != response.bits && !(bits == 16 && response.bits >= 10))
    return bad("codes of " + std::to_string(bits) + " bits: allowed " + std::to_string(response.bits) +
               ", the response's");
  if (even.frames < 2) return bad("number of frames = 1: allowed at least 2; a hundred are good");
  return {};
}

Result<std::vector<Sample>> samples_of(const MeanFrame& even, const std::optional<MeanFrame>& dark,
                                       const Lens& lens, const Response& response, const std::string& name) {
  std::vector<Sample> samples;
  std::size_t inside = 0;
  const double edge = lens.max_theta_rad - 1.5 / lens.focal.minCoeff();  // a pixel and a half inside
  const double dark_code = response.code(0);
  for (int y = 0; y < even.format.height; ++y)
    for (int x = 0; x < even.format.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(even.format.width) +
                            static_cast<std::size_t>(x);
      const double theta = lens.theta_rad(Vec2d(x, y));
      if (!(theta < edge)) continue;
      ++inside;
      double code = even.code[i];
      if (code <= 0.5 || code >= response.clip_code - 0.5) continue;
      if (dark) code -= dark->code[i] - dark_code;
      const Vec2d p = (Vec2d(x, y) - lens.center).cwiseQuotient(lens.focal) / lens.max_theta_rad;
      samples.push_back({i, colour_of(even.format, x, y), theta * theta, p.x(), p.y(), code});
    }
  if (samples.size() < 100 ||
      static_cast<double>(inside - samples.size()) > kMostClipped * static_cast<double>(inside))
    return Error{ErrorKind::bad_input,
                 name + ": " + std::to_string(inside - samples.size()) + " of " + std::to_string(inside) +
                     " pixels of the field are clipped: allowed 1 %; change the exposure"};
  return samples;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Levels of up to three colours, then the vignetting's terms, then the scene's tilt along x and y.
struct Fit {
  Eigen::VectorXd p;
  Eigen::MatrixXd covariance;
  double scale = 0;     // robust standard deviation of the residuals, codes
  double deviance = 0;  // n ln(Σ ρ), smaller is better
};

class Fitter {
 public:
  Fitter(const std::vector<Sample>& samples, const Response& response, int colours, int terms)
      : samples_(samples), response_(response), colours_(colours), terms_(terms) {}

  [[nodiscard]] Fit run() const {
    Fit fit;
    fit.p = start();
    for (int round = 0; round < 30; ++round) {
      const Eigen::VectorXd before = fit.p;
      step(fit);
      if ((fit.p - before).cwiseQuotient(before.cwiseAbs().cwiseMax(1e-3)).cwiseAbs().maxCoeff() < 1e-9)
        break;
    }
    return fit;
  }
  [[nodiscard]] double residual(const Fit& fit, const Sample& s) const {
    return s.code - response_.code(fit.p[s.colour] * transmission(fit.p, s));
  }
  [[nodiscard]] int first_term() const { return colours_; }

 private:
  [[nodiscard]] Eigen::VectorXd start() const {
    Eigen::VectorXd p = Eigen::VectorXd::Zero(colours_ + terms_ + 2);
    for (int c = 0; c < colours_; ++c) {
      std::vector<double> codes;
      for (const Sample& s : samples_)
        if (s.colour == c) codes.push_back(s.code);
      p[c] = codes.empty() ? 1 : std::max(response_.luminance_cd_m2(median(std::move(codes))), 1e-9);
    }
    return p;
  }
  [[nodiscard]] double transmission(const Eigen::VectorXd& p, const Sample& s) const {
    double value = 1 + p[colours_ + terms_] * s.x + p[colours_ + terms_ + 1] * s.y;
    double power = s.t;
    for (int k = 0; k < terms_; ++k, power *= s.t) value += p[colours_ + k] * power;
    return std::max(value, 1e-3);
  }

  void step(Fit& fit) const {  // Gauss–Newton with Tukey's weights
    const Eigen::Index n = fit.p.size();
    std::vector<double> residuals, sizes;
    residuals.reserve(samples_.size());
    for (const Sample& s : samples_) {
      residuals.push_back(residual(fit, s));
      sizes.push_back(std::abs(residuals.back()));
    }
    fit.scale = std::max(1.4826 * median(std::move(sizes)), 1e-3);  // of a normal distribution
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n), row(n);
    double loss = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const double u = residuals[i] / (kTukey * fit.scale);
      loss += u * u < 1 ? 1 - std::pow(1 - u * u, 3) : 1;
      if (!(u * u < 1)) continue;
      const Sample& s = samples_[i];
      const double level = fit.p[s.colour], t = transmission(fit.p, s);
      const double slope = 1 / response_.dluminance_dcode(response_.code(level * t));
      row.setZero();
      row[s.colour] = slope * t;
      double power = s.t;
      for (int k = 0; k < terms_; ++k, power *= s.t) row[colours_ + k] = slope * level * power;
      row[colours_ + terms_] = slope * level * s.x;
      row[colours_ + terms_ + 1] = slope * level * s.y;
      const double weight = (1 - u * u) * (1 - u * u);
      information.noalias() += weight * row * row.transpose();
      gradient.noalias() += weight * residuals[i] * row;
    }
    const Eigen::LDLT<Eigen::MatrixXd> solver(information);
    fit.p += solver.solve(gradient);
    for (int c = 0; c < colours_; ++c) fit.p[c] = std::max(fit.p[c], 1e-12);
    fit.covariance = fit.scale * fit.scale * solver.solve(Eigen::MatrixXd::Identity(n, n));
    // Likelihood of normal residuals of which the outlying ones count as the farthest that are not.
    fit.deviance =
        static_cast<double>(samples_.size()) * std::log(std::max(loss * fit.scale * fit.scale, 1e-300));
  }

  const std::vector<Sample>& samples_;
  const Response& response_;
  int colours_, terms_;
};

}  // namespace

Result<FlatFit> fit_flat_field(const MeanFrame& even, const std::optional<MeanFrame>& dark, const Lens& lens,
                               const Response& response, const std::string& name) {
  if (const Status status = check_input(even, lens, response, name); !status) return status.error();
  if (dark)
    if (const Status status = check_input(*dark, lens, response, "dark frames"); !status)
      return status.error();
  const auto samples = samples_of(even, dark, lens, response, name);
  if (!samples) return samples.error();
  const int colours = is_bayer(even.format.pixel_format) ? 3 : 1;

  // The fewest terms: each further one has to pay ln n (Schwarz 1978).
  int terms = 1;
  Fit fit = Fitter(*samples, response, colours, 1).run();
  for (int more = 2; more <= 3; ++more) {
    Fit next = Fitter(*samples, response, colours, more).run();
    const double price = std::log(static_cast<double>(samples->size())) * (more - terms);
    if (next.deviance + price < fit.deviance) fit = std::move(next), terms = more;
  }

  FlatFit out;
  out.flat.image_size = lens.image_size;
  out.vignetting_terms = terms;
  out.pixels = samples->size();
  out.from_dark = dark.has_value();
  for (int c = 0; c < colours; ++c) out.level_cd_m2[static_cast<std::size_t>(c)] = fit.p[c];
  for (int k = 0; k < terms; ++k) out.flat.vignetting[static_cast<std::size_t>(k)] = fit.p[colours + k];
  out.covariance.topLeftCorner(terms, terms) = fit.covariance.block(colours, colours, terms, terms);
  out.tilt = std::hypot(fit.p[colours + terms], fit.p[colours + terms + 1]);
  if (!(out.tilt < kMostTilt))
    return Error{ErrorKind::bad_input, name + ": the scene changes by " + std::to_string(100 * out.tilt) +
                                           " % from the centre to the edge: allowed 20 %; light it evenly"};

  out.flat.offset_codes.assign(even.code.size(), 0);
  const MeanFrame& pattern = dark ? *dark : even;
  double square = 0, noise = 0;
  const Fitter fitter(*samples, response, colours, terms);
  if (dark)
    for (std::size_t i = 0; i < even.code.size(); ++i)
      out.flat.offset_codes[i] = static_cast<float>(dark->code[i] - response.code(0));
  for (const Sample& s : *samples) {
    if (!dark) out.flat.offset_codes[s.index] = static_cast<float>(fitter.residual(fit, s));
    square += std::pow(static_cast<double>(out.flat.offset_codes[s.index]), 2);
    noise += pattern.sigma[s.index] * pattern.sigma[s.index];
  }
  const auto n = static_cast<double>(samples->size());
  out.offset_rms_codes = std::sqrt(square / n);
  out.offset_sigma_codes = std::sqrt(noise / n / static_cast<double>(pattern.frames));
  if (const Status status = check(out.flat, lens); !status)
    return Error{status.error().kind, name + ": " + status.error().message};
  return out;
}

nlohmann::ordered_json report_to_json(const FlatFit& fit, const MeanFrame& even) {
  nlohmann::ordered_json out = {{"schema", "lightwell.flat-fit/1"},
                                {"vignetting", fit.flat.vignetting},
                                {"vignetting_terms", fit.vignetting_terms},
                                {"pixels", fit.pixels},
                                {"frames", even.frames},
                                {"exposure_us", even.exposure_us},
                                {"level_cd_m2", fit.level_cd_m2},
                                {"offset_from", fit.from_dark ? "dark frames" : "even frames"},
                                {"offset_rms_codes", fit.offset_rms_codes},
                                {"offset_sigma_codes", fit.offset_sigma_codes},
                                {"scene_tilt", fit.tilt}};
  out["temperature_c"] = even.temperature_c ? nlohmann::ordered_json(*even.temperature_c) : nullptr;
  for (Eigen::Index r = 0; r < 3; ++r)
    out["covariance"].push_back({fit.covariance(r, 0), fit.covariance(r, 1), fit.covariance(r, 2)});
  return out;
}

std::string flat_file(const FlatFit& fit, const MeanFrame& even) {
  nlohmann::json out = flat_field_to_json(fit.flat);
  out["fit"] = report_to_json(fit, even);
  return out.dump() + "\n";
}

}  // namespace lightwell::calibration
