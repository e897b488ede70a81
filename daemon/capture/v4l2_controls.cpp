// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The controls of a V4L2Device: Documentation/userspace-api/media/v4l/extended-controls.rst.
#include <linux/videodev2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstring>
#include <string_view>

#include "daemon/capture/v4l2_device.h"

namespace lightwell {
namespace {

// V4L2_CID_HDR_SENSOR_MODE of Linux 6.3, newer than Debian 12's headers.
constexpr std::uint32_t kHdrSensorMode = V4L2_CID_CAMERA_CLASS_BASE + 36;

// As v4l2-ctl spells names: letters and digits in lower case, one underscore for whatever lies between.
std::string spelled(const char* name, std::size_t size) {
  std::string out;
  bool gap = false;
  for (std::size_t i = 0; i < size && name[i] != '\0'; ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    if (std::isalnum(c) == 0) {
      gap = !out.empty();
      continue;
    }
    if (gap) out += '_';
    gap = false;
    out += static_cast<char>(std::tolower(c));
  }
  return out;
}

V4l2Control::Kind kind_of(std::uint32_t type) {
  using Kind = V4l2Control::Kind;
  switch (type) {
    case V4L2_CTRL_TYPE_INTEGER:
    case V4L2_CTRL_TYPE_INTEGER64:
    case V4L2_CTRL_TYPE_BITMASK:
    case V4L2_CTRL_TYPE_U8:
    case V4L2_CTRL_TYPE_U16:
    case V4L2_CTRL_TYPE_U32:
      return Kind::integer;
    case V4L2_CTRL_TYPE_BOOLEAN:
      return Kind::boolean;
    case V4L2_CTRL_TYPE_MENU:
      return Kind::menu;
    case V4L2_CTRL_TYPE_INTEGER_MENU:
      return Kind::integer_menu;
    case V4L2_CTRL_TYPE_BUTTON:
      return Kind::button;
    default:
      return Kind::other;
  }
}

V4l2Control control_of(const v4l2_query_ext_ctrl& q) {
  V4l2Control c;
  c.id = q.id;
  // Arrays and compound values are listed, not set.
  c.kind = (q.flags & V4L2_CTRL_FLAG_HAS_PAYLOAD) != 0 ? V4l2Control::Kind::other : kind_of(q.type);
  c.name = spelled(q.name, sizeof q.name);
  c.minimum = q.minimum;
  c.maximum = q.maximum;
  c.step = q.step > 0 ? static_cast<std::int64_t>(q.step) : 1;
  c.standard = q.default_value;
  c.read_only = (q.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0;
  c.inactive = (q.flags & V4L2_CTRL_FLAG_INACTIVE) != 0;
  c.changes_by_itself = (q.flags & V4L2_CTRL_FLAG_VOLATILE) != 0;
  return c;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<std::int64_t> number(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string range(const V4l2Control& c) {
  std::string out;
  if (c.choices.empty()) {
    out = std::to_string(c.minimum) + "…" + std::to_string(c.maximum);
    return c.step > 1 ? out + " in steps of " + std::to_string(c.step) : out;
  }
  for (const auto& [index, words] : c.choices) {
    if (!out.empty()) out += ", ";
    out += std::to_string(index) + " (" + words + ")";
  }
  return out;
}

Error refused(const V4l2Control& c, std::string_view value, const std::string& why) {
  return {ErrorKind::failed, "control " + c.name + " = " + std::string(value) + ": " + why};
}

}  // namespace

bool V4l2Control::is_hdr() const {
  if (id == kHdrSensorMode || id == V4L2_CID_WIDE_DYNAMIC_RANGE) return true;
  // There is no standard control for companding: drivers name their own.
  constexpr std::array kWords = {"hdr", "high_dynamic", "wide_dynamic", "compand", "knee", "pwl"};
  return std::any_of(kWords.begin(), kWords.end(),
                     [&](const char* word) { return name.find(word) != std::string::npos; });
}

bool V4l2Control::is_gain() const {
  return id == V4L2_CID_GAIN || id == V4L2_CID_ANALOGUE_GAIN || id == V4L2_CID_DIGITAL_GAIN;
}

void V4l2Device::read_choices(V4l2Control& c) const {
  const bool numbers = c.kind == V4l2Control::Kind::integer_menu;
  if (!numbers && c.kind != V4l2Control::Kind::menu) return;
  for (std::int64_t i = c.minimum; i <= std::min<std::int64_t>(c.maximum, 255); ++i) {
    v4l2_querymenu m{};
    m.id = c.id;
    m.index = static_cast<__u32>(i);
    if (ioctl(VIDIOC_QUERYMENU, &m) != 0) continue;  // a choice the driver leaves out
    const auto* words = reinterpret_cast<const char*>(m.name);
    c.choices.emplace_back(
        i, numbers ? std::to_string(m.value) : std::string(words, ::strnlen(words, sizeof m.name)));
  }
}

std::optional<V4l2Control> V4l2Device::control(std::uint32_t id) const {
  v4l2_query_ext_ctrl q{};
  q.id = id;
  if (ioctl(VIDIOC_QUERY_EXT_CTRL, &q) != 0 || (q.flags & V4L2_CTRL_FLAG_DISABLED) != 0) return std::nullopt;
  V4l2Control c = control_of(q);
  read_choices(c);
  c.value = value(id).value_or(c.standard);
  return c;
}

std::vector<V4l2Control> V4l2Device::controls() const {
  std::vector<V4l2Control> list;
  v4l2_query_ext_ctrl q{};
  const auto next = [&] {
    q.id |= V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND;
    return ioctl(VIDIOC_QUERY_EXT_CTRL, &q) == 0;
  };
  while (next()) {
    if (q.type == V4L2_CTRL_TYPE_CTRL_CLASS || (q.flags & V4L2_CTRL_FLAG_DISABLED) != 0) continue;
    V4l2Control c = control_of(q);
    read_choices(c);
    c.value = value(c.id).value_or(c.standard);
    list.push_back(std::move(c));
  }
  return list;
}

std::optional<std::int64_t> V4l2Device::value(std::uint32_t id) const {
  v4l2_query_ext_ctrl q{};
  q.id = id;
  if (ioctl(VIDIOC_QUERY_EXT_CTRL, &q) != 0 ||
      (q.flags & (V4L2_CTRL_FLAG_HAS_PAYLOAD | V4L2_CTRL_FLAG_WRITE_ONLY)) != 0)
    return std::nullopt;
  v4l2_ext_control c{};
  c.id = id;
  v4l2_ext_controls list{};
  list.which = V4L2_CTRL_WHICH_CUR_VAL;
  list.count = 1;
  list.controls = &c;
  if (ioctl(VIDIOC_G_EXT_CTRLS, &list) != 0) return std::nullopt;
  return q.type == V4L2_CTRL_TYPE_INTEGER64 ? c.value64 : c.value;
}

Status V4l2Device::set(const V4l2Control& control, std::int64_t value) const {
  using Kind = V4l2Control::Kind;
  const std::string text = std::to_string(value);
  if (control.kind == Kind::other) return refused(control, text, "has a kind that cannot be set here");
  if (control.read_only) return refused(control, text, "can only be read");
  const bool is_choice = std::any_of(control.choices.begin(), control.choices.end(),
                                     [&](const auto& choice) { return choice.first == value; });
  const bool is_menu = control.kind == Kind::menu || control.kind == Kind::integer_menu;
  const bool allowed = is_menu ? is_choice
                       : control.kind == Kind::button
                           ? true
                           : value >= control.minimum && value <= control.maximum &&
                                 (value - control.minimum) % control.step == 0;
  if (!allowed) return refused(control, text, "the device allows " + range(control));
  v4l2_ext_control c{};
  c.id = control.id;
  v4l2_query_ext_ctrl q{};
  q.id = control.id;
  if (ioctl(VIDIOC_QUERY_EXT_CTRL, &q) == 0 && q.type == V4L2_CTRL_TYPE_INTEGER64)
    c.value64 = value;
  else
    c.value = static_cast<__s32>(value);
  v4l2_ext_controls list{};
  list.which = V4L2_CTRL_WHICH_CUR_VAL;
  list.count = 1;
  list.controls = &c;
  if (const int error = ioctl(VIDIOC_S_EXT_CTRLS, &list); error != 0)
    return refused(control, text, errno_text(error));
  return {};
}

Status V4l2Device::set(const std::string& assignments) const {
  const std::vector<V4l2Control> known = assignments.empty() ? std::vector<V4l2Control>() : controls();
  std::string_view rest = assignments;
  while (!trimmed(rest).empty()) {
    const std::size_t comma = rest.find(',');
    const std::string_view one = trimmed(rest.substr(0, comma));
    rest = comma == std::string_view::npos ? std::string_view() : rest.substr(comma + 1);
    const std::size_t equals = one.find('=');
    const std::string_view name = trimmed(one.substr(0, equals));
    const std::string_view value =
        equals == std::string_view::npos ? std::string_view() : trimmed(one.substr(equals + 1));
    const auto at = std::find_if(known.begin(), known.end(), [&](const auto& c) { return c.name == name; });
    if (at == known.end() || value.empty()) {
      std::string names;
      for (const V4l2Control& c : known) names += (names.empty() ? "" : ", ") + c.name;
      return Error{ErrorKind::failed,
                   "control \"" + std::string(one) + "\": name=value is expected, with one of " + names};
    }
    std::optional<std::int64_t> chosen = number(value);
    for (const auto& [index, words] : at->choices)
      if (words == value && at->kind == V4l2Control::Kind::menu) chosen = index;
    if (!chosen) return refused(*at, value, "the device allows " + range(*at));
    if (Status status = set(*at, *chosen); !status) return status;
  }
  return {};
}

}  // namespace lightwell
