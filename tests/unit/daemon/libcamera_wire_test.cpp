// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/libcamera_wire.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstring>

namespace lightwell {
namespace {

class LibcameraWire : public testing::Test {
 protected:
  LibcameraWire() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends_.data()), 0); }
  ~LibcameraWire() override {
    for (const int fd : ends_) ::close(fd);
  }
  void hang_up() {
    ::close(ends_[0]);
    ends_[0] = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
  }
  std::array<int, 2> ends_{};
};

TEST_F(LibcameraWire, EveryKindArrivesAsItWasSentAndInOrder) {
  LibcameraMessage fault{}, frame{}, give_back{}, go{};
  fault.kind = LibcameraMessage::Kind::fault;
  fault.fault = {};
  fault.fault.state = SourceState::no_device;
  put_text(fault.fault.message, std::string(5000, 'x'));
  frame.kind = LibcameraMessage::Kind::frame;
  frame.frame = {3,
                 SessionFrame::Outcome::complete,
                 SessionFrame::Stamp::end_of_frame,
                 std::uint64_t{1} << 40,
                 123,
                 456,
                 1.5,
                 2.5,
                 29.97};
  give_back.kind = LibcameraMessage::Kind::give_back;
  give_back.buffer = 63;
  go.kind = LibcameraMessage::Kind::go;
  for (const LibcameraMessage& message : {fault, frame, give_back, go})
    ASSERT_TRUE(send_message(ends_[0], message));
  LibcameraMessage got{};
  ASSERT_TRUE(receive_message(ends_[1], got));
  EXPECT_EQ(got.kind, LibcameraMessage::Kind::fault);
  EXPECT_EQ(got.fault.state, SourceState::no_device);
  EXPECT_EQ(std::string(got.fault.message.data()), std::string(fault.fault.message.size() - 1, 'x'))
      << "cut, and ended";
  ASSERT_TRUE(receive_message(ends_[1], got));
  EXPECT_EQ(std::memcmp(&got.frame, &frame.frame, sizeof frame.frame), 0);
  ASSERT_TRUE(receive_message(ends_[1], got));
  EXPECT_EQ(got.kind, LibcameraMessage::Kind::give_back);
  EXPECT_EQ(got.buffer, 63U);
  ASSERT_TRUE(receive_message(ends_[1], got));
  EXPECT_EQ(got.kind, LibcameraMessage::Kind::go);
}

TEST_F(LibcameraWire, DescriptorsOfEveryBufferComeAlong) {
  std::vector<int> memories;
  for (std::size_t i = 0; i < LibcameraMessage::kMostBuffers; ++i) {
    memories.push_back(::memfd_create("wire", MFD_CLOEXEC));
    const auto mark = static_cast<char>(i);
    ASSERT_EQ(::write(memories.back(), &mark, 1), 1);
  }
  LibcameraMessage ready{}, got{};
  ready.kind = LibcameraMessage::Kind::ready;
  ready.ready = {};
  ASSERT_TRUE(send_message(ends_[0], ready, memories));
  for (const int fd : memories) ::close(fd);
  std::vector<int> arrived;
  ASSERT_TRUE(receive_message(ends_[1], got, &arrived));
  ASSERT_EQ(arrived.size(), memories.size());
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    char mark = -1;
    EXPECT_EQ(::pread(arrived[i], &mark, 1, 0), 1);
    EXPECT_EQ(mark, static_cast<char>(i));
    EXPECT_NE(::fcntl(arrived[i], F_GETFD) & FD_CLOEXEC, 0);
    ::close(arrived[i]);
  }
}

TEST_F(LibcameraWire, HangingUpAndHalfAMessageAreNoMessage) {
  LibcameraMessage got{};
  const auto kind = LibcameraMessage::Kind::frame;
  ASSERT_EQ(::send(ends_[0], &kind, sizeof kind, 0), static_cast<ssize_t>(sizeof kind));
  EXPECT_FALSE(receive_message(ends_[1], got));
  hang_up();
  EXPECT_FALSE(receive_message(ends_[1], got));
  EXPECT_FALSE(send_message(ends_[1], got));
}

}  // namespace
}  // namespace lightwell
