// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/aravis_chunks.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/capture/glib_error.h"

namespace lightwell {
namespace {

std::vector<std::string> offered_chunks(ArvCamera* camera) {
  std::vector<std::string> list;
  if (!arv_camera_are_chunks_available(camera, nullptr)) return list;
  guint count = 0;
  const char** names =
      arv_camera_dup_available_enumerations_as_strings(camera, "ChunkSelector", &count, nullptr);
  for (guint i = 0; names != nullptr && i < count; ++i) list.emplace_back(names[i]);
  g_free(names);
  return list;
}

// nullopt: not in this frame, or nothing that it could be.
std::optional<double> number(ArvChunkParser* parser, ArvBuffer* buffer, const char* chunk, double least) {
  GlibError error;
  const double value = arv_chunk_parser_get_float_value(parser, buffer, chunk, error.out());
  return !error && value >= least && value <= 1e9 ? std::optional(value) : std::nullopt;
}

}  // namespace

void AravisChunks::enable(ArvCamera* camera, SessionSettings& settings) {
  const auto offered = offered_chunks(camera);
  const auto has = [&](std::string_view chunk) {
    return std::find(offered.begin(), offered.end(), chunk) != offered.end();
  };
  exposure_ = has("ExposureTime");
  gain_ = has("Gain");
  timestamp_ = has("Timestamp");
  if (!exposure_ && !gain_ && !timestamp_) return;
  GlibError error;
  arv_camera_set_chunk_mode(camera, TRUE, error.out());
  for (const auto& [chunk, wanted] :
       {std::pair("ExposureTime", exposure_), std::pair("Gain", gain_), std::pair("Timestamp", timestamp_)})
    if (wanted && !error) arv_camera_set_chunk_state(camera, chunk, TRUE, error.out());
  if (error) {
    settings.remark +=
        (settings.remark.empty() ? "" : "; ") + std::string("gives no chunk data: ") + error.text();
    arv_camera_set_chunk_mode(camera, FALSE, nullptr);
    return;
  }
  parser_.reset(arv_camera_create_chunk_parser(camera));
}

AravisChunks::Values AravisChunks::read(ArvBuffer* buffer) const {
  Values values;
  if (parser_ == nullptr || !arv_buffer_has_chunks(buffer)) return values;
  if (exposure_) values.exposure_us = number(parser_.get(), buffer, "ChunkExposureTime", 0);
  if (gain_) values.gain_db = number(parser_.get(), buffer, "ChunkGain", -1000);
  if (timestamp_) {
    GlibError error;
    const gint64 t = arv_chunk_parser_get_integer_value(parser_.get(), buffer, "ChunkTimestamp", error.out());
    if (!error && t > 0) values.t_device_ns = static_cast<std::uint64_t>(t);
  }
  return values;
}

}  // namespace lightwell
