// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The discrete Fourier transform of 1024 real samples, in their place.

#ifdef __cplusplus
extern "C" {
#endif

enum { FOURIER_SIZE = 1024 };

// values: samples in; out: values[0] the sum, values[1] the transform at half the sampling rate, then real and imaginary
// part of bins 1 to 511. X_k = sum x_n exp(-2 pi i k n / 1024).
void fourier_transform(float values[FOURIER_SIZE]);

#ifdef __cplusplus
}
#endif
