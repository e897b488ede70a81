// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arv.h>

#include <memory>
#include <optional>

#include "daemon/capture/aravis_camera.h"
#include "daemon/capture/capture_session.h"

namespace lightwell {

// Chunk data (GenICam SFNC, chapter 16): what the camera appends to each frame about that frame. Frame numbers are not
// taken from it: those of the transport also name the frames that did not come whole.
class AravisChunks {
 public:
  // Turns on the chunks that are read here, those the camera has; a camera that has none, or refuses, says so in the
  // settings and everything below is empty. Before PayloadSize is asked for.
  void enable(ArvCamera* camera, SessionSettings& settings);

  struct Values {
    std::optional<double> exposure_us, gain_db;
    std::optional<std::uint64_t> t_device_ns;
  };
  // Of a buffer that was filled with success.
  [[nodiscard]] Values read(ArvBuffer* buffer) const;

 private:
  std::unique_ptr<ArvChunkParser, GObjectUnref> parser_;  // nullptr: no chunks
  bool exposure_ = false, gain_ = false, timestamp_ = false;
};

}  // namespace lightwell
