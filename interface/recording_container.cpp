// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/recording_container.h"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <bit>

namespace lightwell {
namespace {

constexpr std::uint64_t kEbmlHeader = 0x1a45dfa3;
constexpr std::uint64_t kSegment = 0x18538067;

// EBML (RFC 8794, section 4): the leading zeros of the first byte say how many bytes follow.
struct Number {
  std::uint64_t value = 0;   // without the length marker
  std::uint64_t marked = 0;  // with it, as identifiers are written
  unsigned bytes = 0;
  bool unknown = false;  // all ones: a size that is not known yet
};

std::optional<Number> read_number(int fd, std::uint64_t at) {
  std::array<std::uint8_t, 8> raw{};
  const ssize_t n = ::pread(fd, raw.data(), raw.size(), static_cast<off_t>(at));
  if (n < 1 || raw[0] == 0) return std::nullopt;
  Number number;
  number.bytes = static_cast<unsigned>(std::countl_zero(raw[0])) + 1;
  if (n < static_cast<ssize_t>(number.bytes)) return std::nullopt;
  for (unsigned i = 0; i < number.bytes; ++i) number.marked = number.marked << 8 | raw[i];
  const std::uint64_t mask = (std::uint64_t{1} << (7 * number.bytes)) - 1;
  number.value = number.marked & mask;
  number.unknown = number.value == mask;
  return number;
}

}  // namespace

std::optional<SegmentEnd> find_segment_end(int fd) {
  struct stat info {};
  const auto id = read_number(fd, 0);
  if (!id || id->marked != kEbmlHeader || ::fstat(fd, &info) != 0) return std::nullopt;
  const auto size = read_number(fd, id->bytes);
  if (!size || size->unknown || size->value > 4096)
    return std::nullopt;  // RFC 8794 headers are a few dozen bytes
  const std::uint64_t at = id->bytes + size->bytes + size->value;
  const auto segment = read_number(fd, at);
  if (!segment || segment->marked != kSegment) return std::nullopt;
  const auto length = read_number(fd, at + segment->bytes);
  if (!length) return std::nullopt;
  SegmentEnd end;
  end.has_proper_end = !length->unknown;
  if (!end.has_proper_end) return end;
  const std::uint64_t expected = at + segment->bytes + length->bytes + length->value;
  const auto actual = static_cast<std::uint64_t>(info.st_size);
  end.missing_bytes = expected > actual ? expected - actual : 0;
  return end;
}

}  // namespace lightwell
