// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Lines by libgpiod 2.
#include <gpiod.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <utility>

#include "daemon/sync/gpio_line.h"

namespace lightwell {
namespace {

template <auto release>
struct End {
  template <class T>
  void operator()(T* object) const {
    release(object);
  }
};
template <class T, auto release>
using Owned = std::unique_ptr<T, End<release>>;
using Chip = Owned<gpiod_chip, gpiod_chip_close>;
using Request = Owned<gpiod_line_request, gpiod_line_request_release>;

constexpr std::size_t kEvents = 16;

std::size_t lines_of(gpiod_chip* chip) {
  const Owned<gpiod_chip_info, gpiod_chip_info_free> info(gpiod_chip_get_info(chip));
  return info ? gpiod_chip_info_get_num_lines(info.get()) : 0;
}

struct Line {
  Request request;
  unsigned offset = 0;
};

Result<Line> request(const GpioPlace& place, gpiod_line_direction direction) {
  const Chip chip(gpiod_chip_open(place.chip.c_str()));
  if (!chip) return no_gpio_chip(place, errno);
  const auto number = gpio_number(place.line);
  const int found = number ? static_cast<int>(*number)
                           : gpiod_chip_get_line_offset_from_name(chip.get(), place.line.c_str());
  if (found < 0 || static_cast<std::size_t>(found) >= lines_of(chip.get()))
    return no_gpio_line(place, lines_of(chip.get()));
  const auto offset = static_cast<unsigned>(found);

  const Owned<gpiod_line_settings, gpiod_line_settings_free> settings(gpiod_line_settings_new());
  const Owned<gpiod_line_config, gpiod_line_config_free> lines(gpiod_line_config_new());
  const Owned<gpiod_request_config, gpiod_request_config_free> how(gpiod_request_config_new());
  if (!settings || !lines || !how) throw std::bad_alloc();
  gpiod_line_settings_set_direction(settings.get(), direction);
  if (direction == GPIOD_LINE_DIRECTION_INPUT)  // stamped by CLOCK_MONOTONIC where nothing else is asked for
    gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  else
    gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE);
  gpiod_line_config_add_line_settings(lines.get(), &offset, 1, settings.get());
  gpiod_request_config_set_consumer(how.get(), "lightwell");
  Request held(gpiod_chip_request_lines(chip.get(), how.get(), lines.get()));
  if (held) return Line{std::move(held), offset};
  const int why = errno;
  const Owned<gpiod_line_info, gpiod_line_info_free> info(gpiod_chip_get_line_info(chip.get(), offset));
  return refused_gpio_line(place, why, info ? gpiod_line_info_get_consumer(info.get()) : nullptr);
}

class Output final : public GpioOutput {
 public:
  explicit Output(Line line) : line_(std::move(line)) {}
  bool set(bool high) noexcept override {
    return gpiod_line_request_set_value(line_.request.get(), line_.offset,
                                        high ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE) == 0;
  }

 private:
  Line line_;
};

class Input final : public GpioInput {
 public:
  Input(Line line, GpioPlace place)
      : line_(std::move(line)), place_(std::move(place)), events_(gpiod_edge_event_buffer_new(kEvents)) {
    if (!events_) throw std::bad_alloc();
  }

  Result<std::size_t> read(std::span<GpioEdge> edges, std::chrono::milliseconds timeout) override {
    const int ready =
        gpiod_line_request_wait_edge_events(line_.request.get(), std::chrono::nanoseconds(timeout).count());
    if (ready == 0 || (ready < 0 && errno == EINTR)) return std::size_t{0};
    const int count = ready < 0 ? -1
                                : gpiod_line_request_read_edge_events(line_.request.get(), events_.get(),
                                                                      std::min(edges.size(), kEvents));
    if (count < 0) return lost_gpio_line(place_, errno);
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      gpiod_edge_event* event = gpiod_edge_event_buffer_get_event(events_.get(), i);
      edges[i] = {static_cast<std::int64_t>(gpiod_edge_event_get_timestamp_ns(event)),
                  gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE};
    }
    return static_cast<std::size_t>(count);
  }

 private:
  Line line_;
  GpioPlace place_;
  Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free> events_;
};

}  // namespace

Result<std::unique_ptr<GpioOutput>> open_gpio_output(const GpioPlace& place) {
  auto line = request(place, GPIOD_LINE_DIRECTION_OUTPUT);
  if (!line) return line.error();
  return std::unique_ptr<GpioOutput>(std::make_unique<Output>(std::move(*line)));
}

Result<std::unique_ptr<GpioInput>> open_gpio_input(const GpioPlace& place) {
  auto line = request(place, GPIOD_LINE_DIRECTION_INPUT);
  if (!line) return line.error();
  return std::unique_ptr<GpioInput>(std::make_unique<Input>(std::move(*line), place));
}

}  // namespace lightwell
