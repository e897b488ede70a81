// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/sample_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "interface/recording_record.h"

namespace lightwell {
namespace {

constexpr std::size_t kMostBytes = std::size_t{32} << 20;    // of a chunk or a bucket in memory
constexpr std::size_t kLeastBytes = std::size_t{128} << 10;  // of a chunk: fewer, larger files
constexpr std::size_t kMostChunkProbes = 256, kChunks = 64;  // enough to share out
constexpr std::size_t kMostDirections = 64;                  // of a bucket

std::size_t chunk_probes_for(std::size_t probes, std::size_t directions) {
  const std::size_t bytes = directions * sizeof(Rgb);
  const std::size_t most = std::clamp<std::size_t>(kMostBytes / bytes, 1, kMostChunkProbes);
  return std::clamp<std::size_t>((probes + kChunks - 1) / kChunks, std::min(most, 1 + kLeastBytes / bytes),
                                 most);
}

// As wide as memory allows, and the parts as even as can be.
std::size_t width_for(std::size_t probes, std::size_t directions) {
  const std::size_t most = std::clamp<std::size_t>(kMostBytes / (probes * sizeof(Rgb)), 1, kMostDirections);
  const std::size_t buckets_a_part = (directions + kFieldParts * most - 1) / (kFieldParts * most);
  const std::size_t buckets = buckets_a_part * kFieldParts;
  return (directions + buckets - 1) / buckets;
}

Error failure(const std::filesystem::path& place, const std::string& what, int error) {
  return {ErrorKind::failed, place.string() + ": " + what + ": " + std::strerror(error)};
}

class File {
 public:
  File(const std::filesystem::path& file, int flags) : fd_(::open(file.c_str(), flags | O_CLOEXEC, 0644)) {}
  ~File() {
    if (fd_ >= 0) ::close(fd_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }
  // Where a network's disk is full, the end may be the first to say so.
  [[nodiscard]] int close() { return ::close(std::exchange(fd_, -1)) == 0 ? 0 : errno; }

  // All of it; 0 or an errno.
  [[nodiscard]] int write(const void* bytes, std::size_t count) const {
    return transfer([&](char* at, std::size_t n, std::size_t) { return ::write(fd_, at, n); },
                    static_cast<char*>(const_cast<void*>(bytes)), count, 0);
  }
  [[nodiscard]] int read(void* bytes, std::size_t count, std::size_t offset) const {
    return transfer([&](char* at, std::size_t n,
                        std::size_t from) { return ::pread(fd_, at, n, static_cast<off_t>(from)); },
                    static_cast<char*>(bytes), count, offset);
  }

 private:
  template <class Call>
  static int transfer(const Call& call, char* bytes, std::size_t count, std::size_t offset) {
    while (count > 0) {
      const ssize_t n = call(bytes, count, offset);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return n < 0 ? errno : EIO;
      bytes += n;
      count -= static_cast<std::size_t>(n);
      offset += static_cast<std::size_t>(n);
    }
    return 0;
  }
  int fd_;
};

}  // namespace

struct SampleStore::Header {
  char name[8] = {'L', 'W', 'F', 'S', 'A', 'M', 'P', '1'};
  std::uint64_t mark = 0, chunk = 0, probes = 0, directions = 0;
  std::uint32_t crc32 = 0, reserved = 0;
  bool operator==(const Header&) const = default;
};

SampleStore::SampleStore(std::filesystem::path folder, std::uint64_t mark, std::size_t probes,
                         std::size_t directions)
    : folder_(std::move(folder)),
      mark_(mark),
      probes_(probes),
      directions_(directions),
      chunk_probes_(chunk_probes_for(probes, directions)),
      width_(width_for(probes, directions)) {}

std::size_t SampleStore::last_probe(std::size_t chunk) const {
  return std::min(probes_, (chunk + 1) * chunk_probes_);
}

std::size_t SampleStore::last(std::size_t bucket) const {
  return std::min(directions_, (bucket + 1) * width_);
}

std::size_t SampleStore::samples(std::size_t chunk) const {
  return (last_probe(chunk) - first_probe(chunk)) * directions_;
}

std::filesystem::path SampleStore::file(std::size_t chunk) const {
  return folder_ / ("samples-" + std::to_string(chunk));
}

SampleStore::Header SampleStore::header(std::size_t chunk) const {
  Header header;
  header.mark = mark_;
  header.chunk = chunk;
  header.probes = probes_;
  header.directions = directions_;
  return header;
}

bool SampleStore::holds(std::size_t chunk) const {
  const File input(file(chunk), O_RDONLY);
  if (!input.is_open()) return false;
  Header found;
  std::vector<Rgb> radiance(samples(chunk));
  if (input.read(&found, sizeof found, 0) != 0 ||
      input.read(radiance.data(), radiance.size() * sizeof(Rgb), sizeof found) != 0)
    return false;
  Header expected = header(chunk);
  expected.crc32 = crc32(std::as_bytes(std::span(radiance)));
  return found == expected;
}

Status SampleStore::check_room(std::size_t chunks) const {
  const std::size_t bytes = std::min(probes_, chunks * chunk_probes_) * directions_ * sizeof(Rgb);
  if (bytes == 0) return {};
  const std::filesystem::path probe = folder_ / "room";
  const int fd = ::open(probe.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0) return failure(folder_, "cannot write", errno);
  ::unlink(probe.c_str());
  const int error = ::fallocate(fd, 0, 0, static_cast<off_t>(bytes)) == 0 ? 0 : errno;
  ::close(fd);
  // A file system that cannot reserve tells when it is full.
  if (error == 0 || error == EOPNOTSUPP || error == ENOSYS) return {};
  char what[100];
  std::snprintf(what, sizeof what, "sorting the probes' light needs %.1f MB here while it runs",
                static_cast<double>(bytes) / 1e6);
  return failure(folder_, what, error);
}

Status SampleStore::write(std::size_t chunk, std::span<const Rgb> radiance) const {
  verify_bug(radiance.size() == samples(chunk), "probes of a chunk");
  std::vector<Rgb> sorted;
  sorted.reserve(radiance.size());
  for (std::size_t b = 0; b < buckets(); ++b)
    for (std::size_t p = 0; p < last_probe(chunk) - first_probe(chunk); ++p) {
      const Rgb* row = radiance.data() + p * directions_;
      sorted.insert(sorted.end(), row + first(b), row + last(b));
    }
  Header head = header(chunk);
  head.crc32 = crc32(std::as_bytes(std::span(sorted)));
  File output(file(chunk), O_WRONLY | O_CREAT | O_TRUNC);
  if (!output.is_open()) return failure(folder_, "cannot write", errno);
  int error = output.write(&head, sizeof head);
  if (error == 0) error = output.write(sorted.data(), sorted.size() * sizeof(Rgb));
  if (error == 0) error = output.close();
  if (error != 0) return failure(folder_, "cannot write", error);
  return {};
}

Status SampleStore::read(std::size_t bucket, std::span<Rgb> radiance) const {
  const std::size_t width = last(bucket) - first(bucket);
  verify_bug(radiance.size() == probes_ * width, "room for a bucket");
  for (std::size_t c = 0; c < chunks(); ++c) {
    const std::size_t count = last_probe(c) - first_probe(c);
    const File input(file(c), O_RDONLY);
    const int error = input.is_open()
                          ? input.read(radiance.data() + first_probe(c) * width, count * width * sizeof(Rgb),
                                       sizeof(Header) + first(bucket) * count * sizeof(Rgb))
                          : errno;
    if (error != 0) return failure(folder_, "cannot read back", error);
  }
  return {};
}

}  // namespace lightwell
