// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace lightwell {

// What a camera of libcamera is and can do, in its own words.
struct LibcameraDescription {
  std::string id, model;
  struct Format {
    std::string name;          // "SRGGB10_CSI2P"
    std::string pixel_format;  // what it becomes here, empty where nothing
    bool raw = false;
    std::vector<std::string> sizes;  // "640x480"
  };
  std::vector<Format> formats;
  std::vector<std::pair<std::string, std::string>> controls;  // name and range
};

// By id. Takes some hundred milliseconds: libcamera looks for them. Empty also in builds without libcamera.
std::vector<LibcameraDescription> list_libcamera();

}  // namespace lightwell
