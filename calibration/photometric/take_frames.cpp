// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/photometric/take_frames.h"

#include <utility>
#include <vector>

#include "lighting/radiometer/row_decoder.h"

namespace lightwell::calibration {
namespace {

radiometer::Storage storage_of(PixelFormat format) {
  const int bits = storage_bits(format);
  return bits == 8    ? radiometer::Storage::u8
         : bits == 12 ? radiometer::Storage::p12
                      : radiometer::Storage::u16;
}

}  // namespace

TakeFrames::TakeFrames(std::filesystem::path file, std::unique_ptr<RecordingReader> reader)
    : file_(std::move(file)), reader_(std::move(reader)) {}

Result<TakeFrames> TakeFrames::open(const std::filesystem::path& file) {
  auto reader = RecordingReader::open(file);
  if (!reader) return reader.error();
  return TakeFrames(file, *std::move(reader));
}

std::size_t TakeFrames::pixels() const {
  return static_cast<std::size_t>(format().width) * static_cast<std::size_t>(format().height);
}

Status TakeFrames::for_each(const Visit& visit) {
  if (!std::exchange(at_start_, false))
    if (const Status status = reader_->rewind(); !status) return status;
  std::vector<std::byte> codes(format().bytes());
  for (bool any = false;; any = true) {
    const auto frame = reader_->read(codes);
    if (!frame) return frame.error();
    if (!*frame) {
      if (any) return {};
      return Error{ErrorKind::bad_input, file_.string() + ": holds no whole frame"};
    }
    if (const Status status = visit(**frame, codes); !status)
      return Error{status.error().kind, file_.string() + ": " + status.error().message};
  }
}

std::uint32_t TakeFrames::code(std::span<const std::byte> codes, std::size_t pixel) const {
  return radiometer::code_at(codes.data(), storage_of(format().pixel_format), pixel);
}

}  // namespace lightwell::calibration
