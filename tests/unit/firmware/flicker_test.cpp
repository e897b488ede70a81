// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/flicker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "firmware/core/flicker_advice.h"
#include "firmware/core/real.h"

namespace {

constexpr double kSampleHz = 8000;
constexpr double kTurn = 2 * std::numbers::pi;

TEST(Real, SineCosineSincAndRootAreThoseOfTheLibrary) {
  for (double turns = -20; turns < 20; turns += 0.00371) {
    const auto given = static_cast<float>(turns);
    float sine, cosine;
    turn_sine_cosine(given, &sine, &cosine);
    EXPECT_NEAR(sine, std::sin(kTurn * static_cast<double>(given)),
                4e-7);  // a float's rounding and the argument's
    EXPECT_NEAR(cosine, std::cos(kTurn * static_cast<double>(given)), 4e-7);
  }
  for (float x = -4; x < 4; x += 0.0137f)
    EXPECT_NEAR(normalized_sinc(x), std::sin(x * std::numbers::pi) / (x * std::numbers::pi), 4e-7);
  EXPECT_EQ(normalized_sinc(0), 1);
  EXPECT_EQ(real_root(-1), 0);
  EXPECT_FLOAT_EQ(real_root(2), std::sqrt(2.0f));
}

TEST(Fourier, IsTheSumThatDefinesIt) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(-1, 1);
  std::vector<float> values(FOURIER_SIZE);
  for (auto& value : values) value = uniform(random);
  const std::vector<float> samples = values;
  fourier_transform(values.data());
  for (int k = 0; k <= FOURIER_SIZE / 2; ++k) {
    std::complex<double> sum;
    for (int n = 0; n < FOURIER_SIZE; ++n)
      sum += static_cast<double>(samples[static_cast<std::size_t>(n)]) *
             std::polar(1.0, -kTurn * (n * k % FOURIER_SIZE) / 1024.0);
    const auto at = static_cast<std::size_t>(2 * k);
    const double tolerance = 2e-5;  // sqrt(1024) values of 1, ten stages of 6e-8
    if (k == 0) {
      EXPECT_NEAR(values[0], sum.real(), tolerance);
    } else if (k == FOURIER_SIZE / 2) {
      EXPECT_NEAR(values[1], sum.real(), tolerance);
    } else {
      EXPECT_NEAR(values[at], sum.real(), tolerance) << k;
      EXPECT_NEAR(values[at + 1], sum.imag(), tolerance) << k;
    }
  }
}

struct Tone {
  double hz, depth;
};

// 1.984 s of light of a mean code, with tones and white noise (relative to the mean), as a 12-bit converter sees it.
flicker_result measure(const std::vector<Tone>& tones, double noise, double mean = 1500, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<double> phases;
  for (std::size_t i = 0; i < tones.size(); ++i) phases.push_back(uniform(random));
  const auto meter = std::make_unique<flicker>();
  flicker_init(meter.get(), static_cast<float>(kSampleHz), 100, 4095);
  flicker_result result{};
  bool done = false;
  for (int n = 0; !done; ++n) {
    EXPECT_LE(n, static_cast<int>(2 * kSampleHz));  // a result within 2 s
    double light = 1 + noise * normal(random);
    for (std::size_t i = 0; i < tones.size(); ++i)
      light += tones[i].depth * std::cos(kTurn * (tones[i].hz * n / kSampleHz + phases[i]));
    done = flicker_sample(meter.get(),
                          static_cast<std::uint16_t>(std::clamp(std::lround(100 + mean * light), 0l, 4095l)),
                          &result);
  }
  return result;
}

TEST(Flicker, FrequencyWithinATenthOfAHertzAndDepthWithinATenthAtTwoPercentInNoise) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(80.5, 1999.5);
  std::vector<double> frequencies = {100,    120, 99.87, 120.13, 200,    250,
                                     488.28, 500, 976.6, 1000,   1999.4, 80.6};
  for (int i = 0; i < 60; ++i) frequencies.push_back(any(random));
  unsigned seed = 0;
  for (const double hz : frequencies) {
    const flicker_result found =
        measure({{hz, 0.02}}, 0.02, 1500, ++seed);  // noise as strong as the ripple's amplitude
    ASSERT_EQ(found.tones, 1u) << hz;
    EXPECT_NEAR(found.tone[0].hz, hz, 0.1);
    EXPECT_NEAR(found.tone[0].depth, 0.02, 0.002) << hz;
    EXPECT_NEAR(found.level, 1500, 1.5);  // noise of 30 codes over 16,000 samples: 0.24 rms
    EXPECT_FALSE(found.clipped);
  }
}

TEST(Flicker, LampsOnBothMainsAndALedBesideThemAreToldApart) {
  const flicker_result found = measure({{100.04, 0.3}, {119.9, 0.1}, {731.3, 0.05}}, 0.01);
  ASSERT_GE(found.tones, 3u);
  EXPECT_NEAR(found.tone[0].hz, 100.04, 0.1);
  EXPECT_NEAR(found.tone[1].hz, 119.9, 0.1);
  EXPECT_NEAR(found.tone[2].hz, 731.3, 0.1);
  EXPECT_NEAR(found.tone[0].depth, 0.3, 0.03);
  EXPECT_NEAR(found.tone[1].depth, 0.1, 0.01);
  EXPECT_NEAR(found.tone[2].depth, 0.05, 0.005);
}

// A dimmed LED: a rectangle, of which the input's filter passes the harmonics below 4 kHz.
TEST(Flicker, PulseWidthModulationIsNamedByItsOwnFrequency) {
  for (const double hz : {200.0, 317.7, 610.35, 1000.2, 1953.1})
    for (const double duty : {0.1, 0.5, 0.9}) {
      std::vector<Tone> tones;
      const double strength = 0.1;  // the LED's part of the light
      for (int k = 1; k * hz < 4000; ++k)
        tones.push_back({k * hz, strength * 2 / (std::numbers::pi * k) *
                                     std::abs(std::sin(std::numbers::pi * k * duty))});
      const flicker_result found = measure(tones, 0.005);
      ASSERT_GE(found.tones, 1u);
      const auto own = std::find_if(found.tone, found.tone + found.tones, [&](const flicker_tone& tone) {
        return std::abs(static_cast<double>(tone.hz) - hz) < 0.1;
      });
      ASSERT_NE(own, found.tone + found.tones) << hz << " " << duty;
      EXPECT_NEAR(own->depth, tones[0].depth, 0.1 * tones[0].depth) << hz << " " << duty;
    }
}

TEST(Flicker, NoiseAloneDarknessAndAConstantHaveNoFrequency) {
  for (unsigned seed = 0; seed < 40; ++seed) EXPECT_EQ(measure({}, 0.05, 1500, seed).tones, 0u);
  EXPECT_EQ(measure({}, 0).tones, 0u);
  const flicker_result dark = measure({{100, 0.5}}, 0, 0);
  EXPECT_EQ(dark.tones, 0u);
  EXPECT_EQ(dark.level, 0);
}

TEST(Flicker, AClippedConverterIsSaid) {
  EXPECT_TRUE(measure({{100, 0.5}}, 0, 3500).clipped);
}

// Frames of a camera under those tones for 20 s; the largest change of brightness within a second.
double simulated_beat(const std::vector<Tone>& tones, double rate, double exposure) {
  std::vector<double> frames;
  for (int n = 0; n < static_cast<int>(20 * rate); ++n) {
    double light = 1;
    for (const Tone& tone : tones) {
      // The mean of cos over the exposure, integrated exactly.
      const double a = kTurn * tone.hz * n / rate, b = a + kTurn * tone.hz * exposure;
      light += tone.depth * (std::sin(b) - std::sin(a)) / (b - a);
    }
    frames.push_back(light);
  }
  const auto second = static_cast<std::size_t>(rate);
  double most = 0;
  for (std::size_t i = 0; i + second < frames.size(); i += second / 4) {
    const auto [low, high] = std::minmax_element(frames.begin() + static_cast<std::ptrdiff_t>(i),
                                                 frames.begin() + static_cast<std::ptrdiff_t>(i + second));
    most = std::max(most, *high - *low);
  }
  return most;
}

TEST(FlickerAdvice, WhatIsAdvisedDoesNotBeat) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> led(200, 2000), mains(-0.15, 0.15), depth(0.02, 0.4);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Tone> tones = {{(trial % 2 == 0 ? 100 : 120) + mains(random), depth(random)}};
    if (trial % 3 == 0) tones.push_back({led(random), depth(random)});
    const flicker_result found = measure(tones, 0.01, 1500, static_cast<unsigned>(trial));
    for (const double rate : {24.0, 25.0, 50.0, 60.0}) {
      const double exposure = 0.6 / rate;
      const flicker_advice advice =
          flicker_advise(&found, static_cast<float>(rate), static_cast<float>(exposure));
      EXPECT_LE(static_cast<double>(advice.rate_hz), rate * 1.000001);
      EXPECT_LE(static_cast<double>(advice.exposure_s * advice.rate_hz), 0.9001);
      const double before = simulated_beat(tones, rate, exposure);
      const double after =
          simulated_beat(tones, static_cast<double>(advice.rate_hz), static_cast<double>(advice.exposure_s));
      EXPECT_LE(after, std::max(before, 0.003));
      // One lamp alone is removed but for the errors of its measured frequency: 0.02 Hz of 100, ten ripples an exposure,
      // leave 2 · depth · 0.002. Two at once share one exposure and one rate.
      EXPECT_LE(after, tones.size() == 1 ? 0.004 : 0.05) << rate << " " << tones[0].hz;
    }
  }
}

TEST(FlickerAdvice, AShortExposureIsKeptByChoosingTheRate) {
  const flicker_result light{1000, false, 1, {{100, 0.3f}}};
  const flicker_advice advice = flicker_advise(&light, 60, 0.0005f);
  EXPECT_NEAR(advice.rate_hz, 50, 1e-3);
  EXPECT_LE(advice.exposure_s, 0.002f);
}

TEST(FlickerAdvice, SettingsThatDoNotBeatAreLeftAlone) {
  const flicker_result steady{1000, false, 0, {}};
  flicker_advice advice = flicker_advise(&steady, 60, 0.004f);
  EXPECT_EQ(advice.rate_hz, 60);
  EXPECT_EQ(advice.exposure_s, 0.004f);
  EXPECT_EQ(advice.beat, 0);
  const flicker_result mains{1000, false, 1, {{120, 0.3f}}};
  advice = flicker_advise(&mains, 60, 1.0f / 120);
  EXPECT_EQ(advice.rate_hz, 60);
  EXPECT_NEAR(advice.exposure_s, 1.0 / 120, 1e-9);
}

}  // namespace
