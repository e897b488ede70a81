// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The capture contract on the kernel's own drivers.
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <cstring>
#include <filesystem>

#include "daemon/capture/list_libcamera.h"
#include "tests/hardware/loopback_writer.h"
#include "tests/support/capture_contract.h"

namespace lightwell::test {
namespace {

std::string no_node(const std::string& path) {
  return std::filesystem::exists(path) ? std::string()
                                       : "there is no " + path + ": run in the virtual machine";
}

std::unique_ptr<CaptureSource> made(const std::string& source, const CaptureOptions& options) {
  auto result = make_capture_source(source, options);
  if (result.ok()) return std::move(result).value();
  ADD_FAILURE() << result.error().message;
  return nullptr;
}

// vivid's webcam at the rate an emulated processor holds, on buffers it exports.
template <int number>
struct VividSubject {
  static CaptureOptions options() {
    CaptureOptions o;
    o.width = 320;
    o.height = 180;
    o.pixel_format = "Mono16";
    o.rate_hz = 60;
    o.exposure_us = 1000;  // vivid has no exposure to read
    return o;
  }
  std::string path = "/dev/video" + std::to_string(number);
  std::string missing() { return no_node(path); }
  std::unique_ptr<CaptureSource> make() { return made("v4l2:" + path, options()); }
  std::unique_ptr<CaptureSource> make_silent() {
    return made("v4l2:/dev/video99", options());
  }  // nobody there
};
INSTANTIATE_TYPED_TEST_SUITE_P(Vivid, CaptureContract, VividSubject<10>);
INSTANTIATE_TYPED_TEST_SUITE_P(VividMultiPlanar, CaptureContract, VividSubject<11>);

struct LoopbackSubject {
  std::unique_ptr<LoopbackWriter> writer;
  std::string missing() {
    if (const std::string why = no_node("/dev/video20"); !why.empty()) return why;
    writer = std::make_unique<LoopbackWriter>("/dev/video20", V4L2_PIX_FMT_GREY, 64, 48);
    writer->run(100, [](std::uint64_t n, std::span<std::byte> frame) {
      std::memset(frame.data(), static_cast<int>(n % 251), frame.size());
    });
    return {};
  }
  static CaptureOptions options() {
    CaptureOptions o;
    o.exposure_us = 1000;
    return o;
  }
  std::unique_ptr<CaptureSource> make() { return made("v4l2:/dev/video20", options()); }
  std::unique_ptr<CaptureSource> make_silent() {
    return made("v4l2:/dev/video21", options());
  }  // nobody writes
};
INSTANTIATE_TYPED_TEST_SUITE_P(V4l2Loopback, CaptureContract, LoopbackSubject);

#ifdef LIGHTWELL_LIBCAMERA
// vimc through libcamera.
struct LibcameraSubject {
  std::string id;
  std::string missing() {
    static const auto cameras = list_libcamera();  // once: to look takes an emulated machine a second
    if (cameras.empty()) return "libcamera sees no camera: run in the virtual machine";
    id = cameras.front().id;
    return {};
  }
  static CaptureOptions options() {
    CaptureOptions o;
    o.width = 192;  // vimc scales by three and wants multiples of six
    o.height = 120;
    o.exposure_us = 1000;
    return o;
  }
  std::unique_ptr<CaptureSource> make() { return made("libcamera:" + id, options()); }
  std::unique_ptr<CaptureSource> make_silent() { return made("libcamera:nobody", options()); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Libcamera, CaptureContract, LibcameraSubject);
#endif

}  // namespace
}  // namespace lightwell::test
