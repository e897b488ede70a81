// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "interface/calibration_io.h"
#include "tests/integration/commands/command_fixture.h"
#include "tests/support/analytic_fields.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

// Pictures of a known field by probes of every kind, through the command, against the field at places between them.
class FieldProbesTest : public CommandTest {
 protected:
  // What a picture shows at (x, y) of −1 to 1, y upward, of a probe at this place.
  using Optics = std::function<Rgbd(const Vec3d& at, double x, double y)>;
  void write_probes(std::size_t count, int side, const Optics& optics) {
    positions_ = random_positions(count, 2, 0.05);
    std::ofstream list(path("probes.csv"));
    list << "x,y,z,file\n";
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3d& at = positions_[i];
      list << at.x() << "," << at.y() << "," << at.z() << ",p" << i << ".exr\n";
      LatLongImage image{side, side, {}};
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          image.pixels.push_back(
              optics(at, (x + 0.5) * 2 / side - 1, 1 - (y + 0.5) * 2 / side).cast<float>());
      ASSERT_TRUE(write_environment(path("p" + std::to_string(i) + ".exr"), image));
    }
  }
  [[nodiscard]] ProcessResult build(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"field",    "build",       path("probes.csv"), "--grid", "5,5,5",
                                          "--bounds", "0,0,0,1,1,1", "--directions",     "800",    "--degree",
                                          "3",        "--out",       path("f.vdb"),      "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return lightwell(arguments);
  }
  // Relative RMS error of the harmonics at places of the field.
  [[nodiscard]] double error_of(const AnalyticField& truth, const std::vector<std::string>& options) const {
    const auto built = build(options);
    EXPECT_EQ(built.exit_code, 0) << built.err;
    double error = 0, norm = 0;
    for (const Vec3d& at : random_positions(6, 3, -0.1)) {
      const std::string place =
          std::to_string(at.x()) + "," + std::to_string(at.y()) + "," + std::to_string(at.z());
      const auto asked = lightwell({"field", "query", path("f.vdb"), "--at", place, "--json"});
      EXPECT_EQ(asked.exit_code, 0) << asked.err;
      const auto sh = nlohmann::json::parse(asked.out).at("sh");
      const Eigen::MatrixXd exact = exact_harmonics(truth, at, 3, 20000);
      for (Eigen::Index i = 0; i < exact.rows(); ++i)
        for (Eigen::Index c = 0; c < 3; ++c) {
          const double found = sh[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
          error += (found - exact(i, c)) * (found - exact(i, c));
          norm += exact(i, c) * exact(i, c);
        }
    }
    return std::sqrt(error / norm);
  }
  std::vector<Vec3d> positions_;
};

// A mirror ball of 15 cm whose camera stands 60 cm from its centre on +Z, traced ray by ray.
Rgbd ball_from_near(const Vec3d& at, double x, double y) {
  constexpr double kRadius = 0.15, kDistance = 0.6;
  // A pixel that the rim crosses shows what is inside: its middle may lie beside the ball.
  if (const double rho = std::hypot(x, y); rho > 0.9999) x *= 0.9999 / rho, y *= 0.9999 / rho;
  const double rim = kRadius / std::sqrt(kDistance * kDistance - kRadius * kRadius);
  const Vec3d camera(0, 0, kDistance), ray = Vec3d(x * rim, y * rim, -1).normalized();
  const double b = camera.dot(ray), c = camera.squaredNorm() - kRadius * kRadius;
  const Vec3d hit = camera + (-b - std::sqrt(std::max(0.0, b * b - c))) * ray;
  const Vec3d normal = hit / kRadius;
  return linear_field(at + hit, (ray - 2 * ray.dot(normal) * normal).normalized());
}

TEST_F(FieldProbesTest, AMirrorBallHasNoSingleViewpointWhichItsRadiusAndCameraTell) {
  write_probes(60, 96, ball_from_near);
  const double known = error_of(
      linear_field, {"--projection", "mirror-ball", "--ball-radius", "0.15", "--camera-distance", "0.6"});
  const double radius_alone =
      error_of(linear_field, {"--projection", "mirror-ball", "--ball-radius", "0.15"});
  const double neither = error_of(linear_field, {"--projection", "mirror-ball"});
  EXPECT_LT(known, 0.02);
  EXPECT_GT(radius_alone, 2 * known)
      << "as if the camera were far away, directions are off by up to 14 degrees";
  EXPECT_GT(neither, radius_alone) << "as if all rays met in the ball's centre";
}

TEST_F(FieldProbesTest, AMirrorBallsPictureIsASquare) {
  write_probes(3, 96, ball_from_near);
  LatLongImage image{96, 48, {}};
  image.pixels.resize(std::size_t{96} * 48, Rgb::Ones());
  ASSERT_TRUE(write_environment(path("p0.exr"), image));
  const auto refused = build({"--projection", "mirror-ball"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err,
              HasSubstr("p0.exr: is 96x48 pixels, allowed for a mirror ball: a square, cropped to "
                        "the ball (within 2 %); 2:1 is a latitude-longitude image"));
}

TEST_F(FieldProbesTest, AFisheyeGivesTheUpperHemisphereOfTheField) {
  Calibration calibration;
  calibration.response.model = LinearResponse{};
  calibration.lens.image_size = {96, 96};
  calibration.lens.focal = {30, 30};
  calibration.lens.center = {47.5, 47.5};
  const Status lens = write_calibration(path("calibration"), calibration);
  ASSERT_TRUE(lens) << lens.error().message;
  write_probes(60, 96, [&](const Vec3d& at, double x, double y) -> Rgbd {
    const Vec2d pixel((x + 1) * 48 - 0.5, (1 - y) * 48 - 0.5);
    if (calibration.lens.theta_rad(pixel) > kPi / 2 + 0.1) return Rgbd::Zero();
    return linear_field(at, world_from_camera(calibration.lens.unproject(pixel)));
  });
  const AnalyticField upper = [](const Vec3d& at, const Vec3d& toward) -> Rgbd {
    return toward.y() < 0 ? Rgbd(Rgbd::Zero()) : linear_field(at, toward);
  };
  EXPECT_LT(error_of(upper, {"--projection", "fisheye", "--lens", path("calibration/lens.json")}), 0.02);
}

TEST_F(FieldProbesTest, AProbeThatContradictsTheOthersIsNamed) {
  const auto lat_long = [](const Vec3d& at, double x, double y) {
    return linear_field(at, direction_from_lat_long((x + 1) / 2, (1 - y) / 2));
  };
  write_probes(60, 32, lat_long);
  const auto good = build({});
  ASSERT_EQ(good.exit_code, 0) << good.err;
  EXPECT_EQ(good.err, "");
  EXPECT_EQ(nlohmann::json::parse(good.out)["inconsistent_probes"], 0);
  // Probe 12's picture is that of a darker time.
  LatLongImage image{32, 32, {}};
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x)
      image.pixels.push_back(
          (0.5 * lat_long(positions_[12], (x + 0.5) / 16 - 1, 1 - (y + 0.5) / 16)).cast<float>());
  ASSERT_TRUE(write_environment(path("p12.exr"), image));
  const auto built = build({});
  ASSERT_EQ(built.exit_code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("rays of 1 of 60 probes contradict those around them: "));
  EXPECT_THAT(built.err, HasSubstr("p12.exr at ("));
  const auto report = nlohmann::json::parse(built.out);
  EXPECT_EQ(report["inconsistent_probes"], 1);
  EXPECT_THAT(report["inconsistent"][0]["probe"].get<std::string>(), HasSubstr("p12.exr"));
  EXPECT_GT(report["inconsistent"][0]["share"], 0.34);
}

TEST_F(FieldProbesTest, DarknessIsSaid) {
  write_probes(9, 16, [](const Vec3d&, double, double) { return Rgbd(Rgbd::Zero()); });
  const auto built = build({});
  EXPECT_EQ(built.exit_code, 0) << built.err;
  EXPECT_THAT(built.err, HasSubstr("no probe has any light: the field is dark"));
}

}  // namespace
}  // namespace lightwell::test
