// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>
#include <regex>

#include "interface/calibration_io.h"
#include "interface/environment_io.h"
#include "interface/jpeg.h"
#include "lighting/direction.h"
#include "tests/integration/photometric/photometric_fixture.h"

namespace lightwell {
namespace {

constexpr double kDegree = kPi / 180;

double luminance(const Rgb& p) {
  return static_cast<double>(0.2126F * p[0] + 0.7152F * p[1] + 0.0722F * p[2]);
}

// What all these cameras do: look along −Z, the top of the picture up.
const Vec3d kUpInCamera(0, -1, 0);
Vec3d world_of(double theta, double x, double y) {
  const double r = std::hypot(x, y);
  const double s = r > 0 ? std::sin(theta) / r : 0;
  return {s * x, -s * y, -std::cos(theta)};
}

// Light and where it comes from.
struct Light {
  double sum = 0;  // luminance × solid angle
  Vec3d mean = Vec3d::Zero();
  void add(double luminance_sr, const Vec3d& direction) {
    sum += luminance_sr;
    mean += luminance_sr * direction;
  }
};

Light light_of(const LatLongImage& map, const Vec3d& toward, double within_rad) {
  Light out;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const Vec3d d = direction_from_lat_long((x + 0.5) / map.width, (y + 0.5) / map.height);
      if (std::acos(std::clamp(d.dot(toward), -1.0, 1.0)) <= within_rad)
        out.add(luminance(map.at(x, y)) * map.pixel_solid_angle_sr(y), d);
    }
  return out;
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) / kDegree;
}

class BracketMap : public test::PhotometricTest {
 protected:
  std::string write_lens(const Lens& lens) const {
    const nlohmann::json file = {{"schema", "lightwell.lens/1"},
                                 {"model", "kannala-brandt"},
                                 {"image_size", lens.image_size},
                                 {"focal", {lens.focal.x(), lens.focal.y()}},
                                 {"center", {lens.center.x(), lens.center.y()}},
                                 {"k", lens.k},
                                 {"max_theta_deg", lens.max_theta_rad / kDegree},
                                 {"zenith", {kUpInCamera.x(), kUpInCamera.y(), kUpInCamera.z()}}};
    return write("lens.json", file.dump());
  }
  std::string write_vignetting(const std::array<int, 2>& size, const std::array<double, 3>& v) const {
    return write(
        "flat.json",
        nlohmann::json{{"schema", "lightwell.flat/1"}, {"image_size", size}, {"vignetting", v}}.dump());
  }
};

// An equidistant fisheye of 180 degrees in a grey room, three decades brighter to the right, with one bright window.
class Room : public BracketMap {
 protected:
  static constexpr int kSize = 800;
  static constexpr double kFocal = 200, kMiddle = 399.5, kWindow = 40;
  static constexpr std::array<double, 3> kVignetting = {-0.1, 0.01, 0};

  static double theta_of(int x, int y) { return std::hypot(x - kMiddle, y - kMiddle) / kFocal; }
  static bool in_window(int x, int y) { return x >= 520 && x < 576 && y >= 288 && y < 320; }
  static double radiance(int x, int y) {
    return in_window(x, y) ? kWindow : std::pow(10, 3.5 * x / kSize - 2.2) * (1 + 0.5 * y / kSize);
  }
  static double transmission(double theta) {
    const double t = theta * theta;
    return 1 + t * (kVignetting[0] + t * kVignetting[1]);
  }
  std::string photograph(int number, double exposure_s) const {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        const double theta = theta_of(x, y);
        const double light = theta < 1.6 ? radiance(x, y) * transmission(theta) : 0;
        const double code = 255 * std::pow(std::min(1.0, light * exposure_s), 1 / 2.2);
        rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>(std::lround(code)));
      }
    return write("p" + std::to_string(number) + ".jpg", *encode_jpeg(kSize, kSize, rgb, 98));
  }
  // brackets …, from 16 s to 1/256 s in steps of two stops
  std::vector<std::string> command() const {
    std::vector<std::string> out = {"brackets"};
    std::string times;
    for (int i = 0; i < 7; ++i) {
      const double s = 16 * std::pow(4.0, -i);
      out.push_back(photograph(i, s));
      times += (i > 0 ? "," : "") + std::to_string(s);
    }
    out.insert(out.end(), {"--exposures", times, "--out", path("response.json")});
    return out;
  }
  std::string lens_file(int size = kSize) const {
    return write_lens(
        {{size, size}, {kFocal, kFocal}, {kMiddle, kMiddle}, {0, 0, 0, 0}, kPi / 2, kUpInCamera});
  }
  static std::vector<std::string> with(std::vector<std::string> command,
                                       const std::vector<std::string>& more) {
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }
};

TEST_F(Room, TheWindowsLightIsAllThereAndComesFromTheWindow) {
  const auto run = calibrate(
      with(command(), {"--lens", lens_file(), "--flat", write_vignetting({kSize, kSize}, kVignetting),
                       "--map", path("room.exr"), "--json"}));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto map = read_environment(path("room.exr"));
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->remark(""), "");
  // Code 118 in the middle exposure, 1/4 s, is luminance 1.
  const double unit = 0.25 / std::pow(118 / 255.0, 2.2);
  Light window, all;
  const Vec3d toward = world_of(theta_of(548, 304), 548 - kMiddle, 304 - kMiddle);
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const double theta = theta_of(x, y);
      if (theta > kPi / 2) continue;
      const double sr = std::sin(theta) / (theta * kFocal * kFocal);
      const Vec3d d = world_of(theta, x - kMiddle, y - kMiddle);
      all.add(unit * radiance(x, y) * sr, d);
      if (d.dot(toward) >= std::cos(20 * kDegree)) window.add(unit * radiance(x, y) * sr, d);
    }
  const Light seen = light_of(map->image, toward, 20 * kDegree);
  // The curve is good to 2 % (its own test).
  EXPECT_NEAR(seen.sum / window.sum, 1, 0.03);
  EXPECT_LT(degrees_between(seen.mean, window.mean),
            0.3);  // JPEG and a quarter's size smear by a pixel, 0.3 degrees
  EXPECT_NEAR(light_of(map->image, Vec3d::UnitY(), kPi).sum / all.sum, 1, 0.03);
  // Behind the camera nothing was seen.
  EXPECT_EQ(light_of(map->image, Vec3d::UnitZ(), 89 * kDegree).sum, 0);
  const auto report = nlohmann::json::parse(run.out).at("map");
  EXPECT_NEAR(report.at("coverage").get<double>(), 0.5, 1e-4);
  EXPECT_EQ(report.at("clipped_pixels"), 0);
  EXPECT_NEAR(report.at("total_illuminance")[1].get<double>() / all.sum, 1, 0.03);
  EXPECT_LT(report.at("facing_lux").get<double>(), all.sum);
}

TEST_F(Room, TheScaleThatAMeterAsksForMakesTheMapAgree) {
  const auto lens = lens_file();
  const auto brackets = command();
  ASSERT_EQ(calibrate(with(brackets, {"--lens", lens, "--map", path("a.exr")})).exit_code, 0);
  const std::vector<std::string> verify = {"verify", "--lux", "500", "--toward", "0,0,-1", "--json"};
  const auto before = calibrate(with(verify, {"--environment", path("a.exr")}));
  ASSERT_EQ(before.exit_code, 0) << before.err;
  const double scale = nlohmann::json::parse(before.out).at("scale").get<double>();
  ASSERT_EQ(
      calibrate(with(brackets, {"--lens", lens, "--map", path("b.exr"), "--scale", std::to_string(scale)}))
          .exit_code,
      0);
  const auto after = calibrate(with(verify, {"--environment", path("b.exr")}));
  EXPECT_NEAR(nlohmann::json::parse(after.out).at("map_lux").get<double>(), 500,
              0.01);  // digits of the scale
  EXPECT_NEAR(read_json("response.json").at("brackets").at("scale").get<double>(), scale, 1e-5);
}

TEST_F(Room, WhatDoesNotFitIsRefusedAndNothingIsWritten) {
  const auto brackets = command();
  const auto refused = [&](const std::vector<std::string>& more, int code, const std::string& names) {
    expect_refused(with(brackets, more), code, names, "response.json");
    EXPECT_FALSE(std::filesystem::exists(path("map.exr")));
  };
  const auto lens = lens_file();
  refused({"--map", path("map.exr")}, 2, "--map needs --lens");
  refused({"--lens", lens}, 2, "--lens needs --map");
  refused({"--flat", lens}, 2, "--flat needs --lens");
  refused({"--lens", lens, "--map", path("response.json")}, 2, "name one file");
  refused({"--lens", lens, "--map", lens}, 2, "is also the input");
  refused({"--lens", lens, "--map", path("map.exr"), "--scale", "0"}, 2, "--scale");
  refused({"--scale", "1e-7"}, 2, "allowed 1e-6 to 1e6");
  refused({"--scale", "1e7"}, 2, "allowed 1e-6 to 1e6");
  refused({"--radiance", path("./response.json")}, 2, "--radiance and --out name one file");
  refused({"--lens", lens, "--radiance", path("map.exr"), "--map", path("./map.exr")}, 2,
          "--map and --radiance name one file");
  refused({"--lens", path("none.json"), "--map", path("map.exr")}, 3, "none.json");
  refused({"--lens", lens_file(400), "--map", path("map.exr")}, 3,
          "lens.image_size = 400x400: allowed that of the photographs, 800x800");
  const auto flat = write_vignetting({400, 400}, {0, 0, 0});
  refused({"--lens", lens_file(), "--flat", flat, "--map", path("map.exr")}, 3, "flat.json: ");
}

// The office photographs with what was published about their camera: its circle, projection and vignetting.
class Office : public BracketMap {
 protected:
  const std::filesystem::path folder_ = LIGHTWELL_TEST_DATA "/photometric/office_fisheye_brackets";

  // The number after `name` in the text.
  static double number_after(const std::string& text, const std::string& name) {
    std::smatch found;
    if (!std::regex_search(text, found, std::regex(name + R"(\s*(-?[0-9.]+))"))) return std::nan("");
    return std::stod(found[1]);
  }
  // T = 1 + v2 r² + v4 r⁴, r the angle off axis over that of the circle.
  struct Camera {
    double diameter = 0, x = 0, y = 0, edge_rad = 0;  // the circle, pixels from the top left
    double v2 = 0, v4 = 0;

    // fisheye_corr.cal: equidistant radius 2/π asin(√2 r), r in diameters; its whole, a half, is the circle's edge.
    [[nodiscard]] double theta(double radius_px) const {
      return 2 * edge_rad * 2 / kPi * std::asin(std::min(1.0, std::sqrt(2.0) * radius_px / diameter));
    }
    // √2 r = sin(a θ), by Taylor's series: what is left out at the edge is 2e-9 of it.
    [[nodiscard]] Lens lens() const {
      const double a = kPi / (4 * edge_rad), a2 = a * a, f = diameter / std::sqrt(2.0) * a;
      return {{5616, 3744}, {f, f},
              {x, y},       {-a2 / 6, a2 * a2 / 120, -a2 * a2 * a2 / 5040, a2 * a2 * a2 * a2 / 362880},
              edge_rad,     kUpInCamera};
    }
    [[nodiscard]] double transmission(double theta_rad) const {
      const double r2 = theta_rad * theta_rad / (edge_rad * edge_rad);
      return 1 + r2 * (v2 + r2 * v4);
    }
  };
  [[nodiscard]] std::optional<Camera> camera() const {
    const auto circle = read_text_file(folder_ / "ImageLensInformation.txt");
    const auto vignetting = read_text_file(folder_ / "vignetting_f5d6.cal");
    if (!circle || !vignetting) return std::nullopt;
    Camera c;
    c.diameter = number_after(*circle, "diameter <-");
    c.x = number_after(*circle, "xleft <-") + c.diameter / 2 - 0.5;
    c.y = number_after(*circle, "yres <-") - number_after(*circle, "ydown <-") - c.diameter / 2 - 0.5;
    c.edge_rad = number_after(*circle, "-vv") / 2 * kDegree;
    std::smatch found;
    if (std::regex_search(*vignetting, found, std::regex(R"(\(\(([-0-9.]+)\)\*\(r\^4\)\))")))
      c.v4 = std::stod(found[1]);
    if (std::regex_search(*vignetting, found, std::regex(R"(\(\(([-0-9.]+)\)\*\(r\^2\)\))")))
      c.v2 = std::stod(found[1]);
    return c;
  }
};

TEST_F(Office, BecomesARadianceMapWithAllItsLightAndTheWindowWhereItIs) {
  const auto camera = this->camera();
  if (!camera || !std::filesystem::exists(folder_ / "IMG_6955.JPG"))
    GTEST_SKIP() << folder_ << " is not there";
  ASSERT_EQ(camera->diameter, 3612);
  ASSERT_NEAR(camera->v4, -0.5286, 1e-4);
  ASSERT_NEAR(camera->v2, 0.1755, 1e-4);
  const double e2 = camera->edge_rad * camera->edge_rad;
  std::vector<std::string> command = {"brackets"};
  for (int i = 6955; i <= 6971; i += 2)
    command.push_back((folder_ / ("IMG_" + std::to_string(i) + ".JPG")).string());
  command.insert(command.end(),
                 {"--out", path("response.json"), "--radiance", path("picture.exr"), "--map", path("map.exr"),
                  "--lens", write_lens(camera->lens()), "--flat",
                  write_vignetting({5616, 3744}, {camera->v2 / e2, camera->v4 / (e2 * e2), 0}), "--json"});
  const auto run = calibrate(command);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto picture = read_environment(path("picture.exr"));
  const auto map = read_environment(path("map.exr"));
  ASSERT_TRUE(picture && map);

  // By the published figures themselves, pixel by pixel of the fisheye picture.
  Light all, brightest;
  std::vector<std::pair<double, Vec3d>> light;
  for (int y = 0; y < picture->image.height; ++y)
    for (int x = 0; x < picture->image.width; ++x) {
      const double dx = 4 * x + 1.5 - camera->x, dy = 4 * y + 1.5 - camera->y, r = std::hypot(dx, dy);
      if (r > camera->diameter / 2 || r == 0) continue;
      const double theta = camera->theta(r), step = 0.5;
      const double slope = (camera->theta(r + step) - camera->theta(r - step)) / (2 * step);
      const double sr = 16 * std::sin(theta) * slope / r;
      const double seen = luminance(picture->image.at(x, y)) / camera->transmission(theta);
      light.emplace_back(seen * sr, world_of(theta, dx, dy));
      all.add(light.back().first, light.back().second);
      if (seen * sr > brightest.sum) brightest = {seen * sr, light.back().second};
    }
  Light window;
  for (const auto& [lux, d] : light)
    if (degrees_between(d, brightest.mean) <= 25) window.add(lux, d);

  // Pixels that the circle's edge cuts, dark ones, count as whole or not at all here.
  EXPECT_NEAR(light_of(map->image, Vec3d::UnitY(), kPi).sum / all.sum, 1, 1e-3);
  const Light seen = light_of(map->image, brightest.mean.normalized(), 25 * kDegree);
  // The 25 degrees cut bins of one degree elsewhere than pixels of 0.2: of a rim of 157 degrees a fraction of one.
  EXPECT_NEAR(seen.sum / window.sum, 1, 0.01);
  EXPECT_LT(degrees_between(seen.mean, window.mean), 0.2);
  // The window is to the right of what the camera looks at, and outshines the room.
  EXPECT_GT(window.mean.normalized().x(), 0.5);
  EXPECT_LT(window.mean.normalized().z(), 0);
  EXPECT_GT(window.sum, 0.3 * all.sum);
  const auto report = nlohmann::json::parse(run.out).at("map");
  EXPECT_EQ(report.at("clipped_pixels"), 0);
  EXPECT_NEAR(report.at("coverage").get<double>(), (1 - std::cos(camera->edge_rad)) / 2, 1e-5);

  const auto lights = test::run_process(
      LIGHTWELL_BIN_DIR "/lightwell",
      {"lights", path("map.exr"), "--sphere", "--count", "32", "--out", path("lights.json"), "--json"});
  ASSERT_EQ(lights.exit_code, 0) << lights.err;
  const auto total = nlohmann::json::parse(lights.out).at("total_illuminance");
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(total[c].get<double>() / report.at("total_illuminance")[c].get<double>(), 1, 1e-4) << c;
}

}  // namespace
}  // namespace lightwell
