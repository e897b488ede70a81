// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/simulator/truth_file.h"

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

namespace lightwell::simulator {

std::string truth_line(const SentFrame& frame) {
  using json = nlohmann::ordered_json;
  const auto triple = [](const auto& v) { return json::array({v[0], v[1], v[2]}); };
  json line = {{"frame", frame.frame},
               {"frame_id", frame.frame_id},
               {"time_ns", frame.mid_exposure_mono_ns},
               {"exposure_us", frame.exposure_us},
               {"total_illuminance", triple(frame.truth.total_illuminance)},
               {"lights", json::array()}};
  for (const DiscLight& light : frame.truth.lights)
    line["lights"].push_back(
        {{"direction", triple(light.direction)}, {"illuminance", triple(light.illuminance)}});
  if (frame.truth.position_m) line["position_m"] = triple(*frame.truth.position_m);
  return line.dump();
}

Result<TruthFile> TruthFile::create(const std::filesystem::path& file) {
  std::FILE* stream = std::fopen(file.c_str(), "we");
  if (stream == nullptr)
    return Error{ErrorKind::failed, file.string() + ": cannot write: " + std::strerror(errno)};
  return TruthFile(file, stream);
}

Status TruthFile::write(const SentFrame& frame) {
  const std::string line = truth_line(frame) + "\n";
  if (std::fwrite(line.data(), 1, line.size(), stream_.get()) == line.size() &&
      std::fflush(stream_.get()) == 0)
    return {};
  return Error{ErrorKind::failed, file_.string() + ": cannot write: " + std::strerror(errno)};
}

}  // namespace lightwell::simulator
