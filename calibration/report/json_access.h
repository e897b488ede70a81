// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

// What calibrate wrote, and somebody may have damaged since: everything that is not as it should be throws
// nlohmann::json::exception. Elements of lists are read by at(): [] of a constant value has no checks.
namespace lightwell::calibration {

inline bool has_number(const nlohmann::json& object, const char* key) {
  return object.contains(key) && object.at(key).is_number();
}

// An array.
inline const nlohmann::json& list(const nlohmann::json& value) {
  (void)value.get_ref<const nlohmann::json::array_t&>();
  return value;
}
inline const nlohmann::json& list_at(const nlohmann::json& object, const char* key) {
  return list(object.at(key));
}
// The array under the key, empty where it is missing.
inline nlohmann::json list_or_none(const nlohmann::json& object, const char* key) {
  return object.contains(key) ? list_at(object, key) : nlohmann::json::array();
}

}  // namespace lightwell::calibration
