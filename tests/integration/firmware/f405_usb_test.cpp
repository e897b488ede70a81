// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The STM32F405's real image on an emulated chip: its USB, token by token.

#include <gtest/gtest.h>

#include <string>

#include "interface/sync_usb.h"
#include "tests/integration/firmware/f405_board.h"
#include "tests/integration/firmware/firmware_build.h"

namespace lightwell::test {
namespace {

using Bytes = UsbHost::Bytes;

class F405Usb : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"arm-none-eabi-gcc", "cmake", "ninja"})
      if (!have(program)) GTEST_SKIP() << program << " is not installed";
    const std::string folder = built_firmware();
    ASSERT_FALSE(folder.empty());
    board = std::make_unique<F405Board>(folder);
    if (!board->chip.has_symbol("tud_task"))
      GTEST_SKIP() << "built without TinyUSB, which could not be fetched";
    ASSERT_TRUE(board->chip.run(1, [&] { return board->usb.attached(); }));
  }
  void TearDown() override {
    if (board) {
      EXPECT_EQ(board->chip.misuses, std::vector<std::string>{});
    }
  }
  static std::string text_of(const Bytes& descriptor) {
    std::string text;
    for (std::size_t i = 2; i + 1 < descriptor.size(); i += 2) text += static_cast<char>(descriptor[i]);
    return text;
  }

  std::unique_ptr<F405Board> board;
};

TEST_F(F405Usb, SaysWhatItIs) {
  auto& host = board->host;
  host.bus_reset();
  const auto first = host.descriptor(1, 0, 0, 64);  // as hosts ask before there is an address
  ASSERT_TRUE(first);
  ASSERT_TRUE(host.control_out(0x00, 5, 5, 0));
  const auto device = host.descriptor(1, 0);
  ASSERT_TRUE(device);
  EXPECT_EQ(*device, *first);
  ASSERT_EQ(device->size(), 18u);
  EXPECT_EQ((*device)[2] | (*device)[3] << 8, 0x0210);  // there is a BOS descriptor
  EXPECT_EQ((*device)[7], 64);

  const auto head = host.descriptor(2, 0, 0, 9);
  ASSERT_TRUE(head);
  ASSERT_EQ(head->size(), 9u);
  const auto whole = host.descriptor(2, 0);
  ASSERT_TRUE(whole);
  ASSERT_EQ(whole->size(), (*head)[2]);
  EXPECT_EQ((*whole)[4], 1);  // one interface
  const Bytes interface(whole->begin() + 9, whole->begin() + 18);
  EXPECT_EQ(interface[4], 2);
  EXPECT_EQ(interface[5], SYNC_USB_CLASS);
  EXPECT_EQ(interface[6], SYNC_USB_SUBCLASS);
  EXPECT_EQ(interface[7], SYNC_USB_PROTOCOL);
  EXPECT_EQ(Bytes(whole->begin() + 18, whole->end()),
            (Bytes{7, 5, 0x01, 2, 64, 0, 0, 7, 5, 0x81, 2, 64, 0, 0}));

  const auto languages = host.descriptor(3, 0);
  ASSERT_TRUE(languages);
  EXPECT_EQ(*languages, (Bytes{4, 3, 0x09, 0x04}));
  EXPECT_EQ(text_of(*host.descriptor(3, (*device)[14], 0x0409)), "Lightwell");
  EXPECT_EQ(text_of(*host.descriptor(3, (*device)[15], 0x0409)), "Lightwell sync board");
  char serial[25];
  std::snprintf(serial, sizeof serial, "%08x%08x%08x", Stm32F405::kSerial[0], Stm32F405::kSerial[1],
                Stm32F405::kSerial[2]);
  EXPECT_EQ(text_of(*host.descriptor(3, (*device)[16], 0x0409)), serial);
  EXPECT_FALSE(host.descriptor(3, 9, 0x0409));
  EXPECT_EQ(host.last, Stm32F405Usb::Answer::kStall);
}

// Microsoft OS 2.0 Descriptors Specification: every length says where the next begins.
TEST_F(F405Usb, WindowsFindsItsDriver) {
  auto& host = board->host;
  ASSERT_TRUE(host.enumerate());
  const auto bos = host.descriptor(15, 0);
  ASSERT_TRUE(bos);
  ASSERT_EQ(bos->size(), 33u);
  EXPECT_EQ((*bos)[2], 33);
  EXPECT_EQ((*bos)[4], 1);
  const Bytes platform(bos->begin() + 5, bos->end());
  EXPECT_EQ(Bytes(platform.begin(), platform.begin() + 4), (Bytes{28, 16, 5, 0}));
  const Bytes microsoft = {0xDF, 0x60, 0xDD, 0xD8, 0x89, 0x45, 0xC7, 0x4C,
                           0x9C, 0xD2, 0x65, 0x9D, 0x9E, 0x64, 0x8A, 0x9F};
  EXPECT_EQ(Bytes(platform.begin() + 4, platform.begin() + 20), microsoft);
  const auto size = static_cast<std::uint16_t>(platform[24] | platform[25] << 8);
  const auto set = host.control_in(0xC0, platform[26], 0, 7, size);
  ASSERT_TRUE(set);
  ASSERT_EQ(set->size(), size);
  const auto word = [&](std::size_t at) { return (*set)[at] | (*set)[at + 1] << 8; };
  EXPECT_EQ(word(0), 10);
  EXPECT_EQ(word(8), size);
  EXPECT_EQ(word(10), 20);
  EXPECT_EQ(word(12), 3);
  EXPECT_EQ(std::string(set->begin() + 14, set->begin() + 22), std::string("WINUSB\0\0", 8));
  EXPECT_EQ(word(30) + 30, size);
  EXPECT_EQ(word(32), 4);
  EXPECT_EQ(word(34), 7);
  const std::size_t name = static_cast<std::size_t>(word(36)),
                    value = static_cast<std::size_t>(word(38 + name));
  EXPECT_EQ(text_of(Bytes(set->begin() + 36, set->begin() + 38 + static_cast<std::ptrdiff_t>(name))),
            std::string("DeviceInterfaceGUIDs\0", 21));
  EXPECT_EQ(40 + name + value, size);
  const std::string guid = text_of(Bytes(set->begin() + 38 + static_cast<std::ptrdiff_t>(name), set->end()));
  EXPECT_EQ(guid.size(), 40u);
  EXPECT_EQ(guid.substr(37), std::string("}\0\0", 3));
  // Another index, another request: not known.
  EXPECT_FALSE(host.control_in(0xC0, platform[26], 0, 4, size));
  EXPECT_EQ(host.last, Stm32F405Usb::Answer::kStall);
  EXPECT_FALSE(host.control_in(0xC0, 0x77, 0, 7, size));
  EXPECT_EQ(host.last, Stm32F405Usb::Answer::kStall);
  EXPECT_TRUE(host.descriptor(1, 0));  // and the next SETUP ends the stall
}

TEST_F(F405Usb, CarriesTheProtocol) {
  ASSERT_TRUE(board->host.enumerate());
  const auto* hello = board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO);
  ASSERT_NE(hello, nullptr);
  EXPECT_EQ(hello->hello.schema_hash, SYNC_SCHEMA_HASH);
  EXPECT_EQ(hello->hello.tick_hz, 84'000'000u);
  EXPECT_TRUE(std::equal(hello->hello.serial, hello->hello.serial + 3, Stm32F405::kSerial));
  for (unsigned i = 0; i < 100; ++i) {
    auto ping = message_of(SYNC_PING);
    ping.ping.t_host_ns = i;
    const auto* pong = board->ask_usb(ping, SYNC_PONG);
    ASSERT_NE(pong, nullptr) << i;
    EXPECT_EQ(pong->pong.t_host_ns, i);
  }
  EXPECT_EQ(board->usb_line.damaged(), 0u);
}

// Answers of many lengths together, whole packets among them: the host's read ends with each, none waits for the next one.
TEST_F(F405Usb, NoAnswerWaitsForTheNextOne) {
  ASSERT_TRUE(board->host.enumerate());
  ASSERT_NE(board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr);
  for (unsigned pings = 1; pings <= 24; ++pings) {
    board->usb_line.messages.clear();
    Bytes all;
    for (unsigned i = 0; i < pings; ++i) {
      const Bytes frame = board->usb_line.frame(message_of(SYNC_PING));
      all.insert(all.end(), frame.begin(), frame.end());
    }
    board->host.write(1, all);
    const auto pongs = [&] {
      return std::count_if(board->usb_line.messages.begin(), board->usb_line.messages.end(),
                           [](const sync_message& message) { return message.type == SYNC_PONG; });
    };
    for (int i = 0; i < 100 && pongs() < pings; ++i) board->usb_line.take(board->host.read(1));
    ASSERT_EQ(pongs(), pings);
  }
  EXPECT_EQ(board->usb_line.damaged(), 0u);
}

TEST_F(F405Usb, ABusResetInTheMidstOfAFrameStartsAnew) {
  auto& host = board->host;
  ASSERT_TRUE(host.enumerate());
  ASSERT_NE(board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr);
  for (int i = 0; i < 5; ++i) {
    const Bytes frame = board->usb_line.frame(message_of(SYNC_STATUS_REQUEST));
    host.out(1, Bytes(frame.begin(), frame.begin() + 3 + i));
    if (i % 2 == 1) {  // while an answer is on its way, and another waits
      host.write(1, board->usb_line.frame(message_of(SYNC_STATUS_REQUEST)));
      host.write(1, board->usb_line.frame(message_of(SYNC_STATUS_REQUEST)));
    }
    host.bus_reset();
    EXPECT_FALSE(host.out(1, {0})) << "no endpoint is open before the configuration";
    ASSERT_TRUE(host.enumerate());
    board->usb_line = FrameLine();
    host.write(1, {0});  // ends what was begun
    ASSERT_NE(board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr);
  }
}

TEST_F(F405Usb, AHaltedEndpointGoesOnOnceItIsCleared) {
  auto& host = board->host;
  ASSERT_TRUE(host.enumerate());
  ASSERT_NE(board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr);
  for (const std::uint16_t endpoint : {std::uint16_t{0x01}, std::uint16_t{0x81}}) {
    ASSERT_TRUE(host.control_out(0x02, 3, 0, endpoint));
    const auto status = host.control_in(0x82, 0, 0, endpoint, 2);
    ASSERT_TRUE(status);
    EXPECT_EQ(*status, (Bytes{1, 0}));
    if (endpoint == 0x01) {
      EXPECT_FALSE(host.out(1, {0}));
    } else {
      EXPECT_FALSE(host.in(1));
    }
    EXPECT_EQ(host.last, Stm32F405Usb::Answer::kStall);
    ASSERT_TRUE(host.control_out(0x02, 1, 0, endpoint));
    board->usb_line = FrameLine();
    host.write(1, {0});
    ASSERT_NE(board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr) << endpoint;
  }
}

TEST_F(F405Usb, TheHostMayMoveBetweenUsbAndUart) {
  ASSERT_TRUE(board->host.enumerate());
  for (int i = 0; i < 3; ++i) {
    ASSERT_NE(board->ask_uart(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr);
    EXPECT_EQ(board->ask_usb(message_of(SYNC_STATUS_REQUEST), SYNC_STATUS),
              nullptr);  // the host is at the other end
    board->uart_line.messages.clear();
    ASSERT_NE(board->ask_usb(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO), nullptr);
    EXPECT_EQ(board->ask_uart(message_of(SYNC_STATUS_REQUEST), SYNC_STATUS), nullptr);
  }
}

TEST_F(F405Usb, WithoutACrystalOnlyTheUartAnswers) {
  F405Board plain(built_firmware(), false);
  plain.chip.run(0.3);  // it waits for the crystal
  const auto* hello = plain.ask_uart(message_of(SYNC_HELLO_REQUEST), SYNC_HELLO);
  ASSERT_NE(hello, nullptr);
  EXPECT_FALSE(plain.usb.attached());
  EXPECT_EQ(plain.chip.misuses, std::vector<std::string>{});
}

}  // namespace
}  // namespace lightwell::test
