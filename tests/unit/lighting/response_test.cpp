// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/response.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace lightwell {
namespace {

Response logarithmic() {
  return {LogResponse{-200, 180, 0.5}, 12, 10, 4090, 10000};
}
Response linear() {
  return {LinearResponse{64, 0.25}, 12, 64, 4000, 10000};
}

Response lin_log() {
  return {LinLogResponse{64, 30, 20}, 12, 64, 4095, 10000};
}
// 24 bits companded to 12, as sensors with four exposures do.
Response companded() {
  return {
      PiecewiseLinearResponse{{{0, 60.5}, {12.25, 1084.5}, {95, 2108.5}, {1500, 3132.5}, {24000, 4000.5}}},
      12, 64, 4095, 10000};
}
std::vector<Response> every_model() {
  return {logarithmic(), linear(), lin_log(), companded()};
}

TEST(Response, CodeAndLuminanceInvertEachOther) {
  for (const Response& response : every_model())
    for (double code = response.black_code; code <= response.clip_code; code += 7.3)
      EXPECT_NEAR(response.code(response.luminance_cd_m2(code)), code,
                  1e-9 * 4095);  // rounding of exp and log
}

TEST(Response, DerivativeIsTheSlopeOfLuminance) {
  for (const Response& response : every_model())
    for (double code = 100; code < 4000; code += 100) {  // no knee within h
      const double h = 1e-3;
      const double slope =
          (response.luminance_cd_m2(code + h) - response.luminance_cd_m2(code - h)) / (2 * h);
      EXPECT_NEAR(response.dluminance_dcode(code) / slope, 1,
                  1e-7);  // central difference: h²/6b² and rounding
    }
}

TEST(Response, GoodResponsesPass) {
  for (const Response& response : every_model()) {
    const Status status = check(response);
    EXPECT_TRUE(status) << status.error().message;
  }
}

TEST(Response, CheckNamesFieldValueAndRange) {
  const auto refused = [](const Response& response, const std::string& start) {
    const Status status = check(response);
    ASSERT_FALSE(status) << start;
    EXPECT_EQ(status.error().kind, ErrorKind::bad_input);
    EXPECT_EQ(status.error().message.substr(0, start.size()), start);
    EXPECT_NE(status.error().message.find("allowed"), std::string::npos);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Response r = logarithmic();
  r.bits = 17;
  refused(r, "response.bits = 17");
  r = logarithmic();
  r.black_code = -1;
  refused(r, "response.black_code = -1");
  r = logarithmic();
  r.clip_code = 4096;
  refused(r, "response.clip_code = 4096");
  r.clip_code = r.black_code;
  refused(r, "response.clip_code = 10");
  r = logarithmic();
  r.reference_exposure_us = 0;
  refused(r, "response.reference_exposure_us = 0");
  r = logarithmic();
  r.model = LogResponse{0, 0, 0};
  refused(r, "response.b = 0");
  r.model = LogResponse{nan, 100, 0};
  refused(r, "response.a = nan");
  r.model = LogResponse{0, 100, -1};
  refused(r, "response.c = -1");
  r.model = LogResponse{0, 1, 0};  // exp(4090)
  refused(r, "response: luminance at clip_code = inf");
  r.model = LinearResponse{0, -1};
  refused(r, "response.gain = -1");
  r.model = LinLogResponse{64, 0, 1};
  refused(r, "response.gain = 0");
  r.model = LinLogResponse{64, 1, 0};
  refused(r, "response.knee_cd_m2 = 0");
  r.model = LinLogResponse{nan, 1, 1};
  refused(r, "response.black = nan");
  r.model = LinLogResponse{0, 1, 1};  // exp(4089)
  refused(r, "response: luminance at clip_code = inf");
  r.model = PiecewiseLinearResponse{{{0, 10}}};
  refused(r, "response: number of knee points = 1");
  r.model = PiecewiseLinearResponse{{{0, 10}, {1, 30}, {2, 30}}};  // not monotone
  refused(r, "response.code[2] = 30");
  r.model = PiecewiseLinearResponse{{{0, 10}, {2, 20}, {1, 30}}};
  refused(r, "response.luminance_cd_m2[2] = 1");
  r.model = PiecewiseLinearResponse{{{-1, 10}, {1, 30}}};
  refused(r, "response.luminance_cd_m2[0] = -1");
  r.model = PiecewiseLinearResponse{{{0, 10}, {nan, 30}}};
  refused(r, "response.luminance_cd_m2[1] = nan");
}

TEST(Response, LinLogIsContinuousInValueAndSlopeAtTheKnee) {
  const LinLogResponse m{64, 30, 20};
  const double knee = m.code(m.knee_cd_m2);
  const double h = 1e-7;
  // Twice the step times the largest slope, 1/gain a code and 1 a code's change of it.
  EXPECT_NEAR(m.luminance_cd_m2(knee - h), m.luminance_cd_m2(knee + h), 3 * h / m.gain);
  EXPECT_NEAR(m.dluminance_dcode(knee - h) * m.gain, m.dluminance_dcode(knee + h) * m.gain, 3 * h);
}

TEST(Response, PiecewiseLinearGoesThroughItsPointsAndOnBeyondThem) {
  const Response response = companded();
  const auto& m = std::get<PiecewiseLinearResponse>(response.model);
  for (const auto& [luminance, code] : m.points) {
    EXPECT_NEAR(m.code(luminance), code, 1e-9);  // rounding
    EXPECT_NEAR(m.luminance_cd_m2(code), luminance, 1e-9 * (1 + luminance));
  }
  const double first_slope = 12.25 / 1024, last_slope = (24000.0 - 1500) / 868;
  EXPECT_NEAR(m.luminance_cd_m2(50.5), -10 * first_slope, 1e-12);
  EXPECT_NEAR(m.luminance_cd_m2(4090.5), 24000 + 90 * last_slope, 1e-8);
  EXPECT_NEAR(m.code(24000 + last_slope), 4001.5, 1e-9);
}

TEST(Response, EveryModelRisesWithLuminanceOverTheUsableCodes) {
  for (const Response& response : every_model())
    for (double code = response.black_code; code < response.clip_code; code += 1)
      ASSERT_GT(response.luminance_cd_m2(code + 1), response.luminance_cd_m2(code)) << response.model.index();
}

TEST(Response, AnotherBitDepthScalesTheCodesAlone) {
  for (const Response& response : every_model()) {
    const Response eight = with_bits(response, 8);
    EXPECT_TRUE(check(eight));
    for (double luminance = 0.1; luminance < 1e4; luminance *= 3)
      EXPECT_NEAR(eight.code(luminance) * 16, response.code(luminance), 1e-9);  // a power of two: rounding
    const Response back = with_bits(eight, 12);
    EXPECT_NEAR(back.code(7), response.code(7), 1e-9);
  }
}

}  // namespace
}  // namespace lightwell
