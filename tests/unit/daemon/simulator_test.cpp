// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <random>

#include "daemon/simulator/frame_generator.h"
#include "daemon/simulator/mains_light.h"
#include "daemon/simulator/probe_model.h"
#include "daemon/simulator/projector.h"
#include "daemon/simulator/scene.h"
#include "daemon/simulator/sensor.h"
#include "lighting/direction.h"
#include "lighting/orientation.h"

namespace lightwell::simulator {
namespace {

ProbeModel probe(const Scene& scene, int width, int height, PixelFormat format, double noise) {
  ProbeModel model;
  const int bits = significant_bits(format);
  model.format = {width, height, format};
  model.calibration.lens = default_lens(width, height);
  model.calibration.response = default_response(scene.brightest_cd_m2(), bits);
  model.calibration.flat = default_flat_field(width, height, bits, 1);
  model.noise_codes = noise;
  model.seed = 1;
  return model;
}

unsigned code_at(std::span<const std::byte> bytes, PixelFormat format, std::size_t i) {
  const auto b = [&](std::size_t k) { return std::to_integer<unsigned>(bytes[k]); };
  if (storage_bits(format) == 8) return b(i);
  if (storage_bits(format) == 16) return b(2 * i) | b(2 * i + 1) << 8;
  const std::size_t k = i / 2 * 3;
  return i % 2 == 0 ? b(k) | (b(k + 1) & 15) << 8 : b(k + 1) >> 4 | b(k + 2) << 4;
}

// What the default lens makes of every pixel. Exact solid angles take microseconds each, and every case of a test asks
// for the same ones.
struct PixelGeometry {
  double solid_angle_sr, theta_rad;
};
const std::vector<PixelGeometry>& default_geometry(int width, int height) {
  static std::map<std::pair<int, int>, std::vector<PixelGeometry>> known;
  std::vector<PixelGeometry>& pixels = known[{width, height}];
  if (pixels.empty()) {
    const Lens lens = default_lens(width, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        pixels.push_back(
            {lens.pixel_solid_angle_sr({x, y}), std::min(lens.theta_rad({x, y}), lens.max_theta_rad)});
  }
  return pixels;
}

// The calibration read back to front in double, pixel by pixel: an independent, slow decoder.
Rgbd decoded_illuminance(const ProbeModel& model, std::span<const std::byte> bytes, double exposure_us) {
  const Calibration& c = model.calibration;
  const bool bayer = is_bayer(model.format.pixel_format);
  const std::vector<PixelGeometry>& geometry = default_geometry(model.format.width, model.format.height);
  Rgbd sum = Rgbd::Zero();
  std::size_t i = 0;
  for (int y = 0; y < model.format.height; ++y)
    for (int x = 0; x < model.format.width; ++x, ++i) {
      const auto& [omega, theta] = geometry[i];
      if (omega <= 0) continue;
      const double code =
          code_at(bytes, model.format.pixel_format, i) - static_cast<double>(c.flat.offset_codes[i]);
      const double radiance = c.response.luminance_cd_m2(code) * c.response.reference_exposure_us /
                              exposure_us / c.flat.transmission(theta);
      if (!bayer)
        sum += radiance * omega;
      else
        sum[(x & 1) + (y & 1)] += radiance * omega * (((x ^ y) & 1) != 0 ? 2 : 4);
    }
  return sum;
}

LatLongImage black_image(int width, int height) {
  return {width, height,
          std::vector<Rgb>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), Rgb::Zero())};
}

void expect_close(const Rgbd& got, const Rgbd& want, double relative, const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(got[c], want[c], relative * want[c] + 1e-12) << what << ", channel " << c;
}

double plane_sum(const Projector& projector, std::span<const float> plane) {
  double sum = 0;
  for (std::size_t i = 0; i < plane.size(); ++i)
    sum += static_cast<double>(plane[i]) * static_cast<double>(projector.solid_angles()[i]);
  return sum;
}

// ---- projection ----

TEST(Projector, ARayKeepsItsEnergyAtPoleHorizonSeamAndAnywhere) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  for (const auto& [width, height] : {std::pair(64, 48), {33, 47}, {1, 1}, {2, 3}}) {
    const Projector projector(default_lens(width, height), false);
    std::vector<Spherical> where = {
        {0, 0}, {kPi / 2 - 1e-9, 0}, {kPi / 2 - 1e-9, kPi}, {1, 1e-12}, {1, 2 * kPi - 1e-12}};
    for (int i = 0; i < 500; ++i) where.push_back({kPi / 2 * unit(random), 2 * kPi * unit(random)});
    for (const Spherical& s : where) {
      std::vector<float> plane(projector.pixels(), 0.0f);
      projector.add_ray(direction_from_spherical(s), Rgbd::Constant(1000), plane);
      // Floats: up to four additions, each rounded to 6e-8.
      EXPECT_NEAR(plane_sum(projector, plane), 1000, 1000 * 1e-6)
          << s.theta_rad << " " << s.lambda_rad << " " << width;
    }
  }
}

TEST(Projector, ARayStaysWithinAPixelOfItsImage) {
  const Projector projector(default_lens(64, 48), false);
  const Vec3d direction = direction_from_spherical({0.7, 2.1});
  const Vec2d at = projector.lens().project(camera_from_world(direction));
  std::vector<float> plane(projector.pixels(), 0.0f);
  projector.add_ray(direction, Rgbd::Constant(1), plane);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      if (std::abs(x - at.x()) >= 1 || std::abs(y - at.y()) >= 1) {
        EXPECT_EQ(plane[static_cast<std::size_t>(y * 64 + x)], 0.0f);
      }
}

TEST(Projector, EveryBayerSiteGetsTheWholeOfItsChannel) {
  const Projector projector(default_lens(64, 48), true);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    std::vector<float> plane(projector.pixels(), 0.0f);
    projector.add_ray(direction_from_spherical({1.5 * unit(random), 6 * unit(random)}), Rgbd(10, 20, 30),
                      plane);
    double site[4] = {};
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x) {
        const auto k = static_cast<std::size_t>(y * 64 + x);
        site[(y & 1) * 2 + (x & 1)] +=
            4 * static_cast<double>(plane[k]) * static_cast<double>(projector.solid_angles()[k]);
      }
    EXPECT_NEAR(site[0], 10, 1e-4);
    EXPECT_NEAR(site[1], 20, 2e-4);
    EXPECT_NEAR(site[2], 20, 2e-4);
    EXPECT_NEAR(site[3], 30, 3e-4);
  }
}

TEST(Projector, AnEvenSkyIsEvenAndExactInSum) {
  LatLongImage sky = black_image(100, 50);
  for (Rgb& p : sky.pixels) p = Rgb::Constant(5);
  const Projector projector(default_lens(320, 240), false);
  for (const bool smooth : {true, false}) {
    const std::vector<float> plane = projector.project({sky, smooth});
    EXPECT_NEAR(plane_sum(projector, plane), 5 * 2 * kPi, 5 * 2 * kPi * 1e-5)
        << smooth;  // float sums of 5e4 values
    const Vec2d center = projector.lens().center;
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x)
        if ((Vec2d(x, y) - center).norm() < 114) {  // rays near the border are kept inside, which is
          // not even; elsewhere rays closer than pixels leave a pattern of 1 %
          EXPECT_NEAR(plane[static_cast<std::size_t>(y * 320 + x)], 5, 5 * 0.01)
              << smooth << " " << x << " " << y;
        }
  }
}

TEST(Projector, OneBurningPixelKeepsItsEnergyWhereverItIs) {
  for (const bool bayer : {false, true}) {
    const Projector projector(default_lens(160, 120), bayer);
    for (const auto& [x, y] : {std::pair(0, 0), {511, 10}, {256, 127}, {0, 127}, {100, 64}, {300, 90}}) {
      LatLongImage image = black_image(512, 256);
      image.at(x, y) = Rgb::Constant(1e8f);
      const double energy = hemisphere_illuminance(image)[0];
      EXPECT_NEAR(energy, 1e8 * image.pixel_solid_angle_sr(y), energy * 1e-9);
      const std::vector<float> plane = projector.project({image, false});
      EXPECT_NEAR(plane_sum(projector, plane), energy, energy * (bayer ? 2e-2 : 1e-5))
          << x << " " << y;  // Bayer sites stand for four pixels, whose solid angles differ across a quad
    }
  }
}

TEST(Projector, AnImageOfOneRowCoversTheHemisphereExactly) {
  LatLongImage image = black_image(3, 1);
  for (Rgb& p : image.pixels) p = Rgb::Constant(2);
  EXPECT_NEAR(hemisphere_illuminance(image)[1], 4 * kPi, 1e-9);
  const Projector projector(default_lens(31, 17), false);
  EXPECT_NEAR(plane_sum(projector, projector.project({image, false})), 4 * kPi, 4 * kPi * 1e-5);
}

// ---- a camera that is tilted ----

Lens tilted_lens(int size) {
  Lens lens = default_lens(size, size);
  lens.zenith = Vec3d(0.2, -0.3, 0.9).normalized();
  return lens;
}

TEST(Projector, ATiltedCameraSeesARayWhereItsLensHasIt) {
  const Projector projector(tilted_lens(64), false);
  const Lens& lens = projector.lens();
  // Straight up lies at the zenith's own image, the axis of the camera where the world has it.
  for (const auto& [direction, at] :
       {std::pair(Vec3d(Vec3d::UnitY()), lens.project(lens.zenith)),
        std::pair(Vec3d(world_from_camera_rotation(lens.zenith) * Vec3d::UnitZ()), lens.center)}) {
    std::vector<float> plane(projector.pixels(), 0.0f);
    projector.add_ray(direction, Rgbd::Constant(1000), plane);
    EXPECT_NEAR(plane_sum(projector, plane), 1000, 1000 * 1e-6);  // float sums of four
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        if (std::abs(x - at.x()) >= 1 || std::abs(y - at.y()) >= 1) {
          EXPECT_EQ(plane[static_cast<std::size_t>(y * 64 + x)], 0.0f) << x << " " << y;
        }
  }
}

TEST(Projector, ATiltedCameraSeesAnEvenSphereEvenlyAndABurningPixelWhole) {
  const Projector projector(tilted_lens(200), false);
  LatLongImage sphere = black_image(100, 50);
  for (Rgb& p : sphere.pixels) p = Rgb::Constant(5);
  for (const bool smooth : {true, false}) {
    const std::vector<float> plane = projector.project({sphere, smooth});
    // Interpolated it is the sky itself; rays leave a pattern of 1 % an axis (projector.cpp), and here the pixels' axes
    // lie across both of theirs.
    const double tolerance = smooth ? 1e-6 : 0.02;
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 200; ++x)
        if ((Vec2d(x, y) - projector.lens().center).norm() < 94) {
          EXPECT_NEAR(plane[static_cast<std::size_t>(y * 200 + x)], 5, 5 * tolerance) << smooth;
        }
  }
  for (const auto& [x, y] : {std::pair(0, 0), {511, 10}, {256, 100}, {100, 64}}) {
    LatLongImage image = black_image(512, 256);
    image.at(x, y) = Rgb::Constant(1e8f);
    const double energy = 1e8 * image.pixel_solid_angle_sr(y);
    const std::vector<float> plane = projector.project({image, false});
    EXPECT_NEAR(plane_sum(projector, plane), energy, energy * 1e-5) << x << " " << y;  // float sums
  }
}

// ---- discs ----

TEST(DiscLight, SamplesCentreOnTheDirectionAndStayInside) {
  const DiscLight light{Vec3d(1, 2, 3).normalized(), 0.05, Rgbd::Ones()};
  Vec3d mean = Vec3d::Zero();
  for (const Vec3d& d : disc_samples(light, 1000)) {
    EXPECT_NEAR(d.norm(), 1, 1e-12);
    EXPECT_LT(std::acos(d.dot(light.direction)), 0.05);
    mean += d / 1000;
  }
  EXPECT_GT(mean.normalized().dot(light.direction), 1 - 1e-6);
}

TEST(DiscLight, PartAboveTheHorizonAgreesWithCounting) {
  for (const double elevation : {-0.03, -0.01, 0.0, 0.004, 0.019, 0.05}) {
    const DiscLight light{Vec3d(std::cos(elevation), std::sin(elevation), 0), 0.02, Rgbd::Ones()};
    int above = 0;
    for (const Vec3d& d : disc_samples(light, 20000)) above += d.y() > 0;
    EXPECT_NEAR(part_above_horizon(light), above / 20000.0, 2e-3) << elevation;  // 20000 evenly spread points
  }
}

// ---- scenes ----

class Scenario : public testing::TestWithParam<const char*> {};

// Small pictures: lamps and sun on few pixels are the harder case.
TEST_P(Scenario, DecodesToItsStatedTotalWithinOnePerCent) {
  const auto scene = *make_scenario(GetParam());
  for (const PixelFormat format : {PixelFormat::mono12, PixelFormat::bayer_rg12, PixelFormat::mono16})
    for (const double noise : {0.0, 1.0}) {
      const ProbeModel model = probe(*scene, 320, 240, format, noise);
      FrameGenerator generator(scene, model);
      std::vector<std::byte> frame(model.format.bytes());
      const double exposure_us = scene->default_exposure_us();
      for (const double t : {0.05, 7.3}) {
        const FrameTruth truth = generator.render(t, exposure_us, 3, format, frame);
        // What the issue asks of the whole chain, half of it left for the rest of the chain.
        expect_close(decoded_illuminance(model, frame, exposure_us), truth.total_illuminance,
                     noise > 0 ? 0.01 : 0.005, std::string(GetParam()) + " " + std::string(name(format)));
      }
    }
}

TEST_P(Scenario, IsBrightestWhereItSaysAndNeverNegative) {
  const auto scene = *make_scenario(GetParam());
  for (const double t : {0.0, 12.3, 101.0}) {
    const SceneMoment moment = scene->at(t, t + 0.01);
    for (const auto& part : moment.parts) {
      EXPECT_GE(part.weight, 0);
      for (const Rgb& p : scene->layer(part.layer).image.pixels) {
        ASSERT_TRUE((p >= 0).all());
        ASSERT_LE(static_cast<double>(p.maxCoeff()), scene->brightest_cd_m2());
      }
    }
    for (const DiscLight& light : moment.lights) {
      EXPECT_NEAR(light.direction.norm(), 1, 1e-9);
      EXPECT_GT(light.direction.y(), 0);
      const double s = std::sin(light.angular_radius_rad / 2);
      EXPECT_LE(light.illuminance.maxCoeff() / (4 * kPi * s * s), scene->brightest_cd_m2());
    }
  }
}

TEST_P(Scenario, ShowsNoClippedPixel) {
  const auto scene = *make_scenario(GetParam());
  const ProbeModel model = probe(*scene, 320, 240, PixelFormat::mono12, 1);
  FrameGenerator generator(scene, model);
  std::vector<std::byte> frame(model.format.bytes());
  for (const double t : {0.1, 5.0, 20.0}) {
    generator.render(t, scene->default_exposure_us(), 0, PixelFormat::mono12, frame);
    for (std::size_t i = 0; i < 320 * 240; ++i) ASSERT_LT(code_at(frame, PixelFormat::mono12, i), 4095u);
  }
}

INSTANTIATE_TEST_SUITE_P(Simulator, Scenario, testing::Values("day", "studio", "flicker", "walk", "static"),
                         [](const auto& scenario) { return std::string(scenario.param); });

TEST(Scenes, UnknownNameIsUsageAndNamesTheAllowedOnes) {
  const auto made = make_scenario("night");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::usage);
  EXPECT_NE(made.error().message.find("flicker"), std::string::npos);
}

TEST(Scenes, StaticNeverChangesAndTheOthersDo) {
  const auto lights_at = [](const char* name, double t) {
    const SceneMoment m = (*make_scenario(name))->at(t, t + 0.004);
    double sum = 0;
    for (const DiscLight& l : m.lights)
      sum += l.illuminance.sum() * (1 + l.direction.x() + 2 * l.direction.z());
    return sum;
  };
  EXPECT_EQ(lights_at("static", 0), lights_at("static", 11.7));
  for (const char* moving : {"day", "studio", "flicker", "walk"})
    EXPECT_NE(lights_at(moving, 0), lights_at(moving, 11.7));
}

TEST(Scenes, TheSunHasTheRealSunsStrength) {
  const auto scene = make_day_scene();
  double strongest = 0;
  for (double t = 0; t < 90; t += 0.5)
    strongest = std::max(strongest, luminance(scene->at(t, t + 0.01).lights[0].illuminance));
  EXPECT_GT(strongest, 8e4);  // clear noon sun, facing it: about 100 klx (CIE 85: 90 to 110)
  EXPECT_LT(strongest, 1.1e5);
}

TEST(Flicker, MeansAreOneOverWholePeriodsAndFollowTheShapeInBetween) {
  EXPECT_NEAR(mean_of_cosine(100, 0.9, 3.2, 3.25), 1, 1e-9);
  EXPECT_NEAR(mean_of_pulses(250, 0.3, 3.2, 3.24), 1, 1e-9);
  EXPECT_NEAR(mean_of_cosine(100, 0.9, 0, 1e-6), 0.1, 1e-6);
  EXPECT_NEAR(mean_of_pulses(250, 0.25, 0, 0.001), 4, 1e-9);
  EXPECT_NEAR(mean_of_pulses(250, 0.25, 0.0011, 0.0039), 0, 1e-9);
  double sum = 0;  // against summing the curve itself
  for (int i = 0; i < 1000; ++i) sum += 1 - 0.4 * std::cos(2 * kPi * 120 * (0.5 + 0.004 * (i + 0.5) / 1000));
  EXPECT_NEAR(mean_of_cosine(120, 0.4, 0.5, 0.504), sum / 1000, 1e-5);
}

TEST(Scenes, ImagesAreShownInTurn) {
  LatLongImage dark = black_image(4, 2), bright = black_image(4, 2);
  for (Rgb& p : bright.pixels) p = Rgb::Constant(1);
  const auto scene = make_image_scene({dark, bright}, 2);
  for (const auto& [t, id] : {std::pair(0.5, 0), {2.5, 1}, {4.5, 0}, {7.0, 1}})
    EXPECT_EQ(scene->at(t, t + 0.01).parts[0].layer, id);
}

// ---- environment images: eight decades, a sun, nothing at all ----

TEST(EnvironmentFrames, EightDecadesDecodeToTheirTotal) {
  LatLongImage image = black_image(256, 128);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = Rgb(0.5f, 0.7f, 1.1f) * (1 + 0.3f * std::sin(0.01f * static_cast<float>(i)));
  image.at(77, 40) = Rgb(1.0e8f, 0.9e8f, 0.7e8f) * 0.05f;
  const auto scene = make_image_scene({image}, 1);
  for (const PixelFormat format : {PixelFormat::mono12, PixelFormat::bayer_rg12}) {
    const ProbeModel model = probe(*scene, 640, 480, format, 0);
    FrameGenerator generator(scene, model);
    std::vector<std::byte> frame(model.format.bytes());
    const FrameTruth truth = generator.render(0.5, 10000, 0, format, frame);
    expect_close(decoded_illuminance(model, frame, 10000), truth.total_illuminance, 0.005,
                 std::string(name(format)));
  }
}

TEST(EnvironmentFrames, BlackIsBlack) {
  const auto scene = make_image_scene({black_image(2, 1)}, 1);
  const ProbeModel model = probe(*scene, 31, 17, PixelFormat::mono12, 0);
  FrameGenerator generator(scene, model);
  std::vector<std::byte> frame(model.format.bytes());
  const FrameTruth truth = generator.render(0.5, 10000, 0, PixelFormat::mono12, frame);
  EXPECT_EQ(truth.total_illuminance.sum(), 0);
  for (std::size_t i = 0; i < 31 * 17; ++i)
    EXPECT_NEAR(code_at(frame, PixelFormat::mono12, i), 64 + model.calibration.flat.offset_codes[i], 0.51);
}

// Sun, windows, night, studio, overcast: what the camera shows is what the image holds.
class RealMaps : public testing::TestWithParam<const char*> {};

TEST_P(RealMaps, DecodeToTheirTotalPerChannel) {
  const std::filesystem::path file = std::filesystem::path(LIGHTWELL_TEST_DATA) / "env" / GetParam();
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
  std::vector<std::string> messages;
  const auto scene = make_environment_scene({file}, 5, messages);
  ASSERT_TRUE(scene) << scene.error().message;
  const Rgbd exact = hemisphere_illuminance((*scene)->layer(0).image);
  for (const PixelFormat format : {PixelFormat::mono12, PixelFormat::bayer_rg12}) {
    const ProbeModel model = probe(**scene, 640, 480, format, 1);
    FrameGenerator generator(*scene, model);
    std::vector<std::byte> frame(model.format.bytes());
    const FrameTruth truth = generator.render(0.5, 10000, 0, format, frame);
    expect_close(truth.total_illuminance, is_bayer(format) ? exact : Rgbd(Rgbd::Constant(luminance(exact))),
                 1e-9, "truth");
    // One code is half a per cent of a pixel, and a sun is few pixels; the rest averages out.
    expect_close(decoded_illuminance(model, frame, 10000), truth.total_illuminance, 0.01,
                 std::string(name(format)));
  }
}

INSTANTIATE_TEST_SUITE_P(Environments, RealMaps,
                         testing::Values("StinsonBeach.hdr", "noon_grass_1k.hdr", "rooitou_park_1k.hdr",
                                         "st_fagans_interior_1k.hdr", "dikhololo_night_1k.hdr",
                                         "studio_small_03_1k.hdr", "potsdamer_platz_1k.hdr",
                                         "StageEnvLatLong.exr", "spot1Lux_1k.hdr"));

// ---- sensor ----

TEST(Sensor, CodesAreTheResponseRoundedToTheNearest) {
  ProbeModel model;
  model.format = {256, 16, PixelFormat::mono12};
  model.calibration.lens = default_lens(256, 16);
  model.calibration.response = default_response(1e6, 12);
  model.noise_codes = 0;
  Sensor sensor(model);
  std::vector<float> plane(256 * 16);
  for (std::size_t i = 0; i < plane.size(); ++i) plane[i] = std::exp(static_cast<float>(i) / 150 - 10);
  plane[0] = 0;
  std::vector<std::byte> frame(model.format.bytes());
  sensor.encode(plane, 10000, 0, PixelFormat::mono12, frame);
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const double ideal =
        std::clamp(model.calibration.response.code(static_cast<double>(plane[i])), 0.0, 4095.0);
    EXPECT_NEAR(code_at(frame, PixelFormat::mono12, i), ideal,
                0.502);  // rounding, and 2e-3 of float arithmetic
  }
}

TEST(Sensor, FormatsHoldTheSameLightAtTheirOwnDepth) {
  const auto scene = make_studio_scene(false);
  for (const PixelFormat format :
       {PixelFormat::mono8, PixelFormat::mono10, PixelFormat::mono12p, PixelFormat::mono16}) {
    const ProbeModel model = probe(*scene, 160, 120, PixelFormat::mono12, 0);
    FrameGenerator generator(scene, model);
    std::vector<std::byte> reference(model.format.bytes());
    generator.render(0, 10000, 0, PixelFormat::mono12, reference);
    FrameFormat other = model.format;
    other.pixel_format = format;
    std::vector<std::byte> frame(other.bytes());
    generator.render(0, 10000, 0, format, frame);
    const double scale = std::ldexp(1.0, significant_bits(format) - 12);
    for (std::size_t i = 0; i < 160 * 120; ++i)
      EXPECT_NEAR(code_at(frame, format, i), code_at(reference, PixelFormat::mono12, i) * scale,
                  0.51 + 0.51 * scale);
  }
}

TEST(Sensor, PacksTwelveBitsLeastSignificantFirst) {
  const std::uint16_t codes[4] = {0xabc, 0x123, 0xfff, 0x001};
  std::byte out[6];
  pack_codes(codes, PixelFormat::mono12p, out);
  const unsigned expected[6] = {0xbc, 0x3a, 0x12, 0xff, 0x1f, 0x00};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(std::to_integer<unsigned>(out[i]), expected[i]);
}

TEST(Sensor, NoiseHasTheStatedSpreadAndFollowsTheSeed) {
  const auto scene = make_studio_scene(false);
  ProbeModel model = probe(*scene, 160, 120, PixelFormat::mono16, 0);
  const auto frame_of = [&](double noise, std::uint64_t seed, std::uint64_t index) {
    model.noise_codes = noise;
    model.seed = seed;
    FrameGenerator generator(scene, model);
    std::vector<std::byte> frame(model.format.bytes());
    generator.render(0, 10000, index, PixelFormat::mono16, frame);
    return frame;
  };
  const auto clean = frame_of(0, 1, 0), noisy = frame_of(2, 1, 0);
  EXPECT_EQ(noisy, frame_of(2, 1, 0));
  EXPECT_NE(noisy, frame_of(2, 2, 0));
  EXPECT_NE(noisy, frame_of(2, 1, 1));
  EXPECT_EQ(clean, frame_of(0, 2, 5));
  double sum = 0, square = 0;
  const std::size_t n = 160 * 120;
  for (std::size_t i = 0; i < n; ++i) {
    const double d = (static_cast<double>(code_at(noisy, PixelFormat::mono16, i)) -
                      code_at(clean, PixelFormat::mono16, i)) /
                     16;
    sum += d;
    square += d * d;
  }
  const double mean = sum / static_cast<double>(n);
  EXPECT_NEAR(mean, 0, 5 * 2 / std::sqrt(n));  // five standard errors
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(n) - mean * mean), 2, 5 * 2 / std::sqrt(2.0 * n));
}

TEST(ProbeModel, CalibrationIsValidAtEveryDepthAndSize) {
  for (const int bits : {8, 10, 12, 16})
    for (const double brightest : {0.0, 1e-3, 7e5, 2e9, 1e30}) {
      const Response response = default_response(brightest, bits);
      EXPECT_TRUE(check(response)) << bits << " " << brightest;
      if (brightest > 0 && brightest < 1e15) {
        EXPECT_LT(response.code(brightest), response.clip_code);
      }
    }
  for (const auto& [width, height] : {std::pair(1, 1), {640, 480}, {31, 17}, {1024, 1024}}) {
    const Lens lens = default_lens(width, height);
    EXPECT_TRUE(check(lens));
    EXPECT_TRUE(check(default_flat_field(width, height, 12, 1), lens));
  }
}

}  // namespace
}  // namespace lightwell::simulator
