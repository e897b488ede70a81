// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "interface/recording_av.h"
#include "interface/recording_container.h"
#include "interface/recording_record.h"

namespace lightwell {

class MatroskaReader final : public RecordingReader {
 public:
  explicit MatroskaReader(std::filesystem::path file) : path_(std::move(file)) {}

  // tolerant: a damaged calibration is dropped and other damage of the header accepted as long as frames can
  // be read.
  Status begin(bool tolerant);

  [[nodiscard]] const RecordingHeader& header() const override { return header_; }
  Result<std::optional<RecordedFrame>> read(std::span<std::byte> codes) override { return next(codes, true); }
  Result<std::optional<RecordedFrame>> skip() override { return next({}, false); }
  Status rewind() override;
  Result<std::uint64_t> frame_count() override;
  [[nodiscard]] bool complete() const override { return end_.has_proper_end && end_.missing_bytes == 0; }

  [[nodiscard]] bool calibration_lost() const { return calibration_lost_; }
  // Frames that are known to have been in the take, read so far or damaged.
  [[nodiscard]] std::uint64_t frames_passed() const { return next_index_; }
  [[nodiscard]] double share_done() const;

 private:
  using Container = std::unique_ptr<AVFormatContext, void (*)(AVFormatContext*)>;
  // One demuxer over the file, at its first frame.
  struct Open {
    std::unique_ptr<AvFile> file;  // outlives the container
    Container container{nullptr, nullptr};
    int video = -1;
  };

  Result<Open> open_container() const;
  Status read_header(bool tolerant);
  void read_calibration(bool tolerant);
  Status open_decoder();
  Result<std::optional<RecordedFrame>> next(std::span<std::byte> codes, bool decode);
  Result<std::optional<RecordedFrame>> at_end();
  bool fetch();  // the next packet of the video track into packet_
  std::optional<FrameRecord> record_of_packet(std::span<const std::byte>& verbatim) const;
  bool decode_packet(const FrameRecord& record, std::span<const std::byte> verbatim,
                     std::span<std::byte> codes);
  bool decode_ffv1();
  std::uint64_t count_by_index() const;
  Result<std::uint64_t> count_by_reading() const;
  [[nodiscard]] Error bad(const std::string& what) const {
    return {ErrorKind::bad_input, path_.string() + ": " + what};
  }

  std::filesystem::path path_;
  RecordingHeader header_;
  SegmentEnd end_;
  Open open_;
  AvCodec decoder_;
  AvPacket packet_{av_packet_alloc()};
  AvFrame picture_{av_frame_alloc()};
  std::vector<std::byte> samples_;
  bool pending_ = false;    // packet_ has been fetched and not delivered
  bool at_damage_ = false;  // damage has been told; the next whole frame goes on
  bool ended_ = false;
  bool calibration_lost_ = false;
  std::uint64_t next_index_ = 0;
  std::optional<std::uint64_t> count_;
};

}  // namespace lightwell
