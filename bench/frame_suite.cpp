// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Raw fisheye frame → calibrated polar map: ours for each instruction set, OpenCV's usual chain, and memcpy
// as the unit.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "bench/suite.h"
#include "lighting/radiometer.h"
#include "lighting/radiometer/aligned.h"
#include "lighting/radiometer/kernel.h"
#include "tests/support/reference_radiometer.h"

namespace lightwell::bench {
namespace {

using test::pack;
using test::ReferenceMap;
using test::ReferenceRadiometer;
using Codes = std::vector<std::uint16_t>;

constexpr std::size_t kFramesInTurnBytes =
    32u << 20;  // more than a second level cache, as a camera's buffers are

// A hemisphere in the largest circle of the image, 23 octaves in 12 bits, fixed pattern, vignetting.
Calibration make_camera(int width, int height) {
  Calibration c;
  c.lens = {{width, height},
            Vec2d::Constant(std::min(width, height) / kPi),
            {(width - 1) / 2.0, (height - 1) / 2.0},
            {0, 0, 0, 0},
            kPi / 2};
  const double b = 4096 / (23 * std::log(2.0));
  c.response = {LogResponse{10 / 23.0 * 4096, b, 0}, 12, 64, 4095, 10000};
  c.flat.image_size = c.lens.image_size;
  std::mt19937 random(1);
  std::normal_distribution<float> pattern(0, 12);
  for (int i = 0; i < width * height; ++i) c.flat.offset_codes.push_back(std::round(pattern(random)));
  c.flat.vignetting = {-0.12, 0.01, -0.002};
  return c;
}

// Slow waves, noise, and a sun of a few clipped pixels that moves from frame to frame.
Codes make_frame(const Calibration& c, int frame) {
  const int width = c.lens.image_size[0];
  const int height = c.lens.image_size[1];
  std::mt19937 random(static_cast<unsigned>(frame));
  std::uniform_int_distribution<int> noise(0, 63);
  const Vec2d sun = c.lens.center + Vec2d(0.2 * height + 7 * frame % 50, -0.25 * height);
  Codes codes;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double code =
          (0.35 + 0.12 * std::sin(x * 0.011 + frame) + 0.1 * std::cos(y * 0.017)) * 4096 + noise(random);
      if ((Vec2d(x, y) - sun).squaredNorm() < 3) code = 4096;
      code += static_cast<double>(c.flat.offset_codes[codes.size()]);
      codes.push_back(static_cast<std::uint16_t>(std::clamp(code, 80.0, 4095.0)));
    }
  return codes;
}

double worst_error(const PolarMap& map, const ReferenceMap& reference) {
  double worst = 0;
  const std::size_t n = map.grid.size();
  for (std::size_t c = 0; c < static_cast<std::size_t>(map.channels); ++c)
    for (std::size_t b = 0; b < n; ++b)
      if (reference.solid_angle_sr[b] > 0)
        worst = std::max(
            worst, std::abs(static_cast<double>(map.radiance[c * n + b]) / reference.radiance[c][b] - 1));
  return worst;
}

// Frames of one camera and format in the camera's bytes.
struct Footage {
  Calibration calibration;
  FrameFormat format;
  std::vector<Codes> codes;                   // the distinct frames
  std::vector<std::vector<std::byte>> bytes;  // as many copies as fill the cache

  Footage(int width, int height, PixelFormat pixel_format)
      : calibration(make_camera(width, height)), format{width, height, pixel_format} {
    for (int i = 0; i < 2; ++i) codes.push_back(make_frame(calibration, i));
    const std::size_t count = std::max<std::size_t>(4, kFramesInTurnBytes / format.bytes());
    for (std::size_t i = 0; i < count; ++i) bytes.push_back(pack(codes[i % 2], format));
  }
  [[nodiscard]] const std::vector<std::byte>& at(std::size_t i) const { return bytes[i % bytes.size()]; }
};

// Sun pixels at which energy is compared: across the field and over every position against the sampling grid.
std::vector<std::pair<int, int>> sun_places(const Calibration& c) {
  std::vector<std::pair<int, int>> places;
  const double radius = 0.98 * c.lens.focal.x() * kPi / 2;
  for (int i = 0; i < 24; ++i) {
    const double r = radius * std::sqrt((i + 0.5) / 24);
    const Vec2d at = c.lens.center + r * Vec2d(std::cos(2.4 * i), std::sin(2.4 * i));
    places.emplace_back(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
  }
  return places;
}

// Largest relative error of what a sun of one pixel adds to the map's total.
double sun_energy_error(const Footage& footage, const ReferenceRadiometer& reference,
                        const std::function<double(const Codes&)>& total) {
  const Codes dark(footage.codes[0].size(), 200);
  const double before = total(dark);
  double worst = 0;
  for (const auto& [x, y] : sun_places(footage.calibration)) {
    Codes codes = dark;
    codes[static_cast<std::size_t>(y * footage.format.width + x)] = 4000;
    const double expected = reference.pixel_radiance(codes, x, y) * reference.solid_angle_sr(x, y);
    worst = std::max(worst, std::abs((total(codes) - before) / expected - 1));
  }
  return worst;
}

// The truth about a footage's first frame; slow, so once for all cases.
struct Truth {
  ReferenceRadiometer radiometer;
  ReferenceMap map;
  explicit Truth(const Footage& footage)
      : radiometer(footage.calibration, footage.format, {}),
        map(radiometer.develop(footage.codes[0], 10000)) {}
};

Case lightwell_case(const Footage& footage, const Truth& truth, Isa isa, const std::string& name, bool sun) {
  auto made = Radiometer::create(footage.calibration, footage.format, {{}, isa});
  verify_bug(made.ok(), "bench camera refused");
  const auto radiometer = std::make_shared<Radiometer>(std::move(made).value());
  const auto map = std::make_shared<PolarMap>(radiometer->make_map());
  radiometer->develop(footage.at(0), 10000, *map);
  Case out{name, {}, {{"max_relative_error", worst_error(*map, truth.map)}}};
  if (sun)
    out.values.emplace_back("one_pixel_sun_error",
                            sun_energy_error(footage, truth.radiometer, [&](const Codes& codes) {
                              radiometer->develop(pack(codes, footage.format), 10000, *map);
                              return total_illuminance(*map)[0];
                            }));
  out.run = [&footage, radiometer, map](std::size_t i) { radiometer->develop(footage.at(i), 10000, *map); };
  return out;
}

// Decoding alone: codes to weighted radiance, nothing summed.
Case response_case(const Footage& footage, Isa isa) {
  const auto width = static_cast<std::size_t>(footage.format.width);
  auto attenuation = std::make_shared<radiometer::AlignedVector<std::uint16_t>>();
  attenuation->assign(footage.codes[0].size(), 1000);
  auto row = std::make_shared<radiometer::AlignedVector<float>>(width, 0.0f);
  return {"response only, " + std::string(name(isa)),
          [&footage, attenuation, row, width, isa](std::size_t i) {
            const radiometer::LogCurve curve{4095, 47104, 18000, 4};
            const auto decode =
                radiometer::kernels(isa)->decode[static_cast<std::size_t>(radiometer::Storage::u16)];
            for (std::size_t y = 0; y < static_cast<std::size_t>(footage.format.height); ++y)
              decode(footage.at(i).data() + 2 * y * width, attenuation->data() + y * width, row->data(),
                     width, curve);
          },
          {}};
}

// What one would write with OpenCV: subtract the pattern, exponential, multiply by gain, remap linearly to
// the map.
class OpenCvChain {
 public:
  explicit OpenCvChain(const Calibration& c) : width_(c.lens.image_size[0]), height_(c.lens.image_size[1]) {
    const auto& model = std::get<LogResponse>(c.response.model);
    scale_ = 1 / model.b;
    shift_ = -model.a / model.b;
    offsets_ = cv::Mat(height_, width_, CV_16S);
    gain_ = cv::Mat(height_, width_, CV_32F);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        offsets_.at<std::int16_t>(y, x) =
            static_cast<std::int16_t>(c.flat.offset_codes[static_cast<std::size_t>(y * width_ + x)]);
        const double theta = std::min(c.lens.theta_rad(Vec2d(x, y)), kPi / 2);
        gain_.at<float>(y, x) = static_cast<float>(1 / c.flat.transmission(theta));
      }
    cv::Mat map_x(grid_.rings, grid_.sectors, CV_32F);
    cv::Mat map_y = map_x.clone();
    for (int ring = 0; ring < grid_.rings; ++ring)
      for (int sector = 0; sector < grid_.sectors; ++sector) {
        const Vec2d pixel = c.lens.project(camera_from_world(grid_.bin_direction(ring, sector)));
        map_x.at<float>(ring, sector) = static_cast<float>(pixel.x());
        map_y.at<float>(ring, sector) = static_cast<float>(pixel.y());
      }
    cv::convertMaps(map_x, map_y, fixed_, fraction_, CV_16SC2);
  }
  void respond(const std::byte* frame) {
    const cv::Mat raw(height_, width_, CV_16U, const_cast<std::byte*>(frame));
    cv::subtract(raw, offsets_, difference_, cv::noArray(), CV_32F);
    difference_.convertTo(difference_, CV_32F, scale_, shift_);
    cv::exp(difference_, radiance_);
    cv::multiply(radiance_, gain_, radiance_);
  }
  PolarMap& develop(const std::byte* frame) {
    respond(frame);
    cv::Mat out(grid_.rings, grid_.sectors, CV_32F, map_.radiance.data());
    cv::remap(radiance_, out, fixed_, fraction_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    return map_;
  }

 private:
  int width_, height_;
  double scale_, shift_;
  PolarGrid grid_;
  PolarMap map_ = PolarMap::make(grid_, 1);
  cv::Mat offsets_, gain_, fixed_, fraction_, difference_, radiance_;
};

std::vector<Row> mono_rows(int width, int height, const Options& options) {
  const Footage footage(width, height, PixelFormat::mono12);
  const Footage packed(width, height, PixelFormat::mono12p);
  const Footage bayer(width, height, PixelFormat::bayer_rg12);
  const Truth truth(footage);
  const Truth bayer_truth(bayer);
  std::vector<std::byte> copy(footage.format.bytes());
  const Isa fastest = available_isas().front();
  std::vector<Case> cases;
  cases.push_back({"memcpy",
                   [&](std::size_t i) { std::memcpy(copy.data(), footage.at(i).data(), copy.size()); },
                   {{"bytes", static_cast<double>(copy.size())}}});
  cases.push_back(response_case(footage, fastest));
  for (const Isa isa : available_isas())
    cases.push_back(
        lightwell_case(footage, truth, isa, "whole frame, " + std::string(name(isa)), isa == fastest));
  cases.push_back(lightwell_case(packed, truth, fastest, "Mono12p, " + std::string(name(fastest)), false));
  cases.push_back(
      lightwell_case(bayer, bayer_truth, fastest, "BayerRG12, " + std::string(name(fastest)), false));

  cv::setNumThreads(1);
  OpenCvChain opencv(footage.calibration);
  const double error = worst_error(opencv.develop(footage.at(0).data()), truth.map);
  const double sun = sun_energy_error(footage, truth.radiometer, [&](const Codes& codes) {
    const auto frame = pack(codes, footage.format);
    return total_illuminance(opencv.develop(frame.data()))[0];
  });
  cases.push_back(
      {"OpenCV, response only", [&](std::size_t i) { opencv.respond(footage.at(i).data()); }, {}});
  cases.push_back({"OpenCV, whole frame",
                   [&](std::size_t i) { opencv.develop(footage.at(i).data()); },
                   {{"max_relative_error", error}, {"one_pixel_sun_error", sun}}});
  return time_in_turns(std::to_string(width) + "x" + std::to_string(height), std::move(cases), options,
                       "memcpy");
}

}  // namespace

std::vector<Row> frame_suite(const Options& options) {
  std::vector<Row> rows;
  for (const auto& [width, height] : {std::pair{640, 480}, {1024, 1024}, {2048, 2048}})
    for (Row& row : mono_rows(width, height, options)) rows.push_back(std::move(row));
  return rows;
}

}  // namespace lightwell::bench
