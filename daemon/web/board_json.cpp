// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/web/board_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace lightwell {
namespace {

using Json = nlohmann::ordered_json;

const char* lock_name(std::uint8_t lock) {
  switch (lock) {
    case SYNC_LOCK_FREE:
      return "free";
    case SYNC_LOCK_ACQUIRING:
      return "acquiring";
    case SYNC_LOCK_LOCKED:
      return "locked";
    case SYNC_LOCK_HOLDOVER:
      return "holdover";
    default:
      return "unknown";
  }
}

// Null where nothing is triggered, or how often has not been said.
Json rate_of(const std::optional<sync_configuration>& c) {
  if (!c || c->trigger_on == 0 || c->rate_denominator == 0) return nullptr;
  return static_cast<double>(c->rate_numerator) / c->rate_denominator;
}

Json trigger_of(const sync_status& s, const std::optional<sync_configuration>& configuration) {
  return {{"rate_hz", rate_of(configuration)},
          {"lock", lock_name(s.lock)},
          {"phase_error_ns", s.phase_error_ns},
          {"phase_rms_ns", s.phase_rms_ns},
          {"frequency_ppb", s.frequency_ppb},
          {"holdover_s", s.holdover_s},
          {"triggers", s.triggers},
          {"late_triggers", s.late_triggers},
          {"strobes", s.strobes},
          {"unanswered_triggers", s.unanswered_triggers},
          {"stray_strobes", s.stray_strobes},
          {"overruns", s.overruns},
          {"damaged_frames", s.link_damaged},
          {"camera_power_cycles", s.power_cycles},
          {"camera_on", s.camera_on != 0},
          {"safe_defaults", s.safe != 0}};
}

Json flicker_of(const sync_photodiode& p) {
  Json lamps = Json::array();
  for (std::size_t i = 0; i < std::min<std::size_t>(p.frequencies, SYNC_MAX_FREQUENCIES); ++i)
    lamps.push_back({{"frequency_hz", p.frequency_mhz[i] * 1e-3}, {"depth", p.depth_ppm[i] * 1e-6}});
  Json json{{"level_lx", p.level_mlx * 1e-3},
            {"clipped", (p.flags & SYNC_PHOTODIODE_CLIPPED) != 0},
            {"lamps", lamps},
            {"advice", nullptr}};
  if ((p.flags & SYNC_PHOTODIODE_ADVICE) != 0)
    json["advice"] = {
        {"rate_hz", p.rate_mhz * 1e-3}, {"exposure_us", p.exposure_ns * 1e-3}, {"beat", p.beat_ppm * 1e-6}};
  return json;
}

Json up_of(const sync_imu& imu) {
  Json up = Json::array();
  for (const std::int32_t axis : imu.up_um_s2) up.push_back(axis * 1e-6);
  return up;
}

Json temperature_of(const std::optional<sync_temperature>& temperature) {
  return temperature ? Json(temperature->temperature_mc * 1e-3) : Json(nullptr);
}

Json check_of(const std::optional<PhotodiodeCheck::Verdict>& check) {
  if (!check) return nullptr;
  return {{"photodiode_lx", check->photodiode_lx},
          {"camera_lx", check->camera_lx},
          {"ratio", check->ratio},
          {"differs", check->differs}};
}

Json choice_of(const std::optional<TriggerChoice>& choice) {
  if (!choice) return nullptr;
  return {{"rate_hz", choice->rate_hz}, {"exposure_us", choice->exposure_us}};
}

}  // namespace

Json board_json(const BoardView& board) {
  return {{"state", name(board.state)},
          {"description", board.description},
          {"reconnects", board.reconnects},
          {"lost_frames", board.lost_frames},
          {"clock_bound_us", board.clock_bound_us},
          {"drift_ppm", board.drift_ppm},
          {"stamped_frames", board.stamped},
          {"unstamped_frames", board.left},
          {"trigger", board.status ? trigger_of(*board.status, board.configuration) : Json(nullptr)},
          {"flicker", board.photodiode ? flicker_of(*board.photodiode) : Json(nullptr)},
          {"up_m_s2", board.imu ? up_of(*board.imu) : Json(nullptr)},
          {"temperature_c", temperature_of(board.temperature[SYNC_SENSOR_BOARD])},
          {"camera_temperature_c", temperature_of(board.temperature[SYNC_SENSOR_CAMERA])},
          {"photodiode_check", check_of(board.photodiode_check)},
          {"avoiding", choice_of(board.avoiding)},
          {"tilt_deg", board.tilt_deg},
          {"timecode", board.timecode ? Json(timecode_text(timecode_of(*board.timecode))) : Json(nullptr)},
          {"refused", board.refused}};
}

}  // namespace lightwell
