// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/list_v4l2.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <optional>

namespace lightwell {
namespace {

std::vector<std::string> nodes(const std::string& folder) {
  constexpr std::string_view kPrefix = "video";
  std::vector<std::pair<int, std::string>> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string file = entry.path().filename().string();
    int number = 0;
    const char* end = file.data() + file.size();
    if (!file.starts_with(kPrefix)) continue;
    const auto parsed = std::from_chars(file.data() + kPrefix.size(), end, number);
    if (parsed.ec == std::errc() && parsed.ptr == end) found.emplace_back(number, entry.path().string());
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> paths;
  for (auto& [number, path] : found) paths.push_back(std::move(path));
  return paths;
}

std::optional<V4l2Description> describe(const std::string& path, V4l2Calls& calls) {
  V4l2Description d;
  d.path = path;
  V4l2Device device(calls);
  const int error = device.open(path);
  if (error == -EINVAL || error == -ENOENT || error == -ENODEV || error == -ENXIO) return std::nullopt;
  if (error != 0) {
    d.unavailable = error == -EACCES || error == -EPERM ? "may not be opened; add the user to the group video"
                                                        : "cannot be opened: " + errno_text(error);
    return d;
  }
  d.card = device.card();
  d.driver = device.driver();
  d.bus = device.bus();
  d.missing_signal = device.missing_signal();
  if (device.layout(d.layout) != 0) d.layout = {};
  d.rate_hz = device.rate_hz();
  d.formats = device.describe_formats();
  d.controls = device.controls();
  return d;
}

}  // namespace

std::vector<V4l2Description> list_v4l2(const std::string& folder, V4l2Calls& calls) {
  std::vector<V4l2Description> list;
  for (const std::string& path : nodes(folder))
    if (auto found = describe(path, calls)) list.push_back(*std::move(found));
  return list;
}

}  // namespace lightwell
