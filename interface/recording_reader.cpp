// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/recording_reader.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "interface/recording_picture.h"

namespace lightwell {

Status MatroskaReader::begin(bool tolerant) {
  auto opened = open_container();
  if (!opened) return opened.error();
  open_ = std::move(*opened);
  const auto end = find_segment_end(open_.file->fd());
  if (end) end_ = *end;
  if (Status status = read_header(tolerant); !status) return status;
  if (Status status = open_decoder(); !status) return status;
  samples_.resize(picture_bytes(header_.format));
  pending_ = fetch();
  if (!pending_) return bad("holds no frames");
  return {};
}

Status MatroskaReader::open_decoder() {
  decoder_.reset();
  if (header_.codec == RecordingCodec::raw) return {};
  const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_FFV1);
  if (codec == nullptr) return Error{ErrorKind::failed, "this FFmpeg has no FFV1 decoder"};
  decoder_.reset(avcodec_alloc_context3(codec));
  const AVCodecParameters* parameters = open_.container->streams[open_.video]->codecpar;
  decoder_->thread_type = FF_THREAD_SLICE;  // threads on slices add no delay
  decoder_->thread_count = 2;
  int code = avcodec_parameters_to_context(decoder_.get(), parameters);
  if (code >= 0) code = avcodec_open2(decoder_.get(), codec, nullptr);
  if (code < 0) return bad("the FFV1 header is damaged");
  return {};
}

Status MatroskaReader::rewind() {
  auto opened = open_container();
  if (!opened) return opened.error();
  av_packet_unref(packet_.get());
  open_ = std::move(*opened);
  if (Status status = open_decoder(); !status) return status;
  at_damage_ = ended_ = false;
  next_index_ = 0;
  pending_ = fetch();
  return {};
}

double MatroskaReader::share_done() const {
  const std::int64_t size = avio_size(open_.file->io());
  return size > 0
             ? std::min(1.0, static_cast<double>(avio_tell(open_.file->io())) / static_cast<double>(size))
             : 1;
}

bool MatroskaReader::fetch() {
  for (;;) {
    av_packet_unref(packet_.get());
    if (av_read_frame(open_.container.get(), packet_.get()) < 0) return false;
    if (packet_->stream_index == open_.video) return true;
  }
}

std::optional<FrameRecord> MatroskaReader::record_of_packet(std::span<const std::byte>& verbatim) const {
  constexpr std::size_t kIdBytes = 8;  // FFmpeg puts the block addition's number before its content
  std::size_t size = 0;
  const std::uint8_t* data =
      av_packet_get_side_data(packet_.get(), AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL, &size);
  if (data == nullptr || size < kIdBytes + kFrameRecordBytes) return std::nullopt;
  const auto bytes = std::as_bytes(std::span(data, size)).subspan(kIdBytes);
  verbatim = bytes.subspan(kFrameRecordBytes);
  return unpack_record(bytes);
}

bool MatroskaReader::decode_ffv1() {
  if (avcodec_send_packet(decoder_.get(), packet_.get()) < 0) return false;
  if (avcodec_receive_frame(decoder_.get(), picture_.get()) < 0) return false;
  const FrameFormat& format = header_.format;
  if (picture_->width != format.width || picture_->height != format.height ||
      picture_->format != picture_format(format.pixel_format))
    return false;
  const std::size_t row = samples_.size() / static_cast<std::size_t>(format.height);
  for (int y = 0; y < format.height; ++y)
    std::memcpy(samples_.data() + static_cast<std::size_t>(y) * row,
                picture_->data[0] + static_cast<std::ptrdiff_t>(y) * picture_->linesize[0], row);
  av_frame_unref(picture_.get());
  return true;
}

bool MatroskaReader::decode_packet(const FrameRecord& record, std::span<const std::byte> verbatim,
                                   std::span<std::byte> codes) {
  if (record.verbatim) {
    if (verbatim.size() != codes.size()) return false;
    std::copy(verbatim.begin(), verbatim.end(), codes.begin());
  } else if (decoder_) {
    if (!decode_ffv1()) return false;
    codes_from_picture(header_.format, samples_, codes);
  } else {
    const auto picture = std::as_bytes(std::span(packet_->data, static_cast<std::size_t>(packet_->size)));
    if (picture.size() != samples_.size()) return false;
    codes_from_picture(header_.format, picture, codes);
  }
  return crc32(codes) == record.codes_crc32;
}

Result<std::optional<RecordedFrame>> MatroskaReader::next(std::span<std::byte> codes, bool decode) {
  verify_bug(!decode || codes.size() == header_.format.bytes(),
             "a take is read into a buffer of another size");
  if (ended_) return std::optional<RecordedFrame>();
  if (!pending_ && !fetch()) return at_end();
  pending_ = false;
  std::span<const std::byte> verbatim;
  const auto record = record_of_packet(verbatim);
  if (!record || record->index < next_index_) {
    at_damage_ = true;
    return bad("the data beside frame " + std::to_string(next_index_) + " are damaged");
  }
  if (record->index > next_index_ && !at_damage_) {
    at_damage_ = pending_ = true;
    return bad("damaged: of the frames from " + std::to_string(next_index_) + " to " +
               std::to_string(record->index - 1) + " not enough is left");
  }
  next_index_ = record->index + 1;
  at_damage_ = false;
  if (decode && !decode_packet(*record, verbatim, codes)) {
    return bad("frame " + std::to_string(record->index) + " is damaged: its codes do not fit their checksum");
  }
  return std::optional(record->frame);
}

// Tells once that frames are missing, then that it is the end.
Result<std::optional<RecordedFrame>> MatroskaReader::at_end() {
  ended_ = true;
  if (open_.file->error() != 0)
    return bad(std::string("cannot read on after ") + std::to_string(next_index_) +
               " frames: " + std::strerror(open_.file->error()));
  if (!complete())
    return bad("cut: it has no proper end after " + std::to_string(next_index_) +
               " frames (`lightwell repair` mends it)");
  if (!count_) count_ = count_by_index();
  if (*count_ > next_index_ && !at_damage_)
    return bad("damaged: of the frames from " + std::to_string(next_index_) + " to " +
               std::to_string(*count_ - 1) + " not enough is left");
  return std::optional<RecordedFrame>();
}

Result<std::uint64_t> MatroskaReader::frame_count() {
  if (count_ && *count_ > 0) return *count_;
  if (complete()) count_ = count_by_index();
  if (count_ && *count_ > 0) return *count_;
  auto counted = count_by_reading();
  if (counted) count_ = *counted;
  return counted;
}

// Every frame is a key frame and stands in the cues.
std::uint64_t MatroskaReader::count_by_index() const {
  auto opened = open_container();
  if (!opened) return 0;
  AVStream* stream = opened->container->streams[opened->video];
  if (av_seek_frame(opened->container.get(), opened->video, 0, AVSEEK_FLAG_BACKWARD) < 0) return 0;
  return static_cast<std::uint64_t>(avformat_index_get_entries_count(stream));
}

Result<std::uint64_t> MatroskaReader::count_by_reading() const {
  auto opened = open_container();
  if (!opened) return opened.error();
  const AvPacket packet(av_packet_alloc());
  std::uint64_t count = 0;
  while (av_read_frame(opened->container.get(), packet.get()) >= 0) {
    if (packet->stream_index == opened->video) ++count;
    av_packet_unref(packet.get());
  }
  return count;
}

Result<std::unique_ptr<RecordingReader>> RecordingReader::open(const std::filesystem::path& file) {
  auto reader = std::make_unique<MatroskaReader>(file);
  if (Status status = reader->begin(false); !status) return status.error();
  return std::unique_ptr<RecordingReader>(std::move(reader));
}

}  // namespace lightwell
