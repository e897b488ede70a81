// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/lens_import/source_lens.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "calibration/lens_import/document.h"
#include "calibration/lens_import/source_formats.h"
#include "interface/atomic_file.h"

namespace lightwell::calibration {
namespace {

using nlohmann::json;

constexpr std::pair<LensFormat, std::string_view> kNames[] = {{LensFormat::opencv, "opencv"},
                                                              {LensFormat::kalibr, "kalibr"},
                                                              {LensFormat::ocamcalib, "ocamcalib"},
                                                              {LensFormat::mrcal, "mrcal"}};

// The first line that is neither blank nor a comment.
std::string first_line(const std::string& text) {
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::size_t start = text.find_first_not_of(" \t\r", at);
    if (start < end && text[start] != '#') return text.substr(start, end - start);
    at = end + 1;
  }
  return "";
}

bool is_xml(const std::string& text) {
  return first_line(text).rfind("<", 0) == 0;
}

bool holds_camera(const json& root) {
  return root.is_object() && std::any_of(root.begin(), root.end(), [](const json& value) {
           return value.is_object() && value.contains("camera_model") && value.contains("intrinsics");
         });
}

// mrcal's is a Python dictionary, OCamCalib's begins with a row of numbers; the others say it by their keys.
Result<LensFormat> guessed_format(const std::string& text, const std::string& file) {
  if (text.find("lensmodel") != std::string::npos && first_line(text).rfind("{", 0) == 0)
    return LensFormat::mrcal;
  if (is_xml(text)) return LensFormat::opencv;
  const std::string line = first_line(text);
  if (!line.empty() && line.find_first_not_of("0123456789+-.eE \t\r") == std::string::npos)
    return LensFormat::ocamcalib;
  const auto root = parse_yaml(text, file);
  if (root && root->is_object()) return holds_camera(*root) ? LensFormat::kalibr : LensFormat::opencv;
  const bool looks_like_yaml =
      text.rfind("%YAML", 0) == 0 || line.find(':') != std::string::npos || line.rfind("{", 0) == 0;
  if (!root && !line.empty() && looks_like_yaml) return root.error();
  return Error{ErrorKind::bad_input,
               file + ": is of no known format: allowed opencv (YAML, XML, JSON), kalibr, ocamcalib, mrcal"};
}

Result<json> parse_document(LensFormat format, const std::string& text, const std::string& file) {
  if (format == LensFormat::mrcal) return parse_python_literal(text, file);
  return is_xml(text) ? parse_opencv_xml(text, file) : parse_yaml(text, file);
}

}  // namespace

std::string_view name(LensFormat format) {
  for (const auto& [value, text] : kNames)
    if (value == format) return text;
  return "";
}

std::optional<LensFormat> lens_format(std::string_view name) {
  for (const auto& [value, text] : kNames)
    if (text == name) return value;
  return {};
}

int image_side(const JsonFields& fields, const std::string& key, double value) {
  if (value != std::floor(value) || value < 1 || value > 16384) {
    char text[80];
    std::snprintf(text, sizeof text, "= %.9g: allowed a whole number from 1 to 16384", value);
    fields.fail(key, text);
  }
  return static_cast<int>(value);
}

PinholePlane pinhole_plane(const JsonFields& fields, const std::string& key, double fx, double fy, double cx,
                           double cy) {
  const auto refuse = [&](const char* which, double value, const char* allowed) {
    char text[120];
    std::snprintf(text, sizeof text, ": %s = %.9g: allowed %s", which, value, allowed);
    fields.fail(key, text);
  };
  if (!(fx > 0 && fx < 1e6)) refuse("fx", fx, "above 0, below 1e6 pixels");
  if (!(fy > 0 && fy < 1e6)) refuse("fy", fy, "above 0, below 1e6 pixels");
  if (!(std::abs(cx) < 1e6)) refuse("cx", cx, "-1e6 to 1e6 pixels");
  if (!(std::abs(cy) < 1e6)) refuse("cy", cy, "-1e6 to 1e6 pixels");
  return {{fx, fy}, {cx, cy}};
}

Result<SourceLens> read_source_lens(const std::filesystem::path& path, const SourceLensOptions& options) {
  const std::string file = path.string();
  const auto text = read_text_file(path, 64u << 20);
  if (!text) return text.error();
  const auto format = options.format ? Result<LensFormat>(*options.format) : guessed_format(*text, file);
  if (!format) return format.error();
  if (!options.camera.empty() && *format != LensFormat::kalibr)
    return Error{ErrorKind::usage, "--camera is \"" + options.camera + "\": goes with a Kalibr file, " +
                                       file + " is read as " + std::string(name(*format))};
  if (!options.model.empty() && *format != LensFormat::opencv)
    return Error{ErrorKind::usage, "--model is \"" + options.model + "\": goes with an OpenCV file, " + file +
                                       " is read as " + std::string(name(*format))};
  try {
    if (*format == LensFormat::ocamcalib) return ocamcalib_lens(*text, file);
    const auto root = parse_document(*format, *text, file);
    if (!root) return root.error();
    if (*format == LensFormat::kalibr) return kalibr_lens(*root, file, options.camera);
    const JsonFields fields(*root, file);
    return *format == LensFormat::mrcal ? mrcal_lens(fields) : opencv_lens(fields, options.model);
  } catch (const FieldFailure& failure) {
    return failure.error;
  }
}

}  // namespace lightwell::calibration
