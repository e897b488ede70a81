// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "lighting/result.h"

namespace lightwell {

// A line of a GPIO chip: "/dev/gpiochip0", and its number there or the name that the board's maker gave it.
struct GpioPlace {
  std::string chip, line;
};

struct GpioEdge {
  std::int64_t mono_ns = 0;  // the kernel's stamp, taken in the interrupt
  bool rises = false;
};

// Lines are held by this program alone until the object goes. Each is used by one thread.
class GpioOutput {
 public:
  virtual ~GpioOutput() = default;
  // False: the chip is gone. Does not wait, does not allocate.
  virtual bool set(bool high) noexcept = 0;
};
class GpioInput {
 public:
  virtual ~GpioInput() = default;
  // Edges in order, up to the buffer's size, waiting for the first; 0: none within the timeout. failed: the chip is gone.
  virtual Result<std::size_t> read(std::span<GpioEdge> edges, std::chrono::milliseconds timeout) = 0;
};

// failed: no such chip or line, no right to it, or another program holds it; one line that says which.
Result<std::unique_ptr<GpioOutput>> open_gpio_output(const GpioPlace& place);  // low
Result<std::unique_ptr<GpioInput>> open_gpio_input(const GpioPlace& place);

// What those who open lines share. A number in decimal digits; empty: it is a name.
std::optional<unsigned> gpio_number(const std::string& line);
Error no_gpio_chip(const GpioPlace& place, int number);
Error no_gpio_line(const GpioPlace& place, std::size_t lines);
Error refused_gpio_line(const GpioPlace& place, int number, const char* consumer);
Error lost_gpio_line(const GpioPlace& place, int number);

}  // namespace lightwell
