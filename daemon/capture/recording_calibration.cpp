// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/recording_source.h"
#include "interface/calibration_io.h"
#include "interface/recording.h"

namespace lightwell {

Result<std::optional<Calibration>> recording_calibration(const std::filesystem::path& file) {
  const auto reader = RecordingReader::open(file);
  if (!reader) return reader.error();
  const std::string& text = (*reader)->header().calibration_json;
  if (text.empty()) return std::optional<Calibration>();
  auto calibration = calibration_from_json(text, file.string() + " (attached calibration.json)");
  if (!calibration) return calibration.error();
  return std::optional<Calibration>(std::move(*calibration));
}

}  // namespace lightwell
