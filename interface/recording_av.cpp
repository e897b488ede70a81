// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/recording_av.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <mutex>

#include "interface/recording_record.h"

namespace lightwell {
namespace {

constexpr int kBufferBytes = 1 << 18;  // one system call for many small elements, small beside a frame

std::string crc_text(std::string_view text) {
  std::array<char, 9> hex{};
  std::snprintf(hex.data(), hex.size(), "%08x", crc32(std::as_bytes(std::span(text))));
  return hex.data();
}

}  // namespace

std::string_view name(RecordingCodec codec) {
  return codec == RecordingCodec::raw ? "raw" : "ffv1";
}

std::optional<RecordingCodec> recording_codec_from_name(std::string_view text) {
  for (const RecordingCodec codec : {RecordingCodec::raw, RecordingCodec::ffv1})
    if (name(codec) == text) return codec;
  return std::nullopt;
}

AvFile::AvFile(int fd, bool writing) : fd_(fd) {
  auto* buffer = static_cast<unsigned char*>(av_malloc(kBufferBytes));
  verify_bug(buffer != nullptr, "out of memory");
  io_ = avio_alloc_context(buffer, kBufferBytes, writing ? 1 : 0, this, writing ? nullptr : &AvFile::on_read,
                           writing ? &AvFile::on_write : nullptr, &AvFile::on_seek);
  verify_bug(io_ != nullptr, "out of memory");
}

AvFile::~AvFile() {
  av_freep(static_cast<void*>(&io_->buffer));
  avio_context_free(&io_);
  ::close(fd_);
}

std::unique_ptr<AvFile> AvFile::open(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return nullptr;
  struct stat info {};
  if (::fstat(fd, &info) != 0 || !S_ISREG(info.st_mode)) {
    errno = S_ISDIR(info.st_mode) ? EISDIR : EINVAL;
    const int why = errno;
    ::close(fd);
    errno = why;
    return nullptr;
  }
  return std::unique_ptr<AvFile>(new AvFile(fd, false));
}

std::unique_ptr<AvFile> AvFile::create(const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return nullptr;
  return std::unique_ptr<AvFile>(new AvFile(fd, true));
}

int AvFile::on_read(void* self, std::uint8_t* buffer, int size) {
  auto& file = *static_cast<AvFile*>(self);
  for (;;) {
    const ssize_t n = ::read(file.fd_, buffer, static_cast<std::size_t>(size));
    if (n > 0) return static_cast<int>(n);
    if (n == 0) return AVERROR_EOF;
    if (errno == EINTR) continue;
    if (file.error_ == 0) file.error_ = errno;
    return AVERROR(errno);
  }
}

int AvFile::on_write(void* self, std::uint8_t* buffer, int size) {
  auto& file = *static_cast<AvFile*>(self);
  for (int done = 0; done < size;) {
    const ssize_t n = ::write(file.fd_, buffer + done, static_cast<std::size_t>(size - done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      if (file.error_ == 0) file.error_ = n < 0 ? errno : ENOSPC;
      return AVERROR(file.error_);
    }
    done += static_cast<int>(n);
  }
  return size;
}

std::int64_t AvFile::on_seek(void* self, std::int64_t offset, int whence) {
  const auto& file = *static_cast<AvFile*>(self);
  if ((whence & AVSEEK_SIZE) != 0) {
    struct stat info {};
    return ::fstat(file.fd_, &info) == 0 ? info.st_size : AVERROR(errno);
  }
  const off_t at = ::lseek(file.fd_, offset, whence & ~AVSEEK_FORCE);
  return at < 0 ? AVERROR(errno) : at;
}

void silence_ffmpeg() {
  static std::once_flag once;
  std::call_once(once, [] { av_log_set_level(AV_LOG_QUIET); });
}

std::string av_error_text(int code) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(code, text.data(), text.size());
  return text.data();
}

AVPixelFormat picture_format(PixelFormat format) {
  switch (significant_bits(format)) {
    case 8:
      return AV_PIX_FMT_GRAY8;
    case 10:
      return AV_PIX_FMT_GRAY10LE;
    case 12:
      return AV_PIX_FMT_GRAY12LE;
    default:
      return AV_PIX_FMT_GRAY16LE;
  }
}

std::string exact_text(double value) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  return {text.data(), end.ptr};
}

std::string header_crc(const RecordingHeader& header) {
  const FrameFormat& format = header.format;
  return crc_text(std::to_string(format.width) + '\n' + std::to_string(format.height) + '\n' +
                  std::string(name(format.pixel_format)) + '\n' + std::string(name(header.codec)) + '\n' +
                  exact_text(header.rate_hz) + '\n' + header.source + '\n' +
                  std::to_string(header.start_utc_ns));
}

std::string calibration_crc(const RecordingHeader& header) {
  return crc_text(header.calibration_json);
}

}  // namespace lightwell
