// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

namespace lightwell::test {

// A GPIO chip of eight lines whose pins are files (gpio-sim). https://docs.kernel.org/admin-guide/gpio/gpio-sim.html
class GpioSimulator {
 public:
  explicit GpioSimulator(const std::map<int, std::string>& names = {}) {
    namespace fs = std::filesystem;
    fs::create_directories(root_ / "bank0");
    write(root_ / "bank0/num_lines", "8");
    for (const auto& [line, name] : names) {
      fs::create_directories(line_folder(line));
      write(line_folder(line) / "name", name);
      named_.push_back(line);
    }
    bring_back();
  }
  ~GpioSimulator() {
    take_away();
    for (const int line : named_) std::filesystem::remove(line_folder(line));
    std::filesystem::remove(root_ / "bank0");
    std::filesystem::remove(root_);
  }
  GpioSimulator(const GpioSimulator&) = delete;
  GpioSimulator& operator=(const GpioSimulator&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  // What the outside does to an input, and sees of an output.
  void pull(int line, bool high) const { write(pin(line) / "pull", high ? "pull-up" : "pull-down"); }
  [[nodiscard]] bool is_high(int line) const {
    int value = 0;
    std::ifstream(pin(line) / "value") >> value;
    return value != 0;
  }
  void take_away() { write(root_ / "live", "0"); }
  // Under another path, where the kernel has not let go of what was held.
  void bring_back() {
    write(root_ / "live", "1");
    std::string device, chip;
    std::ifstream(root_ / "dev_name") >> device;
    std::ifstream(root_ / "bank0/chip_name") >> chip;
    path_ = "/dev/" + chip;
    pins_ = std::filesystem::path("/sys/devices/platform") / device / chip;
  }

 private:
  static void write(const std::filesystem::path& file, const char* text) { write(file, std::string(text)); }
  static void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream stream(file);
    EXPECT_TRUE(stream << text << std::flush) << file << " " << text;
  }
  [[nodiscard]] std::filesystem::path line_folder(int line) const {
    return root_ / "bank0" / ("line" + std::to_string(line));
  }
  [[nodiscard]] std::filesystem::path pin(int line) const {
    return pins_ / ("sim_gpio" + std::to_string(line));
  }

  std::filesystem::path root_ = "/sys/kernel/config/gpio-sim/lightwell", pins_;
  std::string path_;
  std::vector<int> named_;
};

}  // namespace lightwell::test
