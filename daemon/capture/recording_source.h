// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "daemon/capture/capture_source.h"
#include "lighting/calibration.h"
#include "lighting/result.h"

namespace lightwell {

// A take played as a camera. A thread of its own decodes ahead into the pool.
//
// speed 0: lossless. Every frame in order, as fast as frames are taken, with all its values as recorded: two
// runs give
//   the same lights bit for bit.
// speed > 0: paced by the recorded capture times over speed; of the frames that are due the freshest wins.
// The times
//   are moved to now, as if the camera saw the frame now (distances between them divided by speed, exposure
//   to reception as recorded); sequence, exposure, gain and temperature are as recorded.
// loop: after the last frame the first follows at the take's rate, with sequence and times counting on.
// state: streaming from the first frame, `ended` when the last has been taken. Damaged frames are counted as
// incomplete
//   and left out; describe() says so.
// Options honoured: speed, loop, buffers.
// bad_input: as RecordingReader::open; usage: speed or buffers out of range.
Result<std::unique_ptr<CaptureSource>> make_recording_source(const std::string& file,
                                                             const CaptureOptions& options);

// The calibration that is attached to a take; nullopt where none is. bad_input: as RecordingReader::open, or
// a malformed calibration.
Result<std::optional<Calibration>> recording_calibration(const std::filesystem::path& file);

}  // namespace lightwell
