// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Trigger and strobe on the lines of a chip (gpio-sim) whose other ends this test holds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "daemon/clock.h"
#include "daemon/sync/exposure_stamper.h"
#include "daemon/sync/gpio_line.h"
#include "daemon/sync/gpio_sync.h"
#include "interface/http_client.h"
#include "tests/hardware/gpio_simulator.h"
#include "tests/support/child_process.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr int kTrigger = 3, kStrobe = 5;
// The kernel asks which way an edge went after it has stamped it: what is shorter than its thread sleeps goes untold.
constexpr auto kExposure = milliseconds(15);

// Exposes whenever its trigger line rises; remembers between which times each exposure began, and when it was over.
class Camera {
 public:
  struct Exposure {
    std::int64_t begin_after_ns = 0, begin_before_ns = 0, end_before_ns = 0;
  };
  explicit Camera(const GpioSimulator& chip) : chip_(chip), thread_([this] { run(); }) {}
  ~Camera() {
    over_ = true;
    thread_.join();
  }
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  [[nodiscard]] std::vector<Exposure> exposures() const {
    const std::scoped_lock lock(mutex_);
    return exposures_;
  }

 private:
  void run() {
    for (bool was_high = false; !over_; std::this_thread::sleep_for(milliseconds(1))) {
      const bool high = chip_.is_high(kTrigger);
      if (high && !was_high) expose();
      was_high = high;
    }
  }
  void expose() {
    Exposure exposure;
    exposure.begin_after_ns = mono_now_ns();
    chip_.pull(kStrobe, true);
    exposure.begin_before_ns = mono_now_ns();
    std::this_thread::sleep_for(kExposure);
    chip_.pull(kStrobe, false);
    exposure.end_before_ns = mono_now_ns();
    const std::scoped_lock lock(mutex_);
    exposures_.push_back(exposure);
  }

  const GpioSimulator& chip_;
  mutable std::mutex mutex_;
  std::vector<Exposure> exposures_;
  std::atomic<bool> over_{false};
  std::thread thread_;
};

class GpioLines : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/sys/kernel/config/gpio-sim"))
      GTEST_SKIP() << "there is no gpio-sim: run in the virtual machine";
  }
  // Pulses that the camera above, which looks a thousand times a second, does not miss.
  static GpioOptions options(const GpioSimulator& chip, const std::string& trigger,
                             const std::string& strobe) {
    return {chip.path(), trigger, strobe, {10, 1, 30'000'000}};
  }
  StrobeRing strobes_;
};

TEST_F(GpioLines, EdgesOfTheStrobeComeWithTheKernelsStampsAndAnswerTheirTriggers) {
  GpioSimulator chip({{kTrigger, "CAMERA_TRIGGER"}, {kStrobe, "CAMERA_STROBE"}});
  const Camera camera(chip);
  const GpioSync sync(options(chip, "CAMERA_TRIGGER", "CAMERA_STROBE"), strobes_);
  ASSERT_TRUE(eventually([&] { return sync.view().status && sync.view().status->strobes >= 30; }))
      << sync.view().description;
  const BoardView view = sync.view();
  EXPECT_EQ(view.state, BoardState::connected);
  EXPECT_THAT(view.description, HasSubstr("triggers on line CAMERA_TRIGGER"));
  EXPECT_THAT(view.description, HasSubstr("a sync board has these"));
  EXPECT_EQ(view.status->stray_strobes, 0U);
  EXPECT_FALSE(view.photodiode || view.imu || view.timecode);
  const auto exposures = camera.exposures();
  int compared = 0;
  std::optional<std::uint32_t> last;
  for (const Camera::Exposure& exposure : exposures) {
    const auto strobe = strobes_.newest_before(exposure.end_before_ns);
    if (!strobe || strobe->begin_mono_ns < exposure.begin_after_ns) continue;  // its own is not told
    ++compared;
    EXPECT_LE(strobe->begin_mono_ns, exposure.begin_before_ns)
        << "stamped when it rose, not when it was read";
    EXPECT_GE(strobe->end_mono_ns - strobe->begin_mono_ns, std::chrono::nanoseconds(kExposure).count());
    EXPECT_TRUE(!last || strobe->trigger > *last);
    last = strobe->trigger;
  }
  EXPECT_GE(compared, 20);
}

TEST_F(GpioLines, TheTriggersRateIsTheOneThatWasAskedFor) {
  GpioSimulator chip;
  const GpioSync sync({chip.path(), std::to_string(kTrigger), "", {25, 1, 15'000'000}}, strobes_);
  ASSERT_TRUE(eventually([&] { return sync.view().status.has_value(); }));
  const auto made = [&] { return sync.view().status->triggers + sync.view().status->late_triggers; };
  const std::uint32_t before = made();
  const auto begin = std::chrono::steady_clock::now();
  int rises = 0;
  for (bool was_high = true; std::chrono::steady_clock::now() - begin < std::chrono::seconds(4);
       std::this_thread::sleep_for(milliseconds(1))) {
    const bool high = chip.is_high(kTrigger);
    rises += high && !was_high ? 1 : 0;
    was_high = high;
  }
  const std::uint32_t told = made() - before;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_NEAR(told, 25 * took.count(), 5);
  // A machine that is held up for half a period leaves pulses out, and a sampler may sleep through some.
  EXPECT_LE(rises, 25 * took.count() + 1);
  EXPECT_GE(rises, 60);
}

TEST_F(GpioLines, FramesOfACameraThatRunsByItselfAreStampedWithItsStrobe) {
  GpioSimulator chip;
  const GpioSync sync(options(chip, "", std::to_string(kStrobe)), strobes_);
  ASSERT_TRUE(eventually([&] { return sync.view().state == BoardState::connected; }))
      << sync.view().description;
  ExposureStamper stamper(strobes_);
  // Sixteen frames teach the stamper, and again where a strobe went untold.
  std::uint64_t stamped = 0;
  for (std::uint64_t sequence = 100; stamped < 10 && sequence < 400; ++sequence) {
    const std::int64_t begin_after_ns = mono_now_ns();
    chip.pull(kStrobe, true);
    const std::int64_t begin_before_ns = mono_now_ns();
    std::this_thread::sleep_for(kExposure);
    const std::int64_t end_after_ns = mono_now_ns();
    chip.pull(kStrobe, false);
    const std::int64_t end_before_ns = mono_now_ns();
    std::this_thread::sleep_for(milliseconds(60));  // read-out; the strobe's edges have long been taken
    FrameInfo info;
    info.sequence = sequence;
    info.received_mono_ns = info.capture_mono_ns = mono_now_ns();
    if (!stamper.stamp(info)) continue;
    ++stamped;
    EXPECT_GE(2 * info.capture_mono_ns, begin_after_ns + end_after_ns - 1);
    EXPECT_LE(2 * info.capture_mono_ns, begin_before_ns + end_before_ns + 1);
  }
  EXPECT_EQ(stamped, 10U);
}

TEST_F(GpioLines, WhatIsNotToBeHadIsNamed) {
  const auto refusal = [](const GpioPlace& place) {
    const auto input = open_gpio_input(place);
    const auto output = open_gpio_output(place);
    if (input || output) return std::string("opened");
    EXPECT_EQ(input.error().message, output.error().message);
    return input.error().message;
  };
  EXPECT_EQ(refusal({"/dev/gpiochip77", "0"}), "/dev/gpiochip77: there is no such GPIO chip");
  EXPECT_EQ(refusal({"/dev/null", "0"}), "/dev/null: is no GPIO chip");
  GpioSimulator chip({{kStrobe, "CAMERA_STROBE"}});
  EXPECT_EQ(refusal({chip.path(), "8"}), chip.path() + ": no line 8; it has 0 to 7");
  EXPECT_EQ(refusal({chip.path(), "SHUTTER"}), chip.path() + ": no line is named SHUTTER");
  const auto held = open_gpio_output({chip.path(), "CAMERA_STROBE"});
  ASSERT_TRUE(held) << held.error().message;
  EXPECT_EQ(refusal({chip.path(), std::to_string(kStrobe)}), chip.path() + ": line 5 is in use by lightwell");
}

// Without a strobe line: a gpio-sim that goes while an edge is waited for leaves its interrupt behind, with a warning.
TEST_F(GpioLines, ALineThatIsFreeAgainAndAChipThatComesBackAreTakenUp) {
  GpioSimulator chip;
  // A name that stays, as a udev rule gives.
  TemporaryFolder folder;
  const auto name = folder.path() / "chip";
  std::filesystem::create_symlink(chip.path(), name);
  auto held = open_gpio_output({chip.path(), std::to_string(kTrigger)});
  ASSERT_TRUE(held);
  const GpioSync sync({name.string(), std::to_string(kTrigger), "", {10, 1, 1'000'000}}, strobes_);
  const auto says = [&](const char* words) {
    return eventually([&] { return sync.view().description.find(words) != std::string::npos; });
  };
  ASSERT_TRUE(says("line 3 is in use by lightwell")) << sync.view().description;
  EXPECT_EQ(sync.view().state, BoardState::no_device);
  held->reset();
  const auto triggers = [&] {
    return eventually([&] { return sync.view().status && sync.view().status->triggers > 3; });
  };
  ASSERT_TRUE(triggers()) << sync.view().description;
  chip.take_away();
  ASSERT_TRUE(says("there is no such GPIO chip")) << sync.view().description;
  EXPECT_EQ(sync.view().state, BoardState::no_device);
  chip.bring_back();
  std::filesystem::remove(name);
  std::filesystem::create_symlink(chip.path(), name);
  ASSERT_TRUE(triggers()) << sync.view().description;
  EXPECT_EQ(sync.view().reconnects, 1U);
}

TEST_F(GpioLines, TheDaemonTriggersAndSaysWhatABoxWithoutABoardLacks) {
  GpioSimulator chip;
  const Camera camera(chip);
  TemporaryFolder folder;
  const auto file = folder.path() / "lightwell.toml";
  std::ofstream(file)
      << "[http]\nlisten = \"127.0.0.1:0\"\n[source]\nwidth = 160\nheight = 120\nrate_hz = 2.0\n"
         "[map]\nrings = 45\nsectors = 180\n[lights]\nsampler = \"standard\"\ncount = 32\n"
         "filter = \"none\"\nrelaxed = false\n[fit]\nlights = 0\n[board]\naddress = \"gpio:"
      << chip.path()
      << "\"\ntrigger_line = \"3\"\nstrobe_line = \"5\"\ntrigger_rate = \"10\"\npulse_us = 30000.0\n";
  ChildProcess daemon({LIGHTWELL_BIN_DIR "/lightwelld", "--config", file.string(), "--source",
                       "simulated:static", "--record-dir", folder.path().string()},
                      folder.path() / "daemon.log");
  const auto url = daemon.wait_for_line("page: http://");
  ASSERT_TRUE(url) << daemon.stderr_text();
  HttpRequest request;
  request.path = "/api/v1/status";
  nlohmann::json board;
  EXPECT_TRUE(eventually([&] {
    const auto answer = http_request(url->substr(0, url->find('/')), request);
    const auto status = answer ? nlohmann::json::parse(answer->body, nullptr, false) : nlohmann::json();
    if (status.is_object()) board = status["board"];
    return board.is_object() && board["trigger"].is_object() && board["trigger"]["strobes"] > 10;
  })) << board
      << daemon.stderr_text();
  EXPECT_EQ(board["state"], "connected");
  EXPECT_THAT(board["description"], HasSubstr("strobes on line 5"));
  EXPECT_TRUE(board["flicker"].is_null() && board["up_m_s2"].is_null() && board["temperature_c"].is_null());
  EXPECT_EQ(board["trigger"]["lock"], "free");
  EXPECT_EQ(board["trigger"]["rate_hz"], 10);
}

}  // namespace
}  // namespace lightwell::test
