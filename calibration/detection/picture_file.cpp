// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/detection/picture_file.h"

#include <png.h>
#include <turbojpeg.h>

#include <memory>
#include <string>

#include "interface/atomic_file.h"

namespace lightwell::calibration {
namespace {

constexpr std::size_t kMostPixels = 200'000'000;
constexpr std::size_t kLeastSide = 32;  // no board of any kind can be read in less

Error bad(const std::filesystem::path& file, const std::string& what) {
  return {ErrorKind::bad_input, file.string() + ": " + what};
}

Result<GreyPicture> sized(const std::filesystem::path& file, std::size_t width, std::size_t height) {
  if (width < kLeastSide || height < kLeastSide || width > kMostPixels / height)
    return bad(file, "has " + std::to_string(width) + "x" + std::to_string(height) + " pixels, allowed " +
                         std::to_string(kLeastSide) + " a side to " + std::to_string(kMostPixels) +
                         " in all");
  return GreyPicture{static_cast<int>(width), static_cast<int>(height),
                     std::vector<std::uint8_t>(width * height)};
}

Result<GreyPicture> read_jpeg(const std::filesystem::path& file, const std::string& bytes) {
  const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, space = 0;
  if (tjDecompressHeader3(decoder.get(), data, bytes.size(), &width, &height, &subsampling, &space) != 0)
    return bad(file, "is no JPEG picture: its header is damaged");
  auto picture = sized(file, static_cast<std::size_t>(width), static_cast<std::size_t>(height));
  if (!picture) return picture;
  if (tjDecompress2(decoder.get(), data, bytes.size(), picture->pixels.data(), width, 0, height, TJPF_GRAY,
                    TJFLAG_STOPONWARNING | TJFLAG_ACCURATEDCT) != 0)
    return bad(file, "is a damaged JPEG picture: cut, or changed in the middle");
  return picture;
}

Result<GreyPicture> read_png(const std::filesystem::path& file, const std::string& bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto failure = [&](const std::string& what) {
    const Error error = bad(file, what);
    png_image_free(&image);
    return error;
  };
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()))
    return failure("is no PNG picture: its header is damaged");
  auto picture = sized(file, image.width, image.height);
  if (!picture) {
    png_image_free(&image);
    return picture;
  }
  image.format = PNG_FORMAT_GRAY;
  const png_color black{0, 0, 0};
  if (!png_image_finish_read(&image, &black, picture->pixels.data(), 0, nullptr))
    return failure("is a damaged PNG picture: cut, or changed in the middle");
  return picture;
}

}  // namespace

Result<GreyPicture> read_grey_picture(const std::filesystem::path& file) {
  const auto bytes = read_text_file(file);
  if (!bytes) return bytes.error();
  if (bytes->starts_with("\xFF\xD8")) return read_jpeg(file, *bytes);
  if (bytes->starts_with("\x89PNG")) return read_png(file, *bytes);
  return bad(file, "is neither a JPEG nor a PNG picture");
}

}  // namespace lightwell::calibration
