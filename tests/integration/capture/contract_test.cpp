// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <arv.h>
#include <gtest/gtest.h>

#include "daemon/capture/v4l2_source.h"
#include "tests/integration/capture/fake_camera.h"
#include "tests/support/capture_contract.h"
#include "tests/support/fake_v4l2.h"
#include "tests/support/private_network.h"
#include "tests/support/takes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

const auto* const kNetwork = testing::AddGlobalTestEnvironment(new PrivateNetwork);

std::unique_ptr<CaptureSource> made(const std::string& source, const CaptureOptions& options = {}) {
  auto result = make_capture_source(source, options);
  if (result.ok()) return std::move(result).value();
  ADD_FAILURE() << result.error().message;
  return nullptr;
}

struct AravisSubject {
  FakeCamera camera{64, 48, 100};
  std::string missing() {
    if (!PrivateNetwork::reason().empty()) return PrivateNetwork::reason();
    return camera.ready() ? std::string() : "the fake camera does not start";
  }
  std::unique_ptr<CaptureSource> make() { return made("aravis:127.0.0.1"); }
  std::unique_ptr<CaptureSource> make_silent() { return made("aravis:127.0.0.2"); }  // nobody there
};
INSTANTIATE_TYPED_TEST_SUITE_P(Aravis, CaptureContract, AravisSubject);

CaptureOptions small(double rate_hz) {
  CaptureOptions options;
  options.width = 64;
  options.height = 48;
  options.rate_hz = rate_hz;
  return options;
}

// A camera that is no GigE Vision camera, found by its name: Aravis's own fake, in this process. What USB3 Vision has of
// its own lies below Aravis's interface.
struct NamedSubject {
  std::string missing() {
    if (!PrivateNetwork::reason().empty())
      return PrivateNetwork::reason();  // names are looked for on networks too
    arv_enable_interface("Fake");
    return {};
  }
  std::unique_ptr<CaptureSource> make() { return made("aravis:Fake_1", small(100)); }
  std::unique_ptr<CaptureSource> make_silent() { return made("aravis:Nobody-1", small(100)); }
  ~NamedSubject() { arv_disable_interface("Fake"); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(AravisByName, CaptureContract, NamedSubject);

struct SimulatedSubject {
  std::string missing() { return {}; }
  std::unique_ptr<CaptureSource> make() { return made("simulated:studio", small(100)); }
  std::unique_ptr<CaptureSource> make_silent() { return made("simulated:studio", small(0.01)); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Simulated, CaptureContract, SimulatedSubject);

// A take at 100 Hz, played as recorded; silent is one of whose frames none is whole.
struct RecordingSubject {
  TemporaryFolder folder;
  std::string missing() { return {}; }
  std::filesystem::path take(const char* name, std::uint32_t count) {
    const FrameFormat format{16, 12, PixelFormat::mono8};
    auto frames = take_frames(format, count);
    for (std::uint32_t i = 0; i < count; ++i) frames[i].info.capture_mono_ns = std::int64_t{i} * 10'000'000;
    for (auto& frame : frames) frame.info.received_mono_ns = frame.info.capture_mono_ns + 1'000'000;
    auto header = take_header(format, RecordingCodec::raw);
    header.rate_hz = 100;
    write_take(folder.path() / name, header, frames);
    return folder.path() / name;
  }
  std::unique_ptr<CaptureSource> make() { return made("recording:" + take("take.mkv", 1500).string()); }
  std::unique_ptr<CaptureSource> make_silent() {
    const auto file = take("silent.mkv", 1);
    std::string bytes = file_bytes(file);
    const Codes codes = take_frame({16, 12, PixelFormat::mono8}, 0).codes;
    const std::size_t at = bytes.find({reinterpret_cast<const char*>(codes.data()), codes.size()});
    bytes.at(at) ^= 1;
    write_bytes(file, bytes);
    return made("recording:" + file.string());
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Recording, CaptureContract, RecordingSubject);

// A V4L2 driver in this process; on real drivers the same suite runs in a virtual machine (tests/hardware). Direct: its
// buffers are handed on; copying: they are unpacked.
template <bool direct>
struct V4l2Subject {
  FakeV4l2 device{[] {
    FakeV4l2Model model;
    model.exports = direct;
    return model;
  }()};
  std::string missing() { return {}; }
  std::unique_ptr<CaptureSource> make() {
    device.run();
    return make_v4l2_source(FakeV4l2::kPath, CaptureOptions{}, device);
  }
  std::unique_ptr<CaptureSource> make_silent() {
    device.hush();
    return make_v4l2_source(FakeV4l2::kPath, CaptureOptions{}, device);
  }
};
INSTANTIATE_TYPED_TEST_SUITE_P(V4l2Direct, CaptureContract, V4l2Subject<true>);
INSTANTIATE_TYPED_TEST_SUITE_P(V4l2Copying, CaptureContract, V4l2Subject<false>);

}  // namespace
}  // namespace lightwell::test
