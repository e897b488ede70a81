// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "daemon/capture/v4l2_calls.h"
#include "lighting/result.h"

namespace lightwell {

// A control as the driver describes it (VIDIOC_QUERY_EXT_CTRL). Numbers are in the driver's units.
struct V4l2Control {
  enum class Kind { integer, boolean, menu, integer_menu, button, other };
  std::uint32_t id = 0;
  Kind kind = Kind::other;
  std::string name;  // lower case with underscores, as v4l2-ctl spells it: "exposure_time_absolute"
  std::int64_t minimum = 0, maximum = 0, step = 1, standard = 0;
  std::int64_t value = 0;
  bool read_only = false, inactive = false, changes_by_itself = false;
  std::vector<std::pair<std::int64_t, std::string>> choices;  // of a menu: index and what it stands for
  // Has to do with high dynamic range on the sensor: its mode, companding, knee points.
  [[nodiscard]] bool is_hdr() const;
  // Amplifies before or after conversion: codes for the same light depend on it.
  [[nodiscard]] bool is_gain() const;
};

// Pixel formats, sizes and rates as the driver lists them; a range has step > 0.
struct V4l2Size {
  int width = 0, height = 0;
  int largest_width = 0, largest_height = 0;  // of a range; otherwise the same
  double rate_min_hz = 0, rate_max_hz = 0;    // 0 where the driver does not say
};
struct V4l2FormatDescription {
  std::uint32_t fourcc = 0;
  std::string description;
  std::vector<V4l2Size> sizes;
};

// The format in force.
struct V4l2FrameLayout {
  int width = 0, height = 0;
  std::uint32_t fourcc = 0;
  std::uint32_t field = 0;     // V4L2_FIELD_…
  std::size_t stride = 0;      // bytes from line to line
  std::size_t size_image = 0;  // bytes of a buffer
};

// An open video capture device, spoken to in types instead of ioctls: single-planar and multi-planar API alike.
// Every call ends as the driver ends it; those that wait for frames are V4l2Session's.
class V4l2Device {
 public:
  explicit V4l2Device(V4l2Calls& calls) : calls_(calls) {}
  ~V4l2Device() { close(); }
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  // 0 or −errno; −EINVAL, and refusal() says why, where it is no camera for us.
  int open(const std::string& path);
  void close() noexcept;
  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  [[nodiscard]] int fd() const noexcept { return fd_; }
  [[nodiscard]] std::uint32_t buffer_type() const noexcept { return type_; }
  [[nodiscard]] bool is_multi_planar() const noexcept;
  [[nodiscard]] const std::string& card() const { return card_; }
  [[nodiscard]] const std::string& driver() const { return driver_; }
  [[nodiscard]] const std::string& bus() const { return bus_; }
  int ioctl(unsigned long request, void* argument) const noexcept {
    return calls_.ioctl(fd_, request, argument);
  }

  // In words; empty: there is a signal, or the device cannot tell.
  [[nodiscard]] std::string missing_signal() const;
  // Of a digital video input (HDMI, SDI): has the device take the size and rate that the signal has, which its format then
  // has too; nothing on other inputs. false: the device is streaming for somebody. The second asks whether it has them.
  [[nodiscard]] bool follow_signal() const;
  [[nodiscard]] bool is_following_signal() const;
  [[nodiscard]] std::vector<std::uint32_t> formats() const;
  [[nodiscard]] std::vector<V4l2FormatDescription> describe_formats() const;
  // 0 or −errno. set takes width, height and fourcc and leaves what the driver made of them.
  int layout(V4l2FrameLayout& out) const;
  int set_layout(V4l2FrameLayout& wanted) const;
  // 0 where the driver has no frame rate.
  [[nodiscard]] double rate_hz() const;
  // false: it cannot be set. The driver may choose another rate: ask again.
  bool set_rate(double rate_hz) const;

  [[nodiscard]] std::vector<V4l2Control> controls() const;
  [[nodiscard]] std::optional<V4l2Control> control(std::uint32_t id) const;
  [[nodiscard]] std::optional<std::int64_t> value(std::uint32_t id) const;
  // Checked against what the driver allows first; failed: one line that names control, value and range.
  [[nodiscard]] Status set(const V4l2Control& control, std::int64_t value) const;
  // "name=value, name=value": names and values as v4l2-ctl takes them, menus also by the words of a choice.
  [[nodiscard]] Status set(const std::string& assignments) const;
  // Events of this kind will come (V4L2_EVENT_…, and of which control).
  bool subscribe(std::uint32_t event, std::uint32_t id) const noexcept;

 private:
  [[nodiscard]] std::vector<V4l2Size> sizes(std::uint32_t fourcc) const;
  void read_choices(V4l2Control& control) const;

  V4l2Calls& calls_;
  int fd_ = -1;
  std::uint32_t type_ = 0;
  std::string card_, driver_, bus_, refusal_;
};

// "No such device (ENODEV)" and its like.
std::string errno_text(int error);

}  // namespace lightwell
