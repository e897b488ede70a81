// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Takes: Matroska, our tags, the attached calibration, frame records.
#include "interface/recording_reader.h"
#include "tests/fuzz/memory_file.h"

using namespace lightwell;

namespace {

// Damage is told, and what is behind it may still be read; each call gets on by a frame or ends.
void read_some(RecordingReader& reader) {
  constexpr std::size_t kMostBytes = 1 << 20;
  constexpr int kMostFrames = 20;
  if (reader.header().format.bytes() > kMostBytes) return;
  std::vector<std::byte> codes(reader.header().format.bytes());
  for (int i = 0; i < kMostFrames; ++i)
    if (const auto frame = reader.read(codes); frame && !*frame) break;
  (void)reader.frame_count();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file({data, size});
  for (const bool tolerant : {false, true}) {
    MatroskaReader reader(file.path());
    if (const Status opened = reader.begin(tolerant); !opened)
      fuzz::expect_one_line(opened.error(), file.path().string());
    else
      read_some(reader);
  }
  return 0;
}
