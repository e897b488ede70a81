// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "lighting/response.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace lightwell {
namespace {

Response logarithmic() {
  return {LogResponse{-200, 180, 0.5}, 12, 10, 4090, 10000};
}
Response linear() {
  return {LinearResponse{64, 0.25}, 12, 64, 4000, 10000};
}

TEST(Response, CodeAndLuminanceInvertEachOther) {
  for (const Response& response : {logarithmic(), linear()})
    for (double code = response.black_code; code <= response.clip_code; code += 7.3)
      EXPECT_NEAR(response.code(response.luminance_cd_m2(code)), code,
                  1e-9 * 4095);  // rounding of exp and log
}

TEST(Response, DerivativeIsTheSlopeOfLuminance) {
  for (const Response& response : {logarithmic(), linear()})
    for (double code = 100; code < 4000; code += 100) {
      const double h = 1e-3;
      const double slope =
          (response.luminance_cd_m2(code + h) - response.luminance_cd_m2(code - h)) / (2 * h);
      EXPECT_NEAR(response.dluminance_dcode(code) / slope, 1,
                  1e-7);  // central difference: h²/6b² and rounding
    }
}

TEST(Response, GoodResponsesPass) {
  EXPECT_TRUE(check(logarithmic()));
  EXPECT_TRUE(check(linear()));
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
}

}  // namespace
}  // namespace lightwell
