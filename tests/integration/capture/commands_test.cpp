// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// `lightwell devices` and `lightwell doctor` in a network where the test decides what there is.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "daemon/capture/capture_source.h"
#include "tests/integration/capture/fake_camera.h"
#include "tests/support/eventually.h"
#include "tests/support/private_network.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

struct Ran {
  int exit_code = -1;
  std::string out;
  std::string error;
};

Ran lightwell(const std::string& arguments) {
  const TemporaryFolder folder;
  const std::string error_file = (folder.path() / "stderr").string();
  const std::string command = std::string(LIGHTWELL_BIN_DIR) + "/lightwell " + arguments + " 2>" + error_file;
  Ran ran;
  FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return ran;
  std::array<char, 4096> block{};
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), pipe)) > 0;)
    ran.out.append(block.data(), n);
  const int status = ::pclose(pipe);
  ran.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (FILE* file = std::fopen(error_file.c_str(), "r")) {
    const std::size_t n = std::fread(block.data(), 1, block.size(), file);
    ran.error.assign(block.data(), n);
    std::fclose(file);
  }
  return ran;
}

nlohmann::json check(const nlohmann::json& report, const std::string& name) {
  for (const auto& finding : report.at("checks"))
    if (finding.at("name") == name) return finding;
  return {};
}

class Commands : public testing::Test {
 protected:
  void SetUp() override {
    if (!PrivateNetwork::reason().empty()) GTEST_SKIP() << PrivateNetwork::reason();
  }
};

TEST_F(Commands, DevicesSaysThatNothingIsFoundAndSucceeds) {
  const Ran ran = lightwell("devices --timeout 0.1");
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_EQ(ran.out, "");
  EXPECT_THAT(ran.error, HasSubstr("no GigE Vision device found"));
  const Ran json = lightwell("devices --timeout 0.1 --json");
  EXPECT_EQ(json.exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(json.out).at("devices").size(), 0U);
}

TEST_F(Commands, DevicesTellsWhatACameraReports) {
  const FakeCamera camera(320, 200, 40, "SN42");
  ASSERT_TRUE(camera.ready());
  const Ran ran = lightwell("devices --json --interface lo");
  ASSERT_EQ(ran.exit_code, 0) << ran.error;
  const auto devices = nlohmann::json::parse(ran.out).at("devices");
  ASSERT_EQ(devices.size(), 1U);
  EXPECT_EQ(devices[0].at("source"), "aravis:127.0.0.1");
  EXPECT_EQ(devices[0].at("serial"), "SN42");
  EXPECT_EQ(devices[0].at("width"), 320);
  EXPECT_EQ(devices[0].at("height"), 200);
  EXPECT_DOUBLE_EQ(devices[0].at("rate_hz").get<double>(), 40);
  EXPECT_THAT(devices[0].at("pixel_formats").get<std::vector<std::string>>(), testing::Contains("Mono8"));
  EXPECT_THAT(lightwell("devices").out, HasSubstr("serial SN42"));
  const Ran elsewhere = lightwell("devices --json --timeout 0.1 --interface no-such-interface");
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_THAT(elsewhere.error, HasSubstr("no-such-interface"));
}

TEST_F(Commands, DevicesLeavesACameraInUseAlone) {
  const FakeCamera camera(64, 48, 100);
  ASSERT_TRUE(camera.ready());
  auto made = make_capture_source("aravis:127.0.0.1", {});
  const auto source = std::move(made).value();
  ASSERT_TRUE(source->start());
  ASSERT_TRUE(eventually([&] { return static_cast<bool>(source->wait(std::chrono::milliseconds(100))); }));
  const Ran ran = lightwell("devices --json");
  EXPECT_EQ(ran.exit_code, 0);
  EXPECT_THAT(nlohmann::json::parse(ran.out).at("devices").at(0).at("unavailable").get<std::string>(),
              HasSubstr("in use"));
  const std::uint64_t received = source->counters().received;
  EXPECT_TRUE(eventually([&] { return source->counters().received > received + 5; }));
  EXPECT_EQ(source->counters().reconnects, 0U);
  source->stop();
}

TEST_F(Commands, DevicesRefusesATimeoutOutOfRange) {
  EXPECT_EQ(lightwell("devices --timeout 0").exit_code, 2);
  EXPECT_EQ(lightwell("devices --timeout 1e9").exit_code, 2);
}

TEST_F(Commands, DoctorFailsForAMissingRecordFolderAndNamesIt) {
  const Ran ran = lightwell("doctor --json --record-dir /nonexistent/takes");
  EXPECT_EQ(ran.exit_code, 1);
  const auto report = nlohmann::json::parse(ran.out);
  EXPECT_FALSE(report.at("ok").get<bool>());
  EXPECT_EQ(check(report, "disk").at("verdict"), "fail");
  EXPECT_THAT(check(report, "disk").at("message").get<std::string>(), HasSubstr("/nonexistent/takes"));
}

TEST_F(Commands, DoctorSeesCameraAndMissingDaemonAndSaysHowToFixEverythingThatIsNotOk) {
  const TemporaryFolder folder;
  const FakeCamera camera(64, 48, 100);
  ASSERT_TRUE(camera.ready());
  const Ran ran = lightwell("doctor --json --record-dir " + folder.path().string());
  EXPECT_EQ(ran.exit_code, 0) << ran.out;
  const auto report = nlohmann::json::parse(ran.out);
  EXPECT_EQ(check(report, "cameras").at("verdict"), "ok");
  EXPECT_EQ(check(report, "camera port").at("verdict"), "ok");
  EXPECT_EQ(check(report, "daemon").at("verdict"), "warn");
  for (const auto& finding : report.at("checks"))
    EXPECT_EQ(finding.at("verdict") == "ok", finding.at("fix") == "") << finding.dump();
}

TEST_F(Commands, DoctorFailsWhereAnotherProgramHoldsTheDaemonsPort) {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  ASSERT_EQ(::bind(fd, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  ASSERT_EQ(::listen(fd, 4), 0);
  ASSERT_EQ(::getsockname(fd, reinterpret_cast<sockaddr*>(&at), &size), 0);
  const Ran ran = lightwell("doctor --json --http 127.0.0.1:" + std::to_string(ntohs(at.sin_port)));
  ::close(fd);
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_EQ(check(nlohmann::json::parse(ran.out), "daemon").at("verdict"), "fail");
}

TEST_F(Commands, DoctorRefusesAMalformedAddressAndAMissingConfiguration) {
  EXPECT_EQ(lightwell("doctor --http nowhere").exit_code, 2);
  EXPECT_EQ(lightwell("doctor --config /nonexistent.toml").exit_code, 3);
}

}  // namespace
}  // namespace lightwell::test
