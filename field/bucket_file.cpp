// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/bucket_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace lightwell {
namespace {

// A bucket is held in memory, twice: as it was written, and by direction.
constexpr std::size_t kBucketBytes = std::size_t{32} << 20;
constexpr std::size_t kMostDirections = 64;

Error failure(const std::filesystem::path& folder, const std::string& what, int error) {
  return {ErrorKind::failed, folder.string() + ": " + what + ": " + std::strerror(error)};
}

// pread or pwrite of all of it.
template <class Call, class Bytes>
int transfer(const Call& call, Bytes* bytes, std::size_t count, std::size_t offset) {
  while (count > 0) {
    const ssize_t n = call(bytes, count, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : EIO;
    bytes += n;
    count -= static_cast<std::size_t>(n);
    offset += static_cast<std::size_t>(n);
  }
  return 0;
}

}  // namespace

BucketFile::BucketFile(int fd, std::filesystem::path folder, std::size_t probes, std::size_t directions)
    : fd_(fd),
      folder_(std::move(folder)),
      probes_(probes),
      directions_(directions),
      width_(std::clamp<std::size_t>(kBucketBytes / (probes * sizeof(Rgb)), 1, kMostDirections)) {}

BucketFile::BucketFile(BucketFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)),
      folder_(std::move(other.folder_)),
      probes_(other.probes_),
      directions_(other.directions_),
      width_(other.width_) {}

BucketFile::~BucketFile() {
  if (fd_ >= 0) ::close(fd_);
}

Result<BucketFile> BucketFile::create(const std::filesystem::path& folder, std::size_t probes,
                                      std::size_t directions) {
  const std::filesystem::path place = folder.empty() ? "." : folder;
  std::string name = (place / ".lightwell-field.XXXXXX").string();
  const int fd = ::mkostemp(name.data(), O_CLOEXEC);
  if (fd < 0) return failure(place, "cannot write", errno);
  ::unlink(name.c_str());
  BucketFile file(fd, place, probes, directions);
  const std::size_t bytes = probes * directions * sizeof(Rgb);
  const int error = ::posix_fallocate(fd, 0, static_cast<off_t>(bytes));
  // A file system that cannot reserve tells when it is full.
  if (error != 0 && error != EINVAL && error != EOPNOTSUPP) {
    char what[100];
    std::snprintf(what, sizeof what, "sorting the probes' light needs %.1f MB here while it runs",
                  static_cast<double>(bytes) / 1e6);
    return failure(place, what, error);
  }
  return file;
}

std::size_t BucketFile::last(std::size_t bucket) const {
  return std::min(directions_, (bucket + 1) * width_);
}

std::size_t BucketFile::offset(std::size_t bucket, std::size_t probe) const {
  return (first(bucket) * probes_ + probe * (last(bucket) - first(bucket))) * sizeof(Rgb);
}

Status BucketFile::write(std::size_t first_probe, std::size_t count, std::span<const Rgb> radiance) {
  verify_bug(radiance.size() == count * directions_ && first_probe + count <= probes_, "probes of the file");
  std::vector<Rgb> piece;
  for (std::size_t b = 0; b < buckets(); ++b) {
    const std::size_t begin = first(b), end = last(b);
    piece.clear();
    for (std::size_t p = 0; p < count; ++p)
      piece.insert(piece.end(), radiance.begin() + static_cast<std::ptrdiff_t>(p * directions_ + begin),
                   radiance.begin() + static_cast<std::ptrdiff_t>(p * directions_ + end));
    const auto call = [this](const char* bytes, std::size_t n, off_t at) {
      return ::pwrite(fd_, bytes, n, at);
    };
    if (const int error = transfer(call, reinterpret_cast<const char*>(piece.data()),
                                   piece.size() * sizeof(Rgb), offset(b, first_probe)))
      return failure(folder_, "cannot write", error);
  }
  return {};
}

Status BucketFile::read(std::size_t bucket, std::span<Rgb> radiance) const {
  verify_bug(radiance.size() == probes_ * (last(bucket) - first(bucket)), "room for a bucket");
  const auto call = [this](char* bytes, std::size_t n, off_t at) { return ::pread(fd_, bytes, n, at); };
  if (const int error = transfer(call, reinterpret_cast<char*>(radiance.data()),
                                 radiance.size() * sizeof(Rgb), offset(bucket, 0)))
    return failure(folder_, "cannot read back", error);
  return {};
}

}  // namespace lightwell
