// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "lighting/result.h"

// Files of other programs as JSON values, so that one set of checks reads them all. bad_input names the file and the
// line. Numbers that are not finite become texts.
namespace lightwell::calibration {

// YAML 1.2, and JSON, which is part of it; OpenCV's "%YAML:1.0" and "!!opencv-matrix" too.
Result<nlohmann::json> parse_yaml(const std::string& text, const std::string& file);

// <opencv_storage>, as cv::FileStorage writes it.
Result<nlohmann::json> parse_opencv_xml(const std::string& text, const std::string& file);

// One Python literal: dictionaries, lists, tuples, texts, bytes, numbers, True, False, None, and comments. Bytes are
// read past and become null.
Result<nlohmann::json> parse_python_literal(const std::string& text, const std::string& file);

}  // namespace lightwell::calibration
