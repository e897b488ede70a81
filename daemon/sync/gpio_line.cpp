// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/sync/gpio_line.h"

#include <cerrno>
#include <charconv>
#include <cstring>

namespace lightwell {
namespace {

Error failed(const GpioPlace& place, const std::string& what) {
  return {ErrorKind::failed, place.chip + ": " + what};
}

}  // namespace

std::optional<unsigned> gpio_number(const std::string& line) {
  unsigned number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error != std::errc() || end != line.data() + line.size()) return std::nullopt;
  return number;
}

Error no_gpio_chip(const GpioPlace& place, int number) {
  if (number == ENOENT) return failed(place, "there is no such GPIO chip");
  if (number == EACCES) return failed(place, "no right to open it; the user must be in the chip's group");
  if (number == ENOTTY || number == ENODEV) return failed(place, "is no GPIO chip");
  return failed(place, std::strerror(number));
}

Error no_gpio_line(const GpioPlace& place, std::size_t lines) {
  if (gpio_number(place.line))
    return failed(place, "no line " + place.line + "; it has 0 to " + std::to_string(lines - 1));
  return failed(place, "no line is named " + place.line);
}

Error refused_gpio_line(const GpioPlace& place, int number, const char* consumer) {
  const std::string line = "line " + place.line + " ";
  if (number != EBUSY) return failed(place, line + "is not to be had: " + std::strerror(number));
  return failed(place, line + "is in use" + (consumer != nullptr ? std::string(" by ") + consumer : ""));
}

Error lost_gpio_line(const GpioPlace& place, int number) {
  return failed(place, "line " + place.line + " is gone: " + std::strerror(number));
}

}  // namespace lightwell
