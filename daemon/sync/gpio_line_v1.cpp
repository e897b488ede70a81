// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Lines by libgpiod 1.6, as in Debian 12.
#include <gpiod.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

#include "daemon/sync/gpio_line.h"

namespace lightwell {
namespace {

constexpr const char* kConsumer = "lightwell";

struct ChipEnd {
  void operator()(gpiod_chip* chip) const { gpiod_chip_close(chip); }  // and gives its lines up
};
struct Line {
  std::unique_ptr<gpiod_chip, ChipEnd> chip;
  gpiod_line* line = nullptr;
};

Result<Line> find(const GpioPlace& place) {
  Line found;
  // This version takes no symbolic link, which is what udev's lasting names are.
  std::error_code ignored;
  const std::string path = std::filesystem::weakly_canonical(place.chip, ignored).string();
  found.chip.reset(gpiod_chip_open(path.empty() ? place.chip.c_str() : path.c_str()));
  if (!found.chip) return no_gpio_chip(place, errno);
  const auto number = gpio_number(place.line);
  found.line = number ? gpiod_chip_get_line(found.chip.get(), *number)
                      : gpiod_chip_find_line(found.chip.get(), place.line.c_str());
  if (found.line == nullptr) return no_gpio_line(place, gpiod_chip_num_lines(found.chip.get()));
  return found;
}

class Output final : public GpioOutput {
 public:
  explicit Output(Line line) : line_(std::move(line)) {}
  bool set(bool high) noexcept override { return gpiod_line_set_value(line_.line, high ? 1 : 0) == 0; }

 private:
  Line line_;
};

class Input final : public GpioInput {
 public:
  Input(Line line, GpioPlace place) : line_(std::move(line)), place_(std::move(place)) {}

  Result<std::size_t> read(std::span<GpioEdge> edges, std::chrono::milliseconds timeout) override {
    const timespec time{timeout.count() / 1000, timeout.count() % 1000 * 1'000'000};
    const int ready = gpiod_line_event_wait(line_.line, &time);
    if (ready == 0 || (ready < 0 && errno == EINTR)) return std::size_t{0};
    std::array<gpiod_line_event, 16> events{};  // as many as the kernel keeps
    const auto most = static_cast<unsigned>(std::min(edges.size(), events.size()));
    const int count = ready < 0 ? -1 : gpiod_line_event_read_multiple(line_.line, events.data(), most);
    if (count < 0) return lost_gpio_line(place_, errno);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      edges[i] = {events[i].ts.tv_sec * 1'000'000'000 + events[i].ts.tv_nsec,
                  events[i].event_type == GPIOD_LINE_EVENT_RISING_EDGE};
    return static_cast<std::size_t>(count);
  }

 private:
  Line line_;
  GpioPlace place_;
};

}  // namespace

Result<std::unique_ptr<GpioOutput>> open_gpio_output(const GpioPlace& place) {
  auto line = find(place);
  if (!line) return line.error();
  if (gpiod_line_request_output(line->line, kConsumer, 0) != 0)
    return refused_gpio_line(place, errno, gpiod_line_consumer(line->line));
  return std::unique_ptr<GpioOutput>(std::make_unique<Output>(std::move(*line)));
}

Result<std::unique_ptr<GpioInput>> open_gpio_input(const GpioPlace& place) {
  auto line = find(place);
  if (!line) return line.error();
  if (gpiod_line_request_both_edges_events(line->line, kConsumer) != 0)
    return refused_gpio_line(place, errno, gpiod_line_consumer(line->line));
  return std::unique_ptr<GpioInput>(std::make_unique<Input>(std::move(*line), place));
}

}  // namespace lightwell
