// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The link to the sync board against the board's own firmware as a USB device of the same kernel: dummy_hcd and FunctionFS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>
#include <optional>
#include <string>
#include <utility>

#include "daemon/sync/sync_link.h"
#include "interface/sync_frame.h"
#include "tests/hardware/usb_gadget.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr const char* kSilence = "not answered";

// A host that speaks and listens, and counts what was lost on the way.
class Host {
 public:
  explicit Host(std::unique_ptr<SyncLink> link) : link_(std::move(link)) { frame_receiver_init(&receiver_); }

  Status send(const sync_message& message) {
    std::array<std::uint8_t, SYNC_MAX_WIRE> wire{};
    const std::size_t size = frame_encode_message(&message, sequence_++, wire.data());
    return link_->write(std::span(wire).first(size));
  }
  // The next message of a type, within a time that only a broken link takes.
  Result<sync_message> next(sync_type type, milliseconds limit = seconds(20)) {
    for (const auto end = Clock::now() + limit;;) {
      while (!received_.empty()) {
        const sync_message message = received_.front();
        received_.pop_front();
        if (message.type == type) return message;
      }
      if (Clock::now() > end) return Error{ErrorKind::failed, kSilence};
      std::array<std::uint8_t, 300> bytes{};
      const auto size = link_->read(bytes, milliseconds(50));
      if (!size) return size.error();
      for (std::size_t i = 0; i < *size; ++i) take(bytes[i]);
    }
  }
  // Said until it is answered: a board that had nobody to speak to is full of what it wanted to say.
  Status greet() {
    for (int i = 0; i < 40; ++i) {
      sync_message message{};
      message.type = SYNC_HELLO_REQUEST;
      if (Status sent = send(message); !sent) return sent;
      if (!next(SYNC_HELLO, milliseconds(500))) continue;
      lost_ = 0;
      return {};
    }
    return Error{ErrorKind::failed, "no hello"};
  }
  Result<sync_message> ask(sync_type question, sync_type answer) {
    sync_message message{};
    message.type = static_cast<std::uint8_t>(question);
    if (Status sent = send(message); !sent) return sent.error();
    return next(answer);
  }
  // Pings, a few on their way at a time, until so many have come back as they were, in order. A board that is held up drops
  // answers whole, and its sequence says so: these are asked for again. One that is missing without that was lost by the link.
  Status ping(std::uint64_t count) {
    constexpr std::uint64_t kAtATime = 8;
    const auto mark = [](std::uint64_t i) { return (i + 1) * 0x0123456789abcdefU; };
    unsigned known_lost = lost_;
    for (std::uint64_t sent = 0, answered = 0; answered < count;) {
      for (; sent < count && sent - answered < kAtATime; ++sent) {
        sync_message message{};
        message.type = SYNC_PING;
        message.ping.t_host_ns = mark(sent);
        if (Status written = send(message); !written) return written;
      }
      const auto answer = next(SYNC_PONG, seconds(10));
      if (answer && answer->pong.t_host_ns == mark(answered)) {
        ++answered;
      } else if (!answer) {
        if (answer.error().message != kSilence) return answer.error();
        if (std::exchange(known_lost, lost_) == lost_)
          return Error{ErrorKind::failed, "ping " + std::to_string(answered) + " of the link is lost"};
        sent = answered;
      }
    }
    return {};
  }
  // The link's last words.
  std::string listen_to_the_end() {
    std::array<std::uint8_t, 300> bytes{};
    for (const auto end = Clock::now() + seconds(20); Clock::now() < end;)
      if (const auto size = link_->read(bytes, milliseconds(50)); !size) return size.error().message;
    return "it goes on";
  }
  [[nodiscard]] std::uint32_t damaged() const { return receiver_.damaged; }

 private:
  void take(std::uint8_t byte) {
    frame_view frame{};
    sync_message message{};
    if (!frame_receive(&receiver_, byte, &frame)) return;
    if (last_) lost_ += static_cast<std::uint16_t>(frame.sequence - *last_ - 1);
    last_ = frame.sequence;
    if (frame_message(&frame, &message)) received_.push_back(message);
  }

  std::unique_ptr<SyncLink> link_;
  frame_receiver receiver_{};
  std::deque<sync_message> received_;
  std::uint16_t sequence_ = 0;
  std::optional<std::uint16_t> last_;
  unsigned lost_ = 0;
};

class UsbLinkOnGadget : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/sys/class/udc/dummy_udc.0"))
      GTEST_SKIP() << "there is no dummy_udc: run in the virtual machine";
  }
  // What the port waits for, in a time that only a port that sleeps through it takes.
  static std::unique_ptr<Host> open(SyncPort& port) {
    std::string why;
    for (const auto end = Clock::now() + seconds(30); Clock::now() < end;) {
      auto link = port.open();
      if (link) {
        auto host = std::make_unique<Host>(std::move(*link));
        const Status greeted = host->greet();
        if (greeted) return host;
        why = greeted.error().message;
      } else {
        why = link.error().message;
      }
      while (!port.wait(milliseconds(50)) && Clock::now() < end) continue;
    }
    ADD_FAILURE() << why;
    return nullptr;
  }
  TemporaryFolder folder_;
};

TEST_F(UsbLinkOnGadget, ABoardSaysHelloAndTakesItsConfiguration) {
  UsbGadget gadget(folder_.path(), 0, 7);
  EXPECT_EQ(gadget.serial(), "53494d554c41544f00000007");
  const auto port = make_usb_port("");
  const auto host = open(*port);
  ASSERT_TRUE(host);
  const auto hello = host->ask(SYNC_HELLO_REQUEST, SYNC_HELLO);
  ASSERT_TRUE(hello) << hello.error().message;
  EXPECT_EQ(hello->hello.schema_hash, SYNC_SCHEMA_HASH);
  EXPECT_EQ(hello->hello.serial[2], 7U);
  auto configuration = host->ask(SYNC_CONFIGURATION_REQUEST, SYNC_CONFIGURATION);
  ASSERT_TRUE(configuration);
  sync_message wanted = *configuration;
  wanted.type = SYNC_CONFIGURE;
  wanted.configuration.rate_numerator = 30000;
  wanted.configuration.rate_denominator = 1001;
  ASSERT_TRUE(host->send(wanted));
  configuration = host->next(SYNC_CONFIGURATION);
  ASSERT_TRUE(configuration);
  EXPECT_EQ(configuration->configuration.rate_numerator, 30000U);
  EXPECT_EQ(configuration->configuration.rate_denominator, 1001U);
}

TEST_F(UsbLinkOnGadget, TenThousandMessagesComeBackWholeAndInOrder) {
  UsbGadget gadget(folder_.path(), 0, 1);
  const auto port = make_usb_port("");
  const auto host = open(*port);
  ASSERT_TRUE(host);
  const auto begin = Clock::now();
  const Status echoed = host->ping(10'000);
  ASSERT_TRUE(echoed) << echoed.error().message;
  RecordProperty("messages_per_second",
                 std::to_string(1e4 / std::chrono::duration<double>(Clock::now() - begin).count()));
  EXPECT_EQ(host->damaged(), 0U);
}

TEST_F(UsbLinkOnGadget, HaltedEndpointsAreSetGoingAgainAndNothingThatWasToldIsLost) {
  UsbGadget gadget(folder_.path(), 0, 1, {"--stall-every", "0.1"});
  const auto port = make_usb_port("");
  const auto host = open(*port);
  ASSERT_TRUE(host);
  const auto halts = [&] {
    const std::string log = gadget.process().stderr_text();
    return std::count(log.begin(), log.end(), '\n');
  };
  for (const auto end = Clock::now() + seconds(30); halts() < 10 && Clock::now() < end;) {
    const Status echoed = host->ping(100);
    ASSERT_TRUE(echoed) << echoed.error().message << " after " << halts() << " halts";
  }
  EXPECT_GE(halts(), 10) << gadget.process().stderr_text();
}

TEST_F(UsbLinkOnGadget, ACableThatIsPulledEndsTheLinkAndItsReturnIsAnnounced) {
  UsbGadget gadget(folder_.path(), 0, 1);
  const auto port = make_usb_port("");
  for (int i = 0; i < 3; ++i) {
    auto host = open(*port);
    ASSERT_TRUE(host);
    ASSERT_TRUE(host->ping(50));
    gadget.unplug();
    EXPECT_THAT(host->listen_to_the_end(), testing::StartsWith("sync board: "));
    host.reset();
    // What was announced before is no longer news.
    ASSERT_TRUE(eventually([&] { return !port->open() && !port->wait(milliseconds(400)); }));
    EXPECT_EQ(port->open().error().message, "no sync board on USB");
    gadget.plug();
  }
  EXPECT_TRUE(open(*port));
}

TEST_F(UsbLinkOnGadget, ABoardThatDiesAmidItsWordsEndsTheLinkAndTheNextOneIsFound) {
  const auto port = make_usb_port("");
  for (int i = 0; i < 3; ++i) {
    UsbGadget gadget(folder_.path(), 0, i);
    auto host = open(*port);
    ASSERT_TRUE(host);
    std::string last_words;
    ASSERT_TRUE(host->ping(20));
    gadget.process().send(SIGKILL);
    while (last_words.empty())
      if (const Status echoed = host->ping(8); !echoed) last_words = echoed.error().message;
    EXPECT_THAT(last_words, testing::StartsWith("sync board: "));
  }
}

TEST_F(UsbLinkOnGadget, ALinkMayEndWhileTheBoardSpeaks) {
  UsbGadget gadget(folder_.path(), 0, 1);
  const auto port = make_usb_port("");
  for (int i = 0; i < 20; ++i) {
    const auto host = open(*port);
    ASSERT_TRUE(host);
    sync_message message{};
    message.type = SYNC_STATUS_REQUEST;
    for (int k = 0; k < 10; ++k) ASSERT_TRUE(host->send(message));
  }
}

TEST_F(UsbLinkOnGadget, TwoBoardsAreToldApartByTheirSerialNumbers) {
  UsbGadget fast(folder_.path(), 0, 1), slow(folder_.path(), 1, 2, {"--full-speed"});
  const auto first = make_usb_port(fast.serial()), second = make_usb_port(slow.serial());
  const auto at_fast = open(*first), at_slow = open(*second);
  ASSERT_TRUE(at_fast && at_slow);
  EXPECT_EQ(at_fast->ask(SYNC_HELLO_REQUEST, SYNC_HELLO)->hello.serial[2], 1U);
  EXPECT_EQ(at_slow->ask(SYNC_HELLO_REQUEST, SYNC_HELLO)->hello.serial[2], 2U);
  EXPECT_TRUE(at_slow->ping(300)) << "packets of 64 bytes";
  const auto taken = open_sync_link({SyncAddress::Kind::usb, ""});
  ASSERT_FALSE(taken);
  EXPECT_THAT(taken.error().message, testing::HasSubstr("another program uses it"));
  const auto third = open_sync_link({SyncAddress::Kind::usb, "00"});
  ASSERT_FALSE(third);
  EXPECT_EQ(third.error().message, "no sync board 00 on USB");
}

// A vendor's device of another kind: Linux's own source and sink, class ff, subclass 0.
class OtherDevice {
 public:
  OtherDevice() {
    namespace fs = std::filesystem;
    fs::create_directory(root_);
    std::ofstream(root_ / "idVendor") << "0x1209";
    std::ofstream(root_ / "idProduct") << "0x0002";
    fs::create_directory(root_ / "configs/c.1");
    fs::create_directory(root_ / "functions/SourceSink.0");
    fs::create_symlink(root_ / "functions/SourceSink.0", root_ / "configs/c.1/SourceSink.0");
    EXPECT_TRUE(std::ofstream(root_ / "UDC") << "dummy_udc.1" << std::flush);
  }
  ~OtherDevice() {
    std::ofstream(root_ / "UDC") << "\n" << std::flush;
    for (const char* part : {"configs/c.1/SourceSink.0", "configs/c.1", "functions/SourceSink.0", ""})
      std::filesystem::remove(root_ / part);
  }

 private:
  std::filesystem::path root_ = "/sys/kernel/config/usb_gadget/other";
};

TEST_F(UsbLinkOnGadget, ADeviceOfAnotherKindIsPassedBy) {
  const auto port = make_usb_port("");
  EXPECT_FALSE(port->open());
  OtherDevice other;
  ASSERT_TRUE(eventually([&] { return port->wait(milliseconds(50)); })) << "its arrival is announced";
  const auto none = port->open();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message, "no sync board on USB");
  UsbGadget gadget(folder_.path(), 0, 1);
  const auto host = open(*port);
  ASSERT_TRUE(host);
  EXPECT_TRUE(host->ask(SYNC_HELLO_REQUEST, SYNC_HELLO));
}

// Microsoft OS 1.0 descriptors: a string by which Windows learns the request, and the two descriptors it answers.
TEST_F(UsbLinkOnGadget, WindowsIsToldThatTheDriverIsWinUsb) {
  UsbGadget gadget(folder_.path(), 0, 1);
  libusb_context* context = nullptr;
  ASSERT_EQ(libusb_init(&context), 0);
  libusb_device_handle* handle = nullptr;
  ASSERT_TRUE(eventually([&] {
    handle = libusb_open_device_with_vid_pid(context, 0x1209, 0x0001);
    return handle != nullptr;
  }));
  std::array<unsigned char, 256> bytes{};
  ASSERT_EQ(libusb_get_string_descriptor(handle, 0xee, 0, bytes.data(), bytes.size()), 18);
  const std::string signature{static_cast<char>(bytes[2]), static_cast<char>(bytes[4]),
                              static_cast<char>(bytes[6]), static_cast<char>(bytes[8])};
  EXPECT_EQ(signature, "MSFT");
  const std::uint8_t request = bytes[16];
  ASSERT_EQ(libusb_control_transfer(handle, 0xc0, request, 0, 4, bytes.data(), bytes.size(), 2000), 40);
  EXPECT_EQ(std::memcmp(&bytes[18], "WINUSB\0", 8), 0);
  const int size = libusb_control_transfer(handle, 0xc1, request, 0, 5, bytes.data(), bytes.size(), 2000);
  ASSERT_GT(size, 100);
  std::string text;  // UTF-16, of which only the lower halves are letters
  for (int i = 0; i < size; ++i)
    if (const auto c = static_cast<char>(bytes[static_cast<std::size_t>(i)]); c != 0) text += c;
  EXPECT_THAT(text, testing::HasSubstr("DeviceInterfaceGUID"));
  EXPECT_THAT(text, testing::HasSubstr("{5c1d3f2e-7a64-4b0d-9c0b-2f4c57a1e6d8}"));
  libusb_close(handle);
  libusb_exit(context);
}

}  // namespace
}  // namespace lightwell::test
