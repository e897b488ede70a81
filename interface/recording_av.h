// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "interface/recording.h"

// What writer and reader of takes share of FFmpeg: ownership, a file underneath, the mapping of formats and
// tags.
namespace lightwell {

struct AvFree {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
using AvPacket = std::unique_ptr<AVPacket, AvFree>;
using AvFrame = std::unique_ptr<AVFrame, AvFree>;
using AvCodec = std::unique_ptr<AVCodecContext, AvFree>;

// FFmpeg's reading and writing on a file descriptor of ours: no URL in a file's name is followed, the
// system's own error is kept, and a file is created without overwriting.
class AvFile {
 public:
  // errno tells why it failed.
  static std::unique_ptr<AvFile> open(const std::filesystem::path& file);
  static std::unique_ptr<AvFile> create(const std::filesystem::path& file);
  ~AvFile();
  AvFile(const AvFile&) = delete;
  AvFile& operator=(const AvFile&) = delete;

  [[nodiscard]] AVIOContext* io() const { return io_; }
  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] int error() const { return error_; }  // errno of the first failed call, 0: none

 private:
  AvFile(int fd, bool writing);
  static int on_read(void* self, std::uint8_t* buffer, int size);
  static int on_write(void* self, std::uint8_t* buffer, int size);
  static std::int64_t on_seek(void* self, std::int64_t offset, int whence);

  int fd_;
  int error_ = 0;
  AVIOContext* io_ = nullptr;
};

// FFmpeg's own messages are not for our users.
void silence_ffmpeg();
std::string av_error_text(int code);

AVPixelFormat picture_format(PixelFormat format);

// Names of the file's tags and of its attachment.
inline constexpr const char* kTagVersion = "LIGHTWELL_TAKE";
inline constexpr const char* kTagPixelFormat = "LIGHTWELL_PIXEL_FORMAT";
inline constexpr const char* kTagRate = "LIGHTWELL_RATE_HZ";
inline constexpr const char* kTagSource = "LIGHTWELL_SOURCE";
inline constexpr const char* kTagStart = "LIGHTWELL_START_UTC_NS";
inline constexpr const char* kTagHeaderCrc = "LIGHTWELL_HEADER_CRC32";
inline constexpr const char* kTagCalibrationCrc = "LIGHTWELL_CALIBRATION_CRC32";
inline constexpr const char* kCalibrationName = "calibration.json";
inline constexpr const char* kCalibrationType = "application/json";

// Checksums of the tags and of the attachment, as written into the tags above.
std::string header_crc(const RecordingHeader& header);
std::string calibration_crc(const RecordingHeader& header);

// A double as text and back, exactly.
std::string exact_text(double value);

}  // namespace lightwell
