// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "interface/atomic_file.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {

// A folder of its own and the built `lightwell calibrate`.
class PhotometricTest : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string write(const std::string& name, const std::string& content) const {
    EXPECT_TRUE(write_file_atomically(path(name), content));
    return path(name);
  }
  [[nodiscard]] nlohmann::json read_json(const std::string& name) const {
    const auto text = read_text_file(path(name));
    return text ? nlohmann::json::parse(*text) : nlohmann::json();
  }
  static ProcessResult calibrate(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "calibrate");
    return run_process(LIGHTWELL_BIN_DIR "/lightwell", arguments);
  }
  // One line on stderr that names what it must, nothing on stdout, and `out` as it was before.
  void expect_refused(const std::vector<std::string>& arguments, int code, const std::string& names,
                      const std::string& out) {
    const std::string before = "what stood there before";
    write(out, before);
    const ProcessResult run = calibrate(arguments);
    EXPECT_EQ(run.exit_code, code) << run.err;
    EXPECT_THAT(run.err, testing::HasSubstr(names));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(*read_text_file(path(out)), before);
    for (const auto& entry : std::filesystem::directory_iterator(path("")))
      EXPECT_TRUE(entry.path().filename() == out || entry.path().string().find(out) == std::string::npos)
          << "left behind: " << entry.path();
  }

 private:
  TemporaryFolder folder_;
};

}  // namespace lightwell::test
