// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "daemon/pipeline/pipeline.h"
#include "interface/recording.h"

namespace lightwell {

// What stands beside a frame's codes in a take.
RecordedFrame recorded_frame(const FrameInfo& info);

// Writes the frames that pass the frame path into takes, on a thread of its own. The frame path only copies
// into frames allocated when the take began; a disk that is too slow loses frames of the take and nothing
// else.
class Recorder final : public FrameSink {
 public:
  // Takes are written into this directory. ring_bytes: memory for frames that wait for the disk; at least
  // four frames.
  explicit Recorder(std::filesystem::path directory, std::size_t ring_bytes = 24u << 20);
  ~Recorder() override;  // closes the take

  // file: a plain name (daemon/record/take_name.h), not there yet; else usage. failed: a take is being
  // written, or as RecordingWriter::create. Frames of another format than the header's end the take. Any
  // thread.
  Status start(const std::string& file, const RecordingHeader& header);
  // The same at a path of the caller's choice, for commands. Any name.
  Status start_at(const std::filesystem::path& path, const RecordingHeader& header);
  // Writes what waits, closes the take; says why where it is not whole, also where it has ended by itself.
  // failed: none was begun. Any thread.
  Status stop();

  // The frame path's thread. Incomplete frames are left out.
  void offer(const FrameInfo& info, std::span<const std::byte> codes) noexcept override;

  struct Stats {
    bool active = false;
    std::string file;           // name of the current or last take
    std::uint64_t frames = 0;   // written
    std::uint64_t dropped = 0;  // frames the disk was too slow for
    std::uint64_t bytes = 0;
    std::string error;  // why the last take ended by itself, else empty
  };
  [[nodiscard]] Stats stats() const;

 private:
  class Session;
  [[nodiscard]] std::shared_ptr<Session> session() const;

  const std::filesystem::path directory_;
  const std::size_t ring_bytes_;
  std::mutex control_;                // start and stop, one at a time
  mutable std::mutex session_mutex_;  // guards the pointer
  std::shared_ptr<Session> session_;  // the current or last take
  std::mutex live_mutex_;             // start holds it to change the pointer; the frame path only tries it
  std::shared_ptr<Session> live_;     // the same, for the frame path
};

}  // namespace lightwell
