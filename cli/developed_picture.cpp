// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/developed_picture.h"

#include <algorithm>
#include <cmath>

#include "cli/command.h"
#include "field/frame_developer.h"
#include "lighting/direction.h"
#include "lighting/orientation.h"

namespace lightwell::cli {
namespace {

constexpr int kMostSide = 8192;

void put(DevelopedPicture& picture, std::size_t pixel, const Rgb& radiance) {
  float* out = picture.rgba.data() + 4 * pixel;
  std::copy_n(radiance.data(), 3, out);
  out[3] = 1;
}

void clear(DevelopedPicture& picture, int width, int height) {
  picture.width = width;
  picture.height = height;
  picture.rgba.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4, 0.0f);
}

Error size_error(const PictureSize& size, const std::string& allowed) {
  return usage("--size is " + std::to_string(size.width) + "x" + std::to_string(size.height) +
               ", allowed: " + allowed);
}

}  // namespace

struct PictureDeveloper::Painter {
  virtual ~Painter() = default;
  virtual void develop(std::span<const std::byte> codes, double exposure_us) = 0;
  DevelopedPicture picture;
};

namespace {

class LatLongPainter final : public PictureDeveloper::Painter {
 public:
  explicit LatLongPainter(FrameDeveloper developer) : developer_(std::move(developer)) {}
  void develop(std::span<const std::byte> codes, double exposure_us) override {
    const auto developed = developer_.develop(codes, exposure_us, Eigen::Quaterniond::Identity());
    const LatLongImage& image = developed.picture;
    clear(picture, image.width, image.height);
    double seen_sr = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Rgb& value = image.at(x, y);
        if (value.isNaN().any()) continue;
        put(picture,
            static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x),
            value);
        seen_sr += image.pixel_solid_angle_sr(y);
      }
    picture.coverage = seen_sr / (4 * kPi);
    picture.clipped_pixels = developed.clipped_pixels;
  }

 private:
  FrameDeveloper developer_;
};

// Every bin of a polar map is a pixel, or every pixel of the camera looks one up.
class MapPainter final : public PictureDeveloper::Painter {
 public:
  MapPainter(Radiometer radiometer, PictureSize size, std::vector<std::size_t> bin_of_pixel)
      : radiometer_(std::move(radiometer)),
        map_(radiometer_.make_map()),
        size_(size),
        bin_of_pixel_(std::move(bin_of_pixel)) {}
  void develop(std::span<const std::byte> codes, double exposure_us) override {
    radiometer_.develop(codes, exposure_us, map_);
    clear(picture, size_.width, size_.height);
    for (std::size_t p = 0; p < bin_of_pixel_.size(); ++p)
      if (bin_of_pixel_[p] < map_.grid.size()) put(picture, p, map_.rgb(bin_of_pixel_[p]));
    picture.coverage = static_cast<double>(map_.coverage);
    picture.clipped_pixels = map_.clipped_pixels;
  }

 private:
  Radiometer radiometer_;
  PolarMap map_;
  PictureSize size_;
  std::vector<std::size_t> bin_of_pixel_;  // map_.grid.size() and more: none
};

using Made = Result<std::unique_ptr<PictureDeveloper::Painter>>;

Made make_lat_long(const Calibration& calibration, const FrameFormat& format,
                   std::optional<PictureSize> size) {
  const PictureSize wanted = size.value_or(PictureSize{360, 180});
  if (wanted.height < 2 || wanted.height > kMostSide / 2 || wanted.width != 2 * wanted.height)
    return size_error(wanted, "twice as wide as high, 4x2 to 8192x4096");
  auto developer = FrameDeveloper::create(calibration, format, wanted.height);
  if (!developer) return developer.error();
  return Made(std::make_unique<LatLongPainter>(*std::move(developer)));
}

double theta_max_of(const Lens& lens) {
  return std::min(kPi, lens.max_theta_rad + std::acos(std::clamp(lens.zenith.z(), -1.0, 1.0)));
}

Made make_polar(const Calibration& calibration, const FrameFormat& format, std::optional<PictureSize> size) {
  const double theta_max_rad = theta_max_of(calibration.lens);
  const PictureSize wanted =
      size.value_or(PictureSize{360, std::max(1, static_cast<int>(std::lround(theta_max_rad * 180 / kPi)))});
  if (wanted.width < 4 || wanted.height < 1 || wanted.width > kMostSide || wanted.height > kMostSide)
    return size_error(wanted, "sectors x rings, 4x1 to 8192x8192");
  auto radiometer = Radiometer::create(calibration, format,
                                       {.grid = {wanted.height, wanted.width, theta_max_rad}, .isa = {}});
  if (!radiometer) return radiometer.error();
  std::vector<std::size_t> bins(static_cast<std::size_t>(wanted.width) *
                                static_cast<std::size_t>(wanted.height));
  for (std::size_t i = 0; i < bins.size(); ++i) bins[i] = i;
  return Made(std::make_unique<MapPainter>(*std::move(radiometer), wanted, std::move(bins)));
}

Made make_fisheye(const Calibration& calibration, const FrameFormat& format,
                  std::optional<PictureSize> size) {
  const Lens& lens = calibration.lens;
  const PictureSize own{lens.image_size[0], lens.image_size[1]};
  const PictureSize wanted = size.value_or(own);
  if (wanted.width < 1 || wanted.height < 1 || wanted.width > kMostSide || wanted.height > kMostSide)
    return size_error(wanted, "1x1 to 8192x8192");
  // Bins of a pixel on the axis.
  const double scale = std::max(static_cast<double>(wanted.width) / own.width,
                                static_cast<double>(wanted.height) / own.height);
  PolarGrid grid;
  grid.theta_max_rad = theta_max_of(lens);
  grid.rings =
      std::clamp(static_cast<int>(std::ceil(grid.theta_max_rad * lens.focal.maxCoeff() * scale)), 1, 4096);
  grid.sectors = std::min(4 * grid.rings, 8192);
  auto radiometer = Radiometer::create(calibration, format, {.grid = grid, .isa = {}});
  if (!radiometer) return radiometer.error();
  const Eigen::Matrix3d world_from_camera = world_from_camera_rotation(lens.zenith);
  std::vector<std::size_t> bins;
  for (int y = 0; y < wanted.height; ++y)
    for (int x = 0; x < wanted.width; ++x) {
      const Vec2d pixel((x + 0.5) * own.width / wanted.width - 0.5,
                        (y + 0.5) * own.height / wanted.height - 0.5);
      const Vec3d ray = lens.unproject(pixel);
      if (!(std::atan2(ray.head<2>().norm(), ray.z()) <= lens.max_theta_rad)) {
        bins.push_back(grid.size());
        continue;
      }
      const Spherical at = spherical_from_direction(world_from_camera * ray);
      const int ring =
          std::min(static_cast<int>(at.theta_rad / grid.theta_max_rad * grid.rings), grid.rings - 1);
      const int sector =
          static_cast<int>(std::floor(at.lambda_rad / (2 * kPi) * grid.sectors) + grid.sectors) %
          grid.sectors;
      bins.push_back(static_cast<std::size_t>(ring) * static_cast<std::size_t>(grid.sectors) +
                     static_cast<std::size_t>(sector));
    }
  return Made(std::make_unique<MapPainter>(*std::move(radiometer), wanted, std::move(bins)));
}

}  // namespace

PictureDeveloper::PictureDeveloper(std::unique_ptr<Painter> painter) : painter_(std::move(painter)) {}
PictureDeveloper::PictureDeveloper(PictureDeveloper&&) noexcept = default;
PictureDeveloper& PictureDeveloper::operator=(PictureDeveloper&&) noexcept = default;
PictureDeveloper::~PictureDeveloper() = default;

Result<PictureDeveloper> PictureDeveloper::create(const Calibration& calibration, const FrameFormat& format,
                                                  const std::string& projection,
                                                  std::optional<PictureSize> size) {
  Made made = projection == "latlong" ? make_lat_long(calibration, format, size)
              : projection == "polar" ? make_polar(calibration, format, size)
              : projection == "fisheye"
                  ? make_fisheye(calibration, format, size)
                  : Made(usage("--projection is " + projection + ", allowed: latlong, polar, fisheye"));
  if (!made) return made.error();
  (*made)->picture.projection = projection;
  return PictureDeveloper(*std::move(made));
}

const DevelopedPicture& PictureDeveloper::develop(std::span<const std::byte> codes, double exposure_us) {
  painter_->develop(codes, exposure_us);
  return painter_->picture;
}

}  // namespace lightwell::cli
