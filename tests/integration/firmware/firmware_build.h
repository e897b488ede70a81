// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace lightwell::test {

inline bool have(const std::string& program) {
  return std::system(("command -v " + program + " >/dev/null").c_str()) == 0;
}

// The images, built with the firmware preset's settings in a folder that all tests of this build share, one at a time. Empty:
// it failed, and said why.
inline std::string built_firmware() {
  const std::string folder = LIGHTWELL_BIN_DIR "/../firmware-images";
  std::filesystem::create_directories(folder);
  const int lock = open((folder + "/lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
  if (lock < 0 || flock(lock, LOCK_EX) != 0) return {};
  const std::string command = "cmake -S " LIGHTWELL_SOURCE_DIR " -B " + folder +
                              " -G Ninja -DCMAKE_BUILD_TYPE=MinSizeRel -DLIGHTWELL_FIRMWARE=ON "
                              "-DCMAKE_TOOLCHAIN_FILE=" LIGHTWELL_SOURCE_DIR
                              "/cmake/arm-none-eabi.cmake >/dev/null && cmake --build " +
                              folder + " >/dev/null";
  const bool good = std::system(command.c_str()) == 0;
  close(lock);
  return good ? folder : std::string();
}

}  // namespace lightwell::test
