// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <arv.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "tests/support/eventually.h"
#include "tests/support/temporary_folder.h"

extern char** environ;

namespace lightwell {
namespace {

using test::eventually;
using test::TemporaryFolder;

// A loopback address that no other test process uses: the control port is fixed by the protocol.
std::string own_address() {
  static int count = 0;
  const auto pid = static_cast<unsigned>(::getpid());
  return "127." + std::to_string(100 + ++count % 100) + "." + std::to_string(pid / 254 % 256) + "." +
         std::to_string(1 + pid % 254);
}

// lightwell-camera as a child; its stderr goes to a file.
class Camera {
 public:
  explicit Camera(std::vector<std::string> arguments) : log_(folder_.path() / "stderr") {
    arguments.insert(arguments.begin(), std::string(LIGHTWELL_BIN_DIR) + "/lightwell-camera");
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, 2, log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    if (::posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid_ = -1;
    ::posix_spawn_file_actions_destroy(&actions);
  }
  ~Camera() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  bool ready() {
    return eventually([&] { return said("ready on") || gone(); }) && said("ready on");
  }
  // The exit status, −1 where a signal ended it.
  int wait() {
    if (pid_ > 0) {
      ::waitpid(pid_, &status_, 0);
      pid_ = -1;
    }
    return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1;
  }
  int end(int signal) {
    ::kill(pid_, signal);
    return wait();
  }
  [[nodiscard]] std::string log() const {
    std::ifstream in(log_);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  [[nodiscard]] bool said(const std::string& what) const { return log().find(what) != std::string::npos; }

 private:
  bool gone() {
    if (pid_ > 0 && ::waitpid(pid_, &status_, WNOHANG) == pid_) pid_ = -1;
    return pid_ <= 0;
  }
  TemporaryFolder folder_;
  std::filesystem::path log_;
  pid_t pid_ = -1;
  int status_ = 0;
};

int run(const std::vector<std::string>& arguments, std::string* log = nullptr) {
  Camera camera(arguments);
  const int status = camera.wait();
  if (log != nullptr) *log = camera.log();
  return status;
}

struct Received {
  unsigned id = 0;
  std::uint64_t timestamp_ns = 0;
  int width = 0, height = 0;
  std::vector<std::byte> bytes;
};

// A plain client.
class Client {
 public:
  explicit Client(const std::string& address) {
    camera_ = arv_camera_new(address.c_str(), &error_);
    if (camera_ == nullptr) return;
    arv_camera_set_range_check_policy(camera_, ARV_RANGE_CHECK_POLICY_ENABLE);
    arv_camera_gv_set_stream_options(camera_, ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
    arv_camera_gv_set_packet_size_adjustment(camera_, ARV_GV_PACKET_SIZE_ADJUSTMENT_NEVER);
    arv_camera_gv_set_packet_size(camera_, 9000, &error_);
  }
  ~Client() {
    if (stream_ != nullptr) arv_camera_stop_acquisition(camera_, nullptr);
    g_clear_object(&stream_);
    g_clear_object(&camera_);
    g_clear_error(&error_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  [[nodiscard]] ArvCamera* camera() const { return camera_; }
  [[nodiscard]] std::string error() const { return error_ != nullptr ? error_->message : ""; }

  std::vector<Received> grab(std::size_t count) {
    std::vector<Received> frames;
    stream_ = arv_camera_create_stream(camera_, nullptr, nullptr, &error_);
    if (stream_ == nullptr) return frames;
    g_object_set(stream_, "socket-buffer", ARV_GV_STREAM_SOCKET_BUFFER_FIXED, "socket-buffer-size", 4 << 20,
                 nullptr);
    const std::size_t payload = arv_camera_get_payload(camera_, &error_);
    for (int i = 0; i < 20; ++i) arv_stream_push_buffer(stream_, arv_buffer_new_allocate(payload));
    arv_camera_start_acquisition(camera_, &error_);
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (frames.size() < count && std::chrono::steady_clock::now() < deadline) {
      ArvBuffer* buffer = arv_stream_timeout_pop_buffer(stream_, 200000);
      if (buffer == nullptr) continue;
      if (arv_buffer_get_status(buffer) == ARV_BUFFER_STATUS_SUCCESS) frames.push_back(copy(buffer));
      arv_stream_push_buffer(stream_, buffer);
    }
    return frames;
  }

 private:
  static Received copy(ArvBuffer* buffer) {
    std::size_t size = 0;
    const auto* data = static_cast<const std::byte*>(arv_buffer_get_data(buffer, &size));
    return {static_cast<unsigned>(arv_buffer_get_frame_id(buffer)),
            arv_buffer_get_timestamp(buffer),
            arv_buffer_get_image_width(buffer),
            arv_buffer_get_image_height(buffer),
            {data, data + size}};
  }
  ArvCamera* camera_ = nullptr;
  ArvStream* stream_ = nullptr;
  GError* error_ = nullptr;
};

std::vector<nlohmann::json> truth_lines(const std::filesystem::path& file) {
  std::vector<nlohmann::json> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(nlohmann::json::parse(line));
  return lines;
}

// Σ radiance × solid angle of a Mono12 frame, pixel by pixel in double.
double decoded_illuminance(const Calibration& c, const Received& frame, double exposure_us) {
  double sum = 0;
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const auto i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) + static_cast<std::size_t>(x);
      const double omega = c.lens.pixel_solid_angle_sr({x, y});
      if (omega <= 0) continue;
      const auto code =
          std::to_integer<int>(frame.bytes[2 * i]) | std::to_integer<int>(frame.bytes[2 * i + 1]) << 8;
      const double theta = std::min(c.lens.theta_rad({x, y}), c.lens.max_theta_rad);
      sum += omega * c.response.luminance_cd_m2(code - static_cast<double>(c.flat.offset_codes[i])) *
             c.response.reference_exposure_us / exposure_us / c.flat.transmission(theta);
    }
  return sum;
}

TEST(LightwellCamera, FramesTruthAndCalibrationAgree) {
  const TemporaryFolder folder;
  const std::string address = own_address();
  Camera camera({"--address", address, "--scenario", "studio", "--size", "320x240", "--rate", "50", "--truth",
                 (folder.path() / "truth.jsonl").string(), "--write-calibration",
                 (folder.path() / "cal").string()});
  ASSERT_TRUE(camera.ready()) << camera.log();
  std::vector<Received> frames;
  {
    Client client(address);
    ASSERT_NE(client.camera(), nullptr) << client.error();
    EXPECT_NEAR(arv_camera_get_frame_rate(client.camera(), nullptr), 50, 0.01);
    frames = client.grab(150);  // ids start near their end: they wrap on the way
    EXPECT_EQ(client.error(), "");
  }
  EXPECT_EQ(camera.end(SIGTERM), 0) << camera.log();
  ASSERT_EQ(frames.size(), 150u);
  const auto calibration = read_calibration(folder.path() / "cal");
  ASSERT_TRUE(calibration) << calibration.error().message;
  const auto lines = truth_lines(folder.path() / "truth.jsonl");
  ASSERT_GE(lines.size(), frames.size());
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(lines[i].at("frame").get<std::size_t>(), i);

  std::size_t line = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Received& frame = frames[i];
    ASSERT_EQ(frame.width, 320);
    ASSERT_EQ(frame.height, 240);
    ASSERT_EQ(frame.bytes.size(), 320u * 240u * 2u);
    while (line < lines.size() && lines[line].at("frame_id").get<unsigned>() != frame.id) ++line;
    ASSERT_LT(line, lines.size()) << "frame id " << frame.id << " has no line of truth";
    EXPECT_EQ(lines[line].at("time_ns").get<std::uint64_t>(), frame.timestamp_ns);
    if (i > 0) {
      EXPECT_GT(frame.timestamp_ns, frames[i - 1].timestamp_ns);
    }
    if (i % 50 == 0) {
      const auto truth = lines[line].at("total_illuminance").get<std::vector<double>>();
      EXPECT_NEAR(decoded_illuminance(*calibration, frame, lines[line].at("exposure_us")), truth[1],
                  0.01 * truth[1]);
      EXPECT_EQ(truth[0], truth[2]);
      EXPECT_EQ(lines[line].at("lights").size(), 3u);
    }
  }
}

TEST(LightwellCamera, RegionIsFixedAndFormatAndExposureFollowTheClient) {
  const TemporaryFolder folder;
  const std::string address = own_address();
  Camera camera({"--address", address, "--scenario", "static", "--size", "64x48", "--rate", "50", "--noise",
                 "0", "--truth", (folder.path() / "truth.jsonl").string()});
  ASSERT_TRUE(camera.ready()) << camera.log();
  Client client(address);
  ASSERT_NE(client.camera(), nullptr) << client.error();
  GError* error = nullptr;
  arv_camera_set_region(client.camera(), 0, 0, 64, 48, &error);
  EXPECT_EQ(error, nullptr) << error->message;
  g_clear_error(&error);
  arv_camera_set_region(client.camera(), 0, 0, 32, 48, &error);
  EXPECT_NE(error, nullptr);
  g_clear_error(&error);
  EXPECT_NEAR(arv_camera_get_float(client.camera(), "ResponseSlope", nullptr), 208.3,
              0.1);  // 3936 / ln(1.6e8 + 1)
  arv_camera_set_pixel_format_from_string(client.camera(), "Mono12p", &error);
  EXPECT_EQ(error, nullptr) << error->message;
  arv_camera_set_exposure_time(client.camera(), 2500, &error);
  EXPECT_EQ(error, nullptr) << error->message;
  const auto frames = client.grab(5);
  ASSERT_EQ(frames.size(), 5u);
  for (const Received& frame : frames) EXPECT_EQ(frame.bytes.size(), 64u * 48u * 3u / 2u);
  EXPECT_EQ(frames[1].bytes, frames[4].bytes);  // static, without noise
  ASSERT_TRUE(eventually([&] { return truth_lines(folder.path() / "truth.jsonl").size() >= 5; }));
  for (const auto& line : truth_lines(folder.path() / "truth.jsonl"))
    EXPECT_EQ(line.at("exposure_us").get<double>(), 2500);
}

TEST(LightwellCamera, SecondCameraOnOneAddressIsRefusedAndTheFirstGoesOn) {
  const std::string address = own_address();
  Camera first({"--address", address, "--scenario", "static", "--size", "32x24"});
  ASSERT_TRUE(first.ready()) << first.log();
  std::string log;
  EXPECT_EQ(run({"--address", address, "--size", "32x24"}, &log), 1);
  EXPECT_NE(log.find(address), std::string::npos) << log;
  Client client(address);
  ASSERT_NE(client.camera(), nullptr) << client.error();
  EXPECT_EQ(client.grab(2).size(), 2u);
  EXPECT_EQ(first.end(SIGINT), 0);
}

TEST(LightwellCamera, LostPacketsAreLostAndTruthStillCountsTheFrame) {
  const TemporaryFolder folder;
  const std::string address = own_address();
  Camera camera({"--address", address, "--scenario", "static", "--size", "320x240", "--rate", "50", "--loss",
                 "1", "--frames", "5", "--truth", (folder.path() / "truth.jsonl").string()});
  ASSERT_TRUE(camera.ready()) << camera.log();
  Client client(address);
  ASSERT_NE(client.camera(), nullptr) << client.error();
  ArvStream* stream = arv_camera_create_stream(client.camera(), nullptr, nullptr, nullptr);
  ASSERT_NE(stream, nullptr);
  arv_stream_push_buffer(stream, arv_buffer_new_allocate(arv_camera_get_payload(client.camera(), nullptr)));
  arv_camera_start_acquisition(client.camera(), nullptr);
  EXPECT_EQ(camera.wait(), 0);  // after its five frames
  EXPECT_GE(truth_lines(folder.path() / "truth.jsonl").size(), 5u);
  guint64 completed = 0, failed = 0, underruns = 0;
  arv_stream_get_statistics(stream, &completed, &failed, &underruns);
  EXPECT_EQ(completed, 0u);
  g_object_unref(stream);
}

TEST(LightwellCamera, WrongUsageAndBadInputSayWhatInOneLine) {
  const struct {
    std::vector<std::string> arguments;
    int status;
    const char* says;
  } cases[] = {
      {{"--size", "0x5"}, 2, "width = 0"},
      {{"--size", "640"}, 2, "--size = 640"},
      {{"--rate", "-3"}, 2, "--rate"},
      {{"--scenario", "night"}, 2, "allowed day"},
      {{"--pixel-format", "RGB8"}, 2, "Mono12p"},
      {{"--loss", "2"}, 2, "--loss"},
      {{"--seed", "-1"}, 2, "--seed: value '-1', allowed whole numbers from 0 to 4294967295"},
      {{"--noise", "nan"}, 2, "noise"},
      {{"--nonsense"}, 2, "--nonsense"},
      {{"--address", "camera.local"}, 2, "IPv4"},
      {{"--address", "192.0.2.77", "--size", "8x8"}, 1, "192.0.2.77"},  // RFC 5737: nobody's
      {{"--environment", "/nonexistent.exr"}, 3, "/nonexistent.exr"},
      {{"--response", "/nonexistent.json"}, 3, "/nonexistent.json"},
      {{"--truth", "/nonexistent/truth.jsonl", "--size", "8x8"}, 1, "/nonexistent/truth.jsonl"},
      {{"--write-calibration", "/nonexistent/a/b", "--size", "8x8"}, 1, "/nonexistent/a/b"},
      {{"--size", "3x3", "--pixel-format", "Mono12p"}, 2, "even"},
  };
  for (const auto& c : cases) {
    std::string log;
    EXPECT_EQ(run(c.arguments, &log), c.status) << c.arguments[0] << " " << log;
    EXPECT_NE(log.find(c.says), std::string::npos) << log;
    EXPECT_EQ(std::count(log.begin(), log.end(), '\n'), 1) << log;
  }
}

TEST(LightwellCamera, OnePixelAndOddSizesWork) {
  for (const char* size : {"1x1", "31x17"}) {
    const std::string address = own_address();
    Camera camera({"--address", address, "--scenario", "studio", "--size", size, "--rate", "50"});
    ASSERT_TRUE(camera.ready()) << camera.log();
    Client client(address);
    ASSERT_NE(client.camera(), nullptr) << client.error();
    EXPECT_EQ(client.grab(3).size(), 3u) << size;
  }
}

}  // namespace
}  // namespace lightwell
