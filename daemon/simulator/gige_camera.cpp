// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/gige_camera.h"

#include <arpa/inet.h>
#include <arv.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <optional>

#include "daemon/simulator/loopback_address.h"
#include "daemon/simulator/probe_camera_xml.h"

namespace lightwell::simulator {
namespace {

constexpr std::uint16_t kControlPort = 3956;  // GigE Vision 2.0, section 4.1

// Registers of probe_camera.xml that Aravis does not know.
enum OurRegister : std::uint32_t {
  kWidthRegister = 0x500,
  kHeightRegister = 0x504,
  kColourSensor = 0x508,
  kResponseOffset = 0x510,
  kResponseSlope = 0x514,
  kResponseToe = 0x518,
  kTemperature = 0x51c,
};
// Bootstrap registers (GigE Vision 2.0, section 28).
constexpr std::uint32_t kManufacturer = 0x48, kModel = 0x68, kVersion = 0x88, kManufacturerInfo = 0xa8;

constexpr std::array<std::pair<PixelFormat, std::uint32_t>, 9> kFormatCodes = {{
    {PixelFormat::mono8, 0x01080001},
    {PixelFormat::mono10, 0x01100003},
    {PixelFormat::mono12, 0x01100005},
    {PixelFormat::mono12p, 0x010C0047},
    {PixelFormat::mono16, 0x01100007},
    {PixelFormat::bayer_rg8, 0x01080009},
    {PixelFormat::bayer_rg10, 0x0110000D},
    {PixelFormat::bayer_rg12, 0x01100011},
    {PixelFormat::bayer_rg16, 0x0110002F},
}};

std::uint32_t code_of(PixelFormat format) {
  for (const auto& [f, code] : kFormatCodes)
    if (f == format) return code;
  return 0;
}

std::optional<PixelFormat> format_of(std::uint32_t wanted) {
  for (const auto& [f, code] : kFormatCodes)
    if (code == wanted) return f;
  return std::nullopt;
}

// Aravis lets a second camera on one address run without its control port, so look first.
Status check_address(const std::string& address, in_addr& parsed) {
  if (::inet_pton(AF_INET, address.c_str(), &parsed) != 1)
    return Error{ErrorKind::usage, "address = " + address + ": allowed an IPv4 address of this machine"};
  const int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return Error{ErrorKind::failed, std::string("cannot make a socket: ") + std::strerror(errno)};
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(kControlPort);
  where.sin_addr = parsed;
  const bool bound = ::bind(fd, reinterpret_cast<sockaddr*>(&where), sizeof where) == 0;
  const int why = errno;
  ::close(fd);
  if (bound) return {};
  if (why == EADDRINUSE)
    return Error{ErrorKind::failed,
                 "address " + address + ": a camera is there already (port 3956 is in use)"};
  return Error{ErrorKind::failed,
               "address " + address + ": cannot listen on port 3956: " + std::strerror(why)};
}

// The description as a file without a place on disk; Aravis reads it while the camera is made.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content) : fd_(::memfd_create("probe_camera.xml", MFD_CLOEXEC)) {
    whole_ = fd_ >= 0 && ::write(fd_, content.data(), content.size()) == static_cast<ssize_t>(content.size());
    path_ = "/proc/self/fd/" + std::to_string(fd_);
  }
  ~MemoryFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] bool whole() const { return whole_; }
  [[nodiscard]] const char* path() const { return path_.c_str(); }

 private:
  int fd_;
  bool whole_ = false;
  std::string path_;
};

class AravisFakeCamera final : public GigeCamera {
 public:
  AravisFakeCamera(ArvGvFakeCamera* device, const ProbeSetup& setup, FrameGenerator generator,
                   std::function<void(const SentFrame&)> sent)
      : device_(device), camera_(arv_gv_fake_camera_get_fake_camera(device)), setup_(setup) {
    write_registers();
    frames_ = std::make_unique<PreparedFrames>(
        std::move(generator), [this] { return settings(); }, std::move(sent));
    arv_fake_camera_set_fill_pattern(camera_, &AravisFakeCamera::fill, this);
  }
  ~AravisFakeCamera() override { AravisFakeCamera::stop(); }

  [[nodiscard]] std::uint64_t frames() const override { return frames_->taken(); }

  void stop() override {
    if (device_ == nullptr) return;
    frames_->stop();  // a callback that waits for a frame returns
    g_object_unref(device_);
    device_ = nullptr;
  }

 private:
  [[nodiscard]] std::uint32_t read(std::uint32_t address) const {
    std::uint32_t value = 0;
    arv_fake_camera_read_register(camera_, address, &value);
    return value;
  }
  void write(std::uint32_t address, std::uint32_t value) {
    arv_fake_camera_write_register(camera_, address, value);
  }
  void write(std::uint32_t address, float value) { write(address, std::bit_cast<std::uint32_t>(value)); }
  void write(std::uint32_t address, const char* text) {
    arv_fake_camera_write_memory(camera_, address, static_cast<guint32>(std::strlen(text) + 1), text);
  }

  void write_registers() {
    const FrameFormat& format = setup_.model.format;
    const auto width = static_cast<std::uint32_t>(format.width),
               height = static_cast<std::uint32_t>(format.height);
    for (const std::uint32_t r :
         {std::uint32_t{ARV_FAKE_CAMERA_REGISTER_SENSOR_WIDTH}, std::uint32_t{ARV_FAKE_CAMERA_REGISTER_WIDTH},
          std::uint32_t{kWidthRegister}})
      write(r, width);
    for (const std::uint32_t r :
         {std::uint32_t{ARV_FAKE_CAMERA_REGISTER_SENSOR_HEIGHT},
          std::uint32_t{ARV_FAKE_CAMERA_REGISTER_HEIGHT}, std::uint32_t{kHeightRegister}})
      write(r, height);
    write(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT, code_of(format.pixel_format));
    write(kColourSensor, std::uint32_t{is_bayer(format.pixel_format)});
    write(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US,
          static_cast<std::uint32_t>(std::lround(1e6 / setup_.rate_hz)));
    write(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US,
          static_cast<std::uint32_t>(std::lround(setup_.exposure_us)));
    write(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE, std::uint32_t{1});  // Software, the only one there is
    arv_fake_camera_set_trigger_frequency(camera_, 1000);  // looks for software triggers this often
    write(kManufacturer, "Lightwell");
    write(kModel, "Simulated probe");
    write(kVersion, "1");
    write(kManufacturerInfo, "log-response fisheye");
    if (const auto* log = std::get_if<LogResponse>(&setup_.model.calibration.response.model)) {
      write(kResponseOffset, static_cast<float>(log->a));
      write(kResponseSlope, static_cast<float>(log->b));
      write(kResponseToe, static_cast<float>(log->c));
    }
    write(kTemperature, 38.5f);
  }

  // As the registers say now. A format that the sensor does not have leaves it at its own.
  [[nodiscard]] CameraSettings settings() const {
    CameraSettings s;
    s.pixel_format =
        format_of(read(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT)).value_or(setup_.model.format.pixel_format);
    s.exposure_us = std::max(10u, read(ARV_FAKE_CAMERA_REGISTER_EXPOSURE_TIME_US));
    s.period_us = std::max(1000u, read(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US));
    return s;
  }

  // On the protocol's thread.
  static void fill(ArvBuffer* buffer, void* self_pointer, guint32, guint32, ArvPixelFormat) {
    auto* self = static_cast<AravisFakeCamera*>(self_pointer);
    const CameraSettings wanted = self->settings();
    std::size_t ignored = 0;  // received bytes, 0 here, not the capacity
    auto* data = static_cast<std::byte*>(const_cast<void*>(arv_buffer_get_data(buffer, &ignored)));
    // The payload Aravis allocated, from its registers when streaming began.
    const FrameFormat format{arv_buffer_get_image_width(buffer), arv_buffer_get_image_height(buffer),
                             wanted.pixel_format};
    if (data == nullptr || format.width != self->setup_.model.format.width ||
        format.height != self->setup_.model.format.height)
      return;
    const auto id = static_cast<std::uint16_t>(arv_buffer_get_frame_id(buffer));
    const std::int64_t time_ns = self->frames_->take(wanted, id, {data, format.bytes()});
    if (time_ns != 0) arv_buffer_set_timestamp(buffer, static_cast<guint64>(time_ns));
  }

  ArvGvFakeCamera* device_;
  ArvFakeCamera* camera_;
  ProbeSetup setup_;
  std::unique_ptr<PreparedFrames> frames_;
};

}  // namespace

Result<std::unique_ptr<GigeCamera>> GigeCamera::start(const GigeCameraOptions& options,
                                                      const ProbeSetup& setup,
                                                      std::function<void(const SentFrame&)> sent) {
  in_addr address{};
  if (Status status = check_address(options.address, address); !status) return status.error();
  list_loopback_address(ntohl(address.s_addr));
  FrameGenerator generator(setup.scene, setup.model);         // takes a while: before anybody can connect
  g_random_set_seed(static_cast<guint32>(setup.model.seed));  // which packets are lost
  const MemoryFile xml(kProbeCameraXml);
  if (!xml.whole()) return Error{ErrorKind::failed, "cannot hold the GenICam description in memory"};
  char serial[16];
  std::snprintf(serial, sizeof serial, "SIM-%08X", ntohl(address.s_addr));
  auto* device = static_cast<ArvGvFakeCamera*>(
      g_object_new(ARV_TYPE_GV_FAKE_CAMERA, "interface-name", options.address.c_str(), "serial-number",
                   serial, "genicam-filename", xml.path(), "gvsp-lost-ratio", options.loss, nullptr));
  if (!arv_gv_fake_camera_is_running(device)) {
    g_object_unref(device);
    return Error{ErrorKind::failed, "address " + options.address + ": no network interface has it"};
  }
  return std::unique_ptr<GigeCamera>(
      std::make_unique<AravisFakeCamera>(device, setup, std::move(generator), std::move(sent)));
}

}  // namespace lightwell::simulator
