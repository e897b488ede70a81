// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/cbor_shape.h"

#include <optional>
#include <vector>

namespace lightwell {
namespace {

enum Major : unsigned { kBytes = 2, kText = 3, kArray = 4, kMap = 5, kTag = 6, kSimple = 7 };

struct Head {
  unsigned major = 0;
  bool indefinite = false;  // of major type 7: the break
  std::uint64_t argument = 0;
};

// An item whose parts are not all read.
struct Open {
  unsigned major;
  bool indefinite;
  std::uint64_t left;   // parts, where their number is given
  bool between = true;  // the parts so far are whole pairs
};

class Walk {
 public:
  Walk(std::span<const std::uint8_t> rest, std::size_t most_depth) : rest_(rest), most_depth_(most_depth) {}

  bool well_formed() {
    do {
      const auto head = read_head();
      if (!head || !enter(*head)) return false;
    } while (!open_.empty());
    return rest_.empty();
  }

 private:
  // Absent: truncated, or no head.
  std::optional<Head> read_head() {
    if (rest_.empty()) return std::nullopt;
    Head head;
    head.major = rest_[0] >> 5;
    const unsigned info = rest_[0] & 31u;
    rest_ = rest_.subspan(1);
    head.argument = info;
    if (info < 24) return head;
    if (info == 31) {
      head.indefinite = true;
      const bool may = (head.major >= kBytes && head.major <= kMap) || head.major == kSimple;
      return may ? std::optional(head) : std::nullopt;
    }
    const std::size_t size = std::size_t{1} << (info - 24);
    if (info > 27 || rest_.size() < size) return std::nullopt;
    head.argument = 0;
    for (const std::uint8_t byte : rest_.first(size)) head.argument = head.argument << 8 | byte;
    rest_ = rest_.subspan(size);
    // What one byte holds is said by the head.
    if (head.major == kSimple && size == 1 && head.argument < 32) return std::nullopt;
    return head;
  }

  bool enter(const Head& head) {
    if (head.major == kSimple && head.indefinite) return leave();
    // Chunks are strings of the same kind whose length is given (3.2.3).
    if (!open_.empty() && is_string(open_.back().major) &&
        (head.major != open_.back().major || head.indefinite))
      return false;
    const bool has_parts =
        head.indefinite || head.major == kArray || head.major == kMap || head.major == kTag;
    if (has_parts) return open(head);
    if (is_string(head.major)) {
      if (head.argument > rest_.size()) return false;
      rest_ = rest_.subspan(static_cast<std::size_t>(head.argument));
    }
    end_item();
    return true;
  }

  bool open(const Head& head) {
    if (open_.size() >= most_depth_) return false;
    // Every part takes a byte at least.
    if (!head.indefinite && head.major != kTag && head.argument > rest_.size()) return false;
    const std::uint64_t parts = head.major == kTag   ? 1
                                : head.major == kMap ? 2 * head.argument
                                                     : head.argument;
    if (!head.indefinite && parts == 0)
      end_item();
    else
      open_.push_back({head.major, head.indefinite, parts});
    return true;
  }

  // At a break.
  bool leave() {
    if (open_.empty() || !open_.back().indefinite) return false;
    if (open_.back().major == kMap && !open_.back().between) return false;
    open_.pop_back();
    end_item();
    return true;
  }

  // One part more, and what it makes whole.
  void end_item() {
    while (!open_.empty()) {
      Open& around = open_.back();
      around.between = !around.between;
      if (around.indefinite || --around.left > 0) return;
      open_.pop_back();
    }
  }

  static bool is_string(unsigned major) { return major == kBytes || major == kText; }

  std::span<const std::uint8_t> rest_;
  std::size_t most_depth_;
  std::vector<Open> open_;
};

}  // namespace

bool is_shallow_cbor(std::span<const std::uint8_t> bytes, std::size_t most_depth) {
  return Walk(bytes, most_depth).well_formed();
}

}  // namespace lightwell
