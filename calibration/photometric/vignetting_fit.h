// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "lighting/response.h"

// code = response(level · (1 + tilt · (x, y)) · T(θ)) + what the pixel adds, T = 1 + v1 θ² + v2 θ⁴ + v3 θ⁶.
namespace lightwell::calibration {

// A pixel of one take, wholly inside the field and not clipped.
struct EvenSample {
  std::size_t index = 0;  // of the pixel
  int column = 0, row = 0;
  int level = 0;  // take · colours + colour: all that share one brightness
  int take = 0;
  double theta2 = 0;    // rad²
  double x = 0, y = 0;  // from the centre to the edge, −1 … 1
  double code = 0;
};

struct VignettingFit {
  int levels = 0, takes = 0, terms = 0;
  Eigen::VectorXd p;           // levels (cd/m²), terms, then tilt x and y of each take
  Eigen::MatrixXd covariance;  // of p
  double scale = 0;            // robust standard deviation of the residuals, codes

  [[nodiscard]] double luminance(const EvenSample& s) const;  // that the model has for a sample
  [[nodiscard]] double residual(const EvenSample& s, const Response& response) const;
  // ∂code/∂p
  void gradient(const EvenSample& s, const Response& response, Eigen::VectorXd& row) const;
  [[nodiscard]] double tilt() const;  // the largest of the takes
};

// Gauss–Newton with Tukey's weights, which keep lamps, dust and dead pixels out.
// Fixed patterns go by columns and by rows, and are the same in every take: residuals are not independent. Their variance
// is split into that of columns, of rows and of what is a pixel's own, and the covariance of the parameters counts each
// as one draw a column, a row, a pixel. The terms of T are the fewest, up to three, beyond which none differs from 0 by
// more than chance allows: Wald's statistic against ln(lines) for each (Schwarz 1978, with lines for samples).
VignettingFit fit_vignetting(const std::vector<EvenSample>& samples, const Response& response, int levels,
                             int takes);

}  // namespace lightwell::calibration
