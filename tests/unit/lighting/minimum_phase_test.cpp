// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/temporal/minimum_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "lighting/temporal/fir_design.h"
#include "lighting/temporal/temporal_choice.h"
#include "lighting/vector.h"

namespace lightwell {
namespace {

TEST(MinimumPhase, TwoTapsAreTurnedSoThatTheLargerComesFirst) {
  const auto taps = minimum_phase(std::vector<double>{0.25, 0.75}).value();
  EXPECT_NEAR(taps[0], 0.75, 1e-12);  // rounding: the zero at −3 goes to −1/3
  EXPECT_NEAR(taps[1], 0.25, 1e-12);
}

TEST(MinimumPhase, KeepsEveryGainAndTheConstant) {
  for (const int order : {1, 2, 3, 8, 9, 16, 31, 64})
    for (const double pass : {0.1, 0.2, 0.333}) {
      const FirSpecification asked{60, 60 * pass, 60 * (pass + 0.1), order};
      const FirDesign linear = design_fir(asked).value();
      const auto found = design_fir(asked, FirPhase::minimum);
      ASSERT_TRUE(found.ok()) << order << " " << pass << " " << found.error().message;
      EXPECT_NEAR(std::accumulate(found->taps.begin(), found->taps.end(), 0.0), 1, 1e-6);
      for (int i = 0; i <= 600; ++i)  // what minimum_phase promises
        ASSERT_NEAR(fir_gain(found->taps, i * 0.05, 60), fir_gain(linear.taps, i * 0.05, 60), 2.1e-6)
            << order << " " << pass;
      EXPECT_NEAR(found->pass_ripple_db, linear.pass_ripple_db, 1e-4);
    }
}

// Its defining property: of all filters with these gains none has sent more of its energy by any frame
// (Oppenheim and Schafer, section 5.6.3). The linear-phase one has these gains.
TEST(MinimumPhase, SendsItsEnergyEarliestAndDelaysLess) {
  for (const int order : {4, 8, 16, 32}) {
    const FirDesign linear = design_fir({60, 12, 20, order}).value();
    const FirDesign minimum = design_fir({60, 12, 20, order}, FirPhase::minimum).value();
    double of_linear = 0;
    double of_minimum = 0;
    for (std::size_t n = 0; n < linear.taps.size(); ++n) {
      of_linear += linear.taps[n] * linear.taps[n];
      of_minimum += minimum.taps[n] * minimum.taps[n];
      EXPECT_GE(of_minimum, of_linear - 1e-6) << order << " " << n;
    }
    EXPECT_LT(minimum.delay_frames, 0.6 * linear.delay_frames) << order;
    EXPECT_GE(minimum.delay_frames, 0) << order;
  }
}

TEST(MinimumPhase, NoDelayIsLeftToTakeTwice) {
  const auto once = minimum_phase(design_fir({60, 12, 20, 16}).value().taps).value();
  const auto twice = minimum_phase(once).value();
  for (std::size_t n = 0; n < once.size(); ++n) EXPECT_NEAR(twice[n], once[n], 1e-6);  // as promised
}

TEST(MinimumPhase, TapsOfZeroAtTheEndsAreDelay) {
  const auto taps = minimum_phase(std::vector<double>{0, 0, 0.25, 0.75, 0}).value();
  ASSERT_EQ(taps.size(), 5u);
  EXPECT_NEAR(taps[0], 0.75, 1e-12);
  EXPECT_NEAR(taps[1], 0.25, 1e-12);
  EXPECT_EQ(taps[4], 0);
}

TEST(TemporalChoice, NamesAreReadBack) {
  for (const TemporalChoice choice : kTemporalChoices)
    EXPECT_EQ(temporal_choice_from_name(name(choice)), choice);
  EXPECT_FALSE(temporal_choice_from_name("iir"));
  EXPECT_EQ(temporal_choice_names(), "best, fir, minimum-phase, one-frame, none");
}

TEST(TemporalChoice, TapsPassAConstantWithTheDelayTheyState) {
  for (const double rate : {21.0, 25.0, 60.0, 240.0}) {
    const auto delay = [&](TemporalChoice choice) {
      const auto taps = temporal_taps(choice, rate).value();
      EXPECT_NEAR(std::accumulate(taps.begin(), taps.end(), 0.0), 1, 1e-6);
      return delay_of_slow_changes(taps);
    };
    EXPECT_EQ(delay(TemporalChoice::none), 0);
    EXPECT_NEAR(delay(TemporalChoice::one_frame), 1, 1e-12);  // rounding
    EXPECT_NEAR(delay(TemporalChoice::fir), 4, 1e-12);
    EXPECT_LT(delay(TemporalChoice::minimum_phase), 2);
  }
}

// Among a hundred thousand random filters of one frame's delay none keeps less noise.
TEST(TemporalChoice, OneFrameKeepsLeastNoiseOfItsDelay) {
  const auto ours = temporal_taps(TemporalChoice::one_frame, 60).value();
  double noise = 0;
  for (const double tap : ours) noise += tap * tap;
  EXPECT_NEAR(noise, 0.3, 1e-12);
  std::srand(1);
  for (int i = 0; i < 100000; ++i) {
    Eigen::VectorXd h = (Eigen::VectorXd::Random(6).array() + 1).matrix();
    double sum = h.sum();
    h /= sum;
    double delay = 0;
    for (Eigen::Index n = 0; n < 6; ++n) delay += static_cast<double>(n) * h[n];
    if (delay < 1) continue;
    h *= 1 / delay;  // mixed with the undelayed filter to delay exactly one frame
    h[0] += 1 - 1 / delay;
    EXPECT_GE(h.squaredNorm(), noise);
  }
}

TEST(LightSetFilter, DelaysPowerAsItsTapsSay) {
  const auto taps = temporal_taps(TemporalChoice::one_frame, 60).value();
  LightSetFilter filter(taps, 2, kPi / 2);
  EXPECT_NEAR(filter.delay_frames(), 1, 1e-12);
  LightSet set;
  for (int frame = 0; frame < 10; ++frame) {
    set.lights = {{Vec3f(0, 1, 0), Rgb(1, 2, 3), -1, 0}, {Vec3f(0.6f, 0.8f, 0), Rgb(1, 1, 1), -1, 1}};
    if (frame >= 5) set.lights[0].illuminance *= 11;
    filter.apply(set);
    const std::array<double, 5> risen = {0.4, 0.7, 0.9, 1, 1};
    const double share = frame < 5 ? 0 : risen[static_cast<std::size_t>(frame - 5)];
    EXPECT_NEAR(set.lights[0].illuminance[1], 2 + 20 * share, 1e-4) << frame;  // floats
    EXPECT_NEAR(set.total_illuminance[1], 3 + 20 * share, 1e-4);
    EXPECT_EQ(set.lights[1].id, 1u);
  }
}

}  // namespace
}  // namespace lightwell
