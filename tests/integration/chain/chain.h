// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "interface/http_client.h"
#include "lighting/vector.h"
#include "tests/support/child_process.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {

// The real programs side by side: lightwell-camera on a loopback address of its own, lightwelld beside it.
class Chain : public testing::Test {
 protected:
  using Words = std::vector<std::string>;

  // An address no other test uses: 127.(1…126).x.y by process and test.
  static std::string own_address() {
    static int count = 0;
    const int n = static_cast<int>(::getpid()) * 8 + count++;
    return "127." + std::to_string(40 + n / 62500 % 60) + "." + std::to_string(n / 250 % 250) + "." +
           std::to_string(2 + n % 250);
  }
  static std::string program(const std::string& name) { return std::string(LIGHTWELL_BIN_DIR) + "/" + name; }

  void start_camera(const Words& options) {
    Words command = {program("lightwell-camera"), "--address", address_,        "--write-calibration",
                     calibration().string(),      "--truth",   truth().string()};
    command.insert(command.end(), options.begin(), options.end());
    camera_ = std::make_unique<ChildProcess>(command, folder_.path() / "camera.log");
    ASSERT_TRUE(eventually(
        [&] { return std::filesystem::exists(calibration() / "lens.json") || !camera_->running(); }));
    ASSERT_TRUE(camera_->running()) << camera_->stderr_text();
  }

  // configuration: TOML beside what keeps tests apart
  void start_daemon(const std::string& configuration = "", const ChildProcess::Options& options = {}) {
    write_configuration(configuration);
    daemon_ = std::make_unique<ChildProcess>(
        Words{program("lightwelld"), "--config", config_file().string(), "--source", "aravis:" + address_,
              "--calibration", calibration().string(), "--record-dir", folder_.path().string()},
        folder_.path() / "daemon.log", options);
    const auto url = daemon_->wait_for_line("page: http://");
    ASSERT_TRUE(url) << daemon_->stderr_text();
    http_ = url->substr(0, url->find('/'));
  }
  void write_configuration(const std::string& configuration) const {
    std::ofstream(config_file()) << "[http]\nlisten = \"127.0.0.1:0\"\n[dds]\ndomain = " << domain() << "\n"
                                 << configuration;
  }

  [[nodiscard]] nlohmann::json get(const std::string& path) const {
    HttpRequest request;
    request.path = path;
    const auto response = http_request(http_, request);
    if (!response || response->status != 200) return {};
    return nlohmann::json::parse(response->body, nullptr, false);
  }
  int post(const std::string& path, const std::string& body) const {
    HttpRequest request;
    request.method = "POST";
    request.path = path;
    request.body = body;
    const auto response = http_request(http_, request);
    return response ? response->status : 0;
  }
  [[nodiscard]] nlohmann::json status() const { return get("/api/v1/status"); }
  [[nodiscard]] std::uint64_t published() const { return status().value("published", std::uint64_t{0}); }
  bool published_reaches(std::uint64_t count) const {
    return eventually([&] { return published() >= count; }, std::chrono::seconds(60));
  }

  [[nodiscard]] std::filesystem::path calibration() const { return folder_.path() / "calibration"; }
  [[nodiscard]] std::filesystem::path truth() const { return folder_.path() / "truth.jsonl"; }
  [[nodiscard]] std::filesystem::path config_file() const { return folder_.path() / "lightwell.toml"; }
  [[nodiscard]] static int domain() { return 100 + static_cast<int>(::getpid()) % 100; }

  // The last whole line of the camera's truth.
  [[nodiscard]] nlohmann::json last_truth() const {
    std::ifstream file(truth());
    nlohmann::json last;
    for (std::string line; std::getline(file, line);)
      if (auto parsed = nlohmann::json::parse(line, nullptr, false); !parsed.is_discarded())
        last = std::move(parsed);
    return last;
  }

  TemporaryFolder folder_;
  std::string address_ = own_address();
  std::string http_;
  std::unique_ptr<ChildProcess> camera_, daemon_;
};

inline Rgbd rgb_of(const nlohmann::json& array) {
  return {array.at(0).get<double>(), array.at(1).get<double>(), array.at(2).get<double>()};
}

}  // namespace lightwell::test
