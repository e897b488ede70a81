// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/calibration_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <span>
#include <string>

#include "interface/atomic_file.h"
#include "interface/base64.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using nlohmann::json;
using test::TemporaryFolder;

Calibration example() {
  Calibration c;
  c.response.model = LogResponse{64.125, 208.3, 0.1};
  c.response.black_code = 64;
  c.response.clip_code = 4090;
  c.response.reference_exposure_us = 3333.3;
  c.lens.image_size = {31, 17};
  c.lens.focal = {5.1, 5.2};
  c.lens.center = {15.3, 8.1};
  c.lens.k = {-0.02, 0.003, 1e-4, -1e-5};
  c.lens.max_theta_rad = 1.5;
  c.lens.zenith = Vec3d(0.1, -0.2, 0.9).normalized();
  c.flat.image_size = c.lens.image_size;
  c.flat.vignetting = {-0.1, 0.01, -0.001};
  std::mt19937 random(1);
  std::normal_distribution<float> normal(0, 3);
  c.flat.offset_codes.resize(31 * 17);
  for (float& o : c.flat.offset_codes) o = normal(random);
  c.rec709_from_camera << 1.5, -0.3, -0.2, -0.1, 1.2, -0.1, 0, -0.4, 1.4;
  return c;
}

void expect_same(const Calibration& a, const Calibration& b) {
  const auto& la = std::get<LogResponse>(a.response.model);
  const auto& lb = std::get<LogResponse>(b.response.model);
  EXPECT_EQ(la.a, lb.a);
  EXPECT_EQ(la.b, lb.b);
  EXPECT_EQ(la.c, lb.c);
  EXPECT_EQ(a.response.clip_code, b.response.clip_code);
  EXPECT_EQ(a.response.black_code, b.response.black_code);
  EXPECT_EQ(a.response.reference_exposure_us, b.response.reference_exposure_us);
  EXPECT_EQ(a.lens.image_size, b.lens.image_size);
  EXPECT_EQ(a.lens.focal, b.lens.focal);
  EXPECT_EQ(a.lens.center, b.lens.center);
  EXPECT_EQ(a.lens.k, b.lens.k);
  EXPECT_EQ(a.lens.zenith, b.lens.zenith);
  EXPECT_NEAR(a.lens.max_theta_rad, b.lens.max_theta_rad,
              1e-15);  // radians to degrees and back: one rounding
  EXPECT_EQ(a.flat.vignetting, b.flat.vignetting);
  EXPECT_EQ(a.rec709_from_camera, b.rec709_from_camera);
  ASSERT_EQ(a.flat.offset_codes.size(), b.flat.offset_codes.size());
  for (std::size_t i = 0; i < a.flat.offset_codes.size(); ++i)
    EXPECT_NEAR(a.flat.offset_codes[i], b.flat.offset_codes[i],
                16.0 / 32768 / 2);  // half a step below 16 codes
}

TEST(CalibrationIo, RoundTripThroughAFolderKeepsEveryFieldAndTheId) {
  const TemporaryFolder folder;
  const Calibration written = example();
  ASSERT_TRUE(write_calibration(folder.path() / "new", written));
  const auto read = read_calibration(folder.path() / "new");
  ASSERT_TRUE(read) << read.error().message;
  expect_same(written, *read);
  EXPECT_EQ(calibration_id(written), read->id);
  // A second trip changes nothing at all.
  ASSERT_TRUE(write_calibration(folder.path(), *read));
  EXPECT_EQ(read_calibration(folder.path())->flat.offset_codes, read->flat.offset_codes);
}

TEST(CalibrationIo, RoundTripThroughTheAttachmentKeepsEveryFieldAndTheId) {
  const Calibration written = example();
  const auto read = calibration_from_json(calibration_to_json(written), "take.mkv");
  ASSERT_TRUE(read) << read.error().message;
  expect_same(written, *read);
  EXPECT_EQ(calibration_id(written), read->id);
}

TEST(CalibrationIo, LinearResponseAndNoFixedPatternSurvive) {
  const Calibration c{
      {LinearResponse{12, 0.25}, 12, 0, 4095, 10000}, {}, {}, Eigen::Matrix3d::Identity(), ""};
  const auto read = calibration_from_json(calibration_to_json(c), "x");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(std::get<LinearResponse>(read->response.model).gain, 0.25);
  EXPECT_TRUE(read->flat.offset_codes.empty());
  EXPECT_EQ(read->id, calibration_id(c));
}

TEST(CalibrationIo, LinLogAndPiecewiseLinearResponsesSurviveEveryTrip) {
  const PiecewiseLinearResponse companded{{{0, 60.3}, {12.25, 1084.6}, {95.1, 2108}, {24000, 4000.7}}};
  const LinLogResponse lin_log{64.5, 30.1, 20.7};
  for (const bool piecewise : {true, false}) {
    Calibration c = example();
    if (piecewise)
      c.response.model = companded;
    else
      c.response.model = lin_log;
    const TemporaryFolder folder;
    ASSERT_TRUE(write_calibration(folder.path(), c));
    for (const auto& read :
         {calibration_from_json(calibration_to_json(c), "x"), read_calibration(folder.path())}) {
      ASSERT_TRUE(read) << read.error().message;
      if (piecewise) {
        EXPECT_EQ(std::get<PiecewiseLinearResponse>(read->response.model).points, companded.points);
      } else {
        const auto& m = std::get<LinLogResponse>(read->response.model);
        EXPECT_EQ(m.black, lin_log.black);
        EXPECT_EQ(m.gain, lin_log.gain);
        EXPECT_EQ(m.knee_cd_m2, lin_log.knee_cd_m2);
      }
      EXPECT_EQ(read->id, calibration_id(c));
    }
  }
}

// As written before there were more than two models: same content, same id, for ever.
TEST(CalibrationIo, OldFilesAreReadAndKeepTheirId) {
  const std::string old =
      R"({"schema":"lightwell.calibration/1","id":"","response":{"schema":"lightwell.response/1","model":"log",)"
      R"("parameters":{"a":64.125,"b":208.3,"c":0.1},"bits":12,"black_code":64,"clip_code":4090,)"
      R"("reference_exposure_us":10000},"lens":{"schema":"lightwell.lens/1","model":"kannala-brandt",)"
      R"("image_size":[3,2],"focal":[1.5,1.5],"center":[1,0.5],"k":[0,0,0,0],"max_theta_deg":90},)"
      R"("flat":{"schema":"lightwell.flat/1","image_size":[0,0],"vignetting":[0,0,0]}})";
  const auto read = calibration_from_json(old, "old");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(std::get<LogResponse>(read->response.model).b, 208.3);
  EXPECT_EQ(read->id, "9089c8543b5f51f7");
}

json file_of(const char* name, const Calibration& calibration) {
  return json::parse(calibration_to_json(calibration)).at(name);
}

// A reader that knows /1 alone would use a tilted lens as a level one, and pixels without their gains.
TEST(CalibrationIo, WhatAnOlderReaderWouldPassByRaisesTheSchemaAndNothingElseDoes) {
  Calibration c = example();
  EXPECT_EQ(file_of("lens", c)["schema"], "lightwell.lens/2");
  EXPECT_EQ(file_of("flat", c)["schema"], "lightwell.flat/1");
  c.lens.zenith = Vec3d::UnitZ();
  EXPECT_EQ(file_of("lens", c)["schema"], "lightwell.lens/1");
  EXPECT_FALSE(file_of("lens", c).contains("zenith"));
  c.flat.gain.assign(31 * 17, 1.01F);
  EXPECT_EQ(file_of("flat", c)["schema"], "lightwell.flat/2");
}

TEST(CalibrationIo, FilesOfEveryAgeAreReadAndThoseOfTheFutureAreRefused) {
  const Calibration c = example();
  json all = json::parse(calibration_to_json(c));
  const auto read = [&] { return calibration_from_json(all.dump(), "x"); };
  const auto id = read().value().id;
  all["lens"]["schema"] = "lightwell.lens/1";  // a zenith under /1, as it was written for some days
  ASSERT_TRUE(read()) << read().error().message;
  EXPECT_EQ(read()->lens.zenith, c.lens.zenith);
  EXPECT_EQ(read()->id, id);
  all["lens"].erase("zenith");  // and before gravity was known at all
  ASSERT_TRUE(read()) << read().error().message;
  EXPECT_EQ(read()->lens.zenith, Vec3d(Vec3d::UnitZ()));
  all["flat"]["gain"] = all["flat"]["offset_codes"];
  all["flat"]["gain"]["scale"] = 0x1p-15;
  std::string ones;
  for (int i = 0; i < 31 * 17; ++i) ones += std::string("\xff\x7f", 2);
  all["flat"]["gain"]["data"] = base64_encode(std::as_bytes(std::span(ones)));
  ASSERT_TRUE(read()) << read().error().message;  // gains under /1 likewise
  EXPECT_EQ(read()->flat.gain.size(), 31U * 17);
  for (const auto& [file, schema] :
       {std::pair("lens", "lightwell.lens/3"), std::pair("flat", "lightwell.flat/3"),
        std::pair("lens", "lightwell.lens/0"), std::pair("lens", "lightwell.flat/1")}) {
    json future = all;
    future[file]["schema"] = schema;
    const auto refused = calibration_from_json(future.dump(), "x");
    ASSERT_FALSE(refused) << schema;
    EXPECT_EQ(refused.error().kind, ErrorKind::bad_input);
    EXPECT_NE(refused.error().message.find("schema = \"" + std::string(schema) + "\": allowed"),
              std::string::npos)
        << refused.error().message;
  }
}

TEST(CalibrationIo, IdTellsAnyChangeOfContent) {
  const std::string id = calibration_id(example());
  EXPECT_EQ(id.size(), 16u);
  const auto differs = [&](auto change) {
    Calibration c = example();
    change(c);
    return calibration_id(c) != id;
  };
  EXPECT_TRUE(differs([](Calibration& c) { std::get<LogResponse>(c.response.model).a += 1e-9; }));
  EXPECT_TRUE(differs([](Calibration& c) { c.response.bits = 11; }));
  EXPECT_TRUE(differs([](Calibration& c) { c.lens.k[3] += 1e-9; }));
  EXPECT_TRUE(differs([](Calibration& c) { c.lens.max_theta_rad += 1e-6; }));
  EXPECT_TRUE(differs([](Calibration& c) { c.lens.zenith = Vec3d(0.1, -0.2, 0.91).normalized(); }));
  EXPECT_TRUE(differs([](Calibration& c) { c.lens.zenith = Vec3d::UnitZ(); }));
  EXPECT_TRUE(differs([](Calibration& c) { c.flat.vignetting[1] += 1e-9; }));
  EXPECT_TRUE(differs([](Calibration& c) { c.flat.offset_codes[5] += 0.01f; }));
  EXPECT_TRUE(differs([](Calibration& c) { c.rec709_from_camera(2, 1) += 1e-9; }));
}

TEST(CalibrationIo, TableIsDenseOverTheUsableCodesAndIncreases) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_calibration(folder.path(), example()));
  const auto root = nlohmann::json::parse(*read_text_file(folder.path() / "response.json"));
  const auto& code = root.at("table").at("code");
  const auto& luminance = root.at("table").at("luminance_cd_m2");
  ASSERT_EQ(code.size(), 4090u - 64u + 1u);
  ASSERT_EQ(luminance.size(), code.size());
  for (std::size_t i = 0; i < code.size(); ++i) {
    EXPECT_EQ(code[i].get<int>(), 64 + static_cast<int>(i));
    if (i > 0) {
      EXPECT_GT(luminance[i].get<double>(), luminance[i - 1].get<double>());
    }
  }
}

// Every wrong field is refused by the file's name and its own.
struct Wrong {
  const char* file;
  const char* pointer;
  const char* value;
  const char* named;
};

class WrongField : public testing::TestWithParam<Wrong> {};

TEST_P(WrongField, IsBadInputThatNamesFileAndField) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_calibration(folder.path(), example()));
  const auto file = folder.path() / GetParam().file;
  auto root = nlohmann::json::parse(*read_text_file(file));
  root[nlohmann::json::json_pointer(GetParam().pointer)] = nlohmann::json::parse(GetParam().value);
  ASSERT_TRUE(write_file_atomically(file, root.dump()));
  const auto read = read_calibration(folder.path());
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::bad_input);
  EXPECT_NE(read.error().message.find(file.string()), std::string::npos) << read.error().message;
  EXPECT_NE(read.error().message.find(GetParam().named), std::string::npos) << read.error().message;
  EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    CalibrationIo, WrongField,
    testing::Values(
        Wrong{"response.json", "/schema", "\"lightwell.response/2\"", "schema"},
        Wrong{"response.json", "/model", "\"cubic\"", "model"},
        Wrong{"response.json", "/parameters", "[1,2]", "parameters"},
        Wrong{"response.json", "/model", "\"linlog\"", "parameters.black"},
        Wrong{"response.json", "/model", "\"pwl\"", "parameters.code"},
        Wrong{"response.json", "/parameters/b", "-1", "b = -1"},
        Wrong{"response.json", "/parameters/a", "\"x\"", "parameters.a"},
        Wrong{"response.json", "/bits", "12.5", "bits"}, Wrong{"response.json", "/bits", "17", "bits"},
        Wrong{"response.json", "/clip_code", "5000", "clip_code"},
        Wrong{"response.json", "/black_code", "null", "black_code"},
        Wrong{"response.json", "/reference_exposure_us", "0", "reference_exposure_us"},
        Wrong{"response.json", "/table/code", "[1,2]", "luminance_cd_m2"},
        Wrong{"response.json", "/table/luminance_cd_m2/1", "-5", "luminance_cd_m2"},
        Wrong{"response.json", "/rec709_from_camera/1", "[1,2]", "rec709_from_camera"},
        Wrong{"lens.json", "/schema", "7", "schema"},
        Wrong{"lens.json", "/image_size", "[640]", "image_size"},
        Wrong{"lens.json", "/image_size/0", "0", "image_size[0]"},
        Wrong{"lens.json", "/image_size/1", "1e300", "image_size[1]"},
        Wrong{"lens.json", "/focal/1", "-3", "focal[1]"},
        Wrong{"lens.json", "/center/0", "\"c\"", "center[0]"}, Wrong{"lens.json", "/k", "{}", "k"},
        Wrong{"lens.json", "/k/0", "-9", "k"}, Wrong{"lens.json", "/max_theta_deg", "181", "max_theta_deg"},
        Wrong{"lens.json", "/zenith", "[0,0,2]", "zenith[2]"},
        Wrong{"lens.json", "/zenith", "[0,0,0.5]", "zenith: length"},
        Wrong{"lens.json", "/zenith", "[0,0,-1]", "straight down"},
        Wrong{"lens.json", "/zenith", "[0,1]", "zenith"}, Wrong{"flat.json", "/schema", "\"\"", "schema"},
        Wrong{"flat.json", "/image_size/0", "30", "offset_codes.data"},
        Wrong{"flat.json", "/vignetting/0", "-5", "vignetting"},
        Wrong{"flat.json", "/offset_codes/encoding", "\"raw\"", "encoding"},
        Wrong{"flat.json", "/offset_codes/scale", "0", "scale"},
        Wrong{"flat.json", "/offset_codes/data", "\"!!!!\"", "data"}));

TEST(CalibrationIo, PiecewiseLinearPointsThatDoNotIncreaseOrPairAreBadInput) {
  Calibration c = example();
  c.response.model = PiecewiseLinearResponse{{{0, 60}, {12, 1000}, {24000, 4000}}};
  const nlohmann::json good = nlohmann::json::parse(calibration_to_json(c));
  const auto refused = [&](const char* pointer, const char* value, const char* named) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(std::string("/response/parameters/") + pointer)] =
        nlohmann::json::parse(value);
    const auto read = calibration_from_json(bad.dump(), "take.mkv");
    ASSERT_FALSE(read) << pointer;
    EXPECT_EQ(read.error().kind, ErrorKind::bad_input);
    EXPECT_NE(read.error().message.find(named), std::string::npos) << read.error().message;
  };
  refused("code/1", "5000", "response.code[2]");
  refused("luminance_cd_m2/1", "0", "response.luminance_cd_m2[1]");
  refused("code", "[60, 1000]", "luminance_cd_m2 has 3 values, code has 2");
  refused("code/0", "null", "code[0]");
}

TEST(CalibrationIo, MissingFolderAndTruncatedFileAreBadInputButNoFlatIsFine) {
  EXPECT_EQ(read_calibration("/nonexistent").error().kind, ErrorKind::bad_input);
  const TemporaryFolder folder;
  ASSERT_TRUE(write_calibration(folder.path(), example()));
  std::filesystem::remove(folder.path() / "flat.json");
  const auto without = read_calibration(folder.path());
  ASSERT_TRUE(without) << without.error().message;
  EXPECT_TRUE(without->flat.offset_codes.empty());
  std::filesystem::create_symlink(folder.path() / "elsewhere", folder.path() / "flat.json");
  const auto dangling = read_calibration(folder.path());
  ASSERT_FALSE(dangling);  // meant to be there
  EXPECT_EQ(dangling.error().kind, ErrorKind::bad_input);
  EXPECT_NE(dangling.error().message.find("flat.json"), std::string::npos) << dangling.error().message;
  std::filesystem::remove(folder.path() / "flat.json");
  const std::string lens = *read_text_file(folder.path() / "lens.json");
  ASSERT_TRUE(write_file_atomically(folder.path() / "lens.json", lens.substr(0, lens.size() / 2)));
  EXPECT_EQ(read_calibration(folder.path()).error().kind, ErrorKind::bad_input);
}

TEST(CalibrationIo, WritingBelowAMissingFolderFails) {
  const Status status = write_calibration("/nonexistent/calibration", example());
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::failed);
}

// Damage anywhere is an answer, never a crash; what still reads is a valid calibration.
TEST(CalibrationIo, DamagedTextNeverCrashes) {
  const std::string good = calibration_to_json(example());
  std::mt19937 random(7);
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    const int changes = 1 + static_cast<int>(random() % 4);
    for (int c = 0; c < changes; ++c) text[random() % text.size()] = static_cast<char>(random() & 255);
    if (i % 3 == 0) text.resize(random() % text.size());
    const auto read = calibration_from_json(text, "damaged");
    if (read) {
      EXPECT_TRUE(check(read->response));
      EXPECT_TRUE(check(read->flat, read->lens));
    } else {
      EXPECT_EQ(read.error().kind, ErrorKind::bad_input);
    }
  }
}

TEST(Base64, KnownVectorsAndRoundTrip) {
  const auto bytes = [](std::string_view s) { return std::as_bytes(std::span(s.data(), s.size())); };
  EXPECT_EQ(base64_encode(bytes("foobar")), "Zm9vYmFy");  // RFC 4648, section 10
  EXPECT_EQ(base64_encode(bytes("fooba")), "Zm9vYmE=");
  EXPECT_EQ(base64_encode(bytes("foob")), "Zm9vYg==");
  EXPECT_EQ(base64_encode({}), "");
  std::vector<std::byte> all(257);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::byte>(i * 37);
  EXPECT_EQ(base64_decode(base64_encode(all)), all);
}

TEST(Base64, RefusesWhatEncodingCannotWrite) {
  for (const char* bad : {"Zm9", "Zm9v\n", "Zm=v", "Z===", "====", "Zh==", "Zm9vYg=", "Zm 9"})
    EXPECT_FALSE(base64_decode(bad)) << bad;
}

}  // namespace
}  // namespace lightwell
