// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/firmware_update.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "daemon/sync/sync_conversation.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kErase = 20s;    // of 128 KB sectors, each up to 4 s by the chip's data sheet
constexpr auto kBlock = 500ms;  // a write of 128 bytes takes 2 ms
constexpr auto kVerify = 5s;
constexpr int kTries = 4;
constexpr const char* kBoard = "stm32f405";

sync_message message_of(sync_type type) {
  sync_message message{};
  message.type = static_cast<std::uint8_t>(type);
  return message;
}

Status send_blocks(SyncConversation& board, const std::vector<std::uint8_t>& bytes,
                   const std::function<void(double)>& progress) {
  for (std::size_t offset = 0; offset < bytes.size(); offset += SYNC_UPDATE_BLOCK_BYTES) {
    sync_message block = message_of(SYNC_UPDATE_BLOCK);
    block.update_block.offset = static_cast<std::uint32_t>(offset);
    std::fill_n(block.update_block.bytes, SYNC_UPDATE_BLOCK_BYTES, std::uint8_t{0xff});
    const std::size_t size = std::min<std::size_t>(SYNC_UPDATE_BLOCK_BYTES, bytes.size() - offset);
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(offset), size, block.update_block.bytes);
    // Where an answer was lost, the same block once more is welcome; where it was late, it comes before this block's.
    std::size_t awaited = 0;
    for (int i = 0; i < kTries && awaited != offset + SYNC_UPDATE_BLOCK_BYTES; ++i) {
      const auto state = board.ask(block, SYNC_UPDATE_STATE, kBlock, kTries);
      if (!state) return state.error();
      awaited = state->update_state.next_offset;
    }
    if (awaited != offset + SYNC_UPDATE_BLOCK_BYTES)
      return Error{ErrorKind::failed,
                   fmt::format("the board waits for byte {} after byte {} was sent", awaited, offset)};
    if (progress) progress(static_cast<double>(offset + size) / static_cast<double>(bytes.size()));
  }
  return {};
}

}  // namespace

Result<sync_hello> update_firmware(SyncLink& link, const FirmwareFile& firmware,
                                   const std::function<void(double)>& progress) {
  if (firmware.board != kBoard)
    return Error{ErrorKind::bad_input,
                 fmt::format("board = \"{}\": allowed {}, the one there is", firmware.board, kBoard)};
  SyncConversation board(link);
  const auto hello = board.greet();
  if (!hello) return hello.error();
  if ((hello->capabilities & SYNC_CAN_UPDATE) == 0)
    return Error{ErrorKind::failed, "this board cannot be updated over its link; use its programmer"};
  const auto image = std::find_if(firmware.images.begin(), firmware.images.end(),
                                  [&](const FirmwareImage& i) { return i.slot != hello->slot; });
  if (image == firmware.images.end())
    return Error{
        ErrorKind::bad_input,
        fmt::format("the file has an image for slot {} alone, which is the one that runs", hello->slot)};

  sync_message begin = message_of(SYNC_UPDATE_BEGIN);
  begin.update_begin.size = static_cast<std::uint32_t>(image->bytes.size());
  std::copy(firmware.version.begin(), firmware.version.end(), begin.update_begin.version);
  const auto begun = board.ask(begin, SYNC_UPDATE_STATE, kErase, 1);
  if (!begun) return begun.error();
  if (const Status sent = send_blocks(board, image->bytes, progress); !sent) return sent.error();

  sync_message finish = message_of(SYNC_UPDATE_FINISH);
  std::copy(image->signature.begin(), image->signature.end(), finish.update_finish.signature);
  const auto finished = board.ask(finish, SYNC_UPDATE_STATE, kVerify, 1);
  if (!finished) return finished.error();
  if (finished->update_state.step != SYNC_UPDATE_PENDING)
    return Error{ErrorKind::failed, "the board has taken the image and does not mean to start it"};
  return hello;
}

}  // namespace lightwell
