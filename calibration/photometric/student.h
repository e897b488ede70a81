// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lightwell::calibration {

// P(T ≤ t) of Student's distribution, and the t for which P(|T| ≤ t) = probability; to 1e-9. degrees ≥ 1, probability
// in (0, 1).
double student_cdf(double t, double degrees);
double student_two_sided(double probability, double degrees);

}  // namespace lightwell::calibration
