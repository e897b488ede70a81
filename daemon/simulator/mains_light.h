// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lightwell::simulator {

// Mean over [begin, end] of light that flickers about 1: 1 − depth cos(2πft).
double mean_of_cosine(double frequency_hz, double depth, double begin_s, double end_s);
// Mean over [begin, end] of light that is 1/duty for the first `duty` of every period, else 0.
double mean_of_pulses(double frequency_hz, double duty, double begin_s, double end_s);

}  // namespace lightwell::simulator
