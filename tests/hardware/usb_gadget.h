// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/eventually.h"

namespace lightwell::test {

// A sync board in one of the machine's two USB ports (dummy_hcd): dummy_udc.0 and dummy_udc.1.
class UsbGadget {
 public:
  // seed: its serial number ends in it.
  UsbGadget(const std::filesystem::path& folder, int port, int seed, std::vector<std::string> options = {})
      : name_("board" + std::to_string(port)), controller_("dummy_udc." + std::to_string(port)) {
    std::vector<std::string> command{LIGHTWELL_BIN_DIR "/lightwell-sync-gadget",
                                     "--name",
                                     name_,
                                     "--udc",
                                     controller_,
                                     "--seed",
                                     std::to_string(seed)};
    command.insert(command.end(), options.begin(), options.end());
    ChildProcess::Options output;
    output.stdout_file = folder / (controller_ + ".txt");
    std::filesystem::remove(output.stdout_file);
    process_ = std::make_unique<ChildProcess>(command, folder / (controller_ + ".log"), output);
    std::string line;
    EXPECT_TRUE(eventually([&] {
      std::ifstream file(output.stdout_file);
      return static_cast<bool>(std::getline(file, line)) || !process_->running();
    }));
    serial_ = line.substr(0, line.find(' '));
    EXPECT_EQ(serial_.size(), 24U) << process_->stderr_text();
  }

  [[nodiscard]] const std::string& serial() const { return serial_; }
  [[nodiscard]] ChildProcess& process() { return *process_; }
  // Takes the cable out, and puts it in again. (dummy_hcd does not come back from a controller's own soft_connect.)
  void unplug() const { bind("\n"); }
  void plug() const { bind(controller_); }

 private:
  void bind(const std::string& controller) const {
    std::ofstream file("/sys/kernel/config/usb_gadget/" + name_ + "/UDC");
    EXPECT_TRUE(file << controller << std::flush) << controller_;
  }

  std::string name_, controller_, serial_;
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace lightwell::test
