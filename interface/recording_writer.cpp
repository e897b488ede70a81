// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
extern "C" {
#include <libavutil/opt.h>
}

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "interface/recording_av.h"
#include "interface/recording_disk_sync.h"
#include "interface/recording_picture.h"
#include "interface/recording_record.h"

namespace lightwell {
namespace {

// FFmpeg's FFV1 coder does not give pictures one or two pixels wide or high back; their codes travel beside
// them.
constexpr int kMinFfv1Side = 3;
constexpr int kMaxSide = 16384;  // what players and coders accept with room to spare
// A cut loses what is not yet written: everything is written after this time, or at this size, so that memory
// stays small.
constexpr std::chrono::milliseconds kClusterTime{400};
constexpr std::size_t kClusterBytes = 4 << 20;
// The muxer gives every frame beyond 4 kB a cluster of its own; it needs no other limits.
constexpr std::int64_t kNeverMs = std::numeric_limits<std::int16_t>::max() - 1000;

class MatroskaWriter final : public RecordingWriter {
 public:
  MatroskaWriter(std::filesystem::path file, const RecordingHeader& header)
      : path_(std::move(file)), header_(header) {}
  ~MatroskaWriter() override {
    if (file_) static_cast<void>(close());
  }

  Status begin();
  Status write(const RecordedFrame& frame, std::span<const std::byte> codes) override;
  Status flush() override;
  Status close() override;
  [[nodiscard]] std::uint64_t frames() const override { return frames_; }
  [[nodiscard]] std::uint64_t bytes() const override { return whole_bytes_ + pending_bytes_; }

 private:
  Status open_encoder();
  Status open_container();
  void add_tags();
  bool add_calibration();
  Status encode(std::span<const std::byte> codes, bool& verbatim);
  bool attach_record(const FrameRecord& record, std::span<const std::byte> codes);
  std::int64_t next_pts(const RecordedFrame& frame);
  Status end_cluster();
  Status give_up(int code);
  Status remove_without_frames();
  [[nodiscard]] bool unlink_own() const;
  [[nodiscard]] Error failure(const std::string& what) const {
    return {ErrorKind::failed, path_.string() + ": " + what};
  }

  std::filesystem::path path_;
  RecordingHeader header_;
  std::unique_ptr<AvFile> file_;
  std::unique_ptr<DiskSync> sync_;
  std::unique_ptr<AVFormatContext, decltype(&avformat_free_context)> container_{nullptr,
                                                                                avformat_free_context};
  AVStream* video_ = nullptr;
  AvCodec encoder_;
  AvFrame picture_{av_frame_alloc()};
  AvPacket packet_{av_packet_alloc()};
  std::vector<std::byte> samples_;
  std::optional<Error> error_;
  std::uint64_t frames_ = 0;
  std::uint64_t whole_frames_ = 0;   // in clusters on disk
  std::uint64_t whole_bytes_ = 0;    // up to the end of the last cluster on disk
  std::uint64_t pending_bytes_ = 0;  // in the cluster in memory
  std::chrono::steady_clock::time_point cluster_begin_;
  std::int64_t first_capture_ns_ = 0;
  std::int64_t last_pts_ms_ = 0;
};

Status MatroskaWriter::begin() {
  file_ = AvFile::create(path_);
  if (!file_)
    return failure(errno == EEXIST ? "exists already and is not overwritten"
                                   : std::string("cannot create: ") + std::strerror(errno));
  Status status = open_encoder();
  if (status) status = open_container();
  if (status) {
    sync_ = std::make_unique<DiskSync>(file_->fd());
    if (encoder_) samples_.resize(picture_bytes(header_.format));
    return {};
  }
  container_.reset();
  file_.reset();
  ::unlink(path_.c_str());
  return status;
}

// FFV1 version 3: every frame on its own, cut into slices with a checksum each.
Status MatroskaWriter::open_encoder() {
  if (header_.codec == RecordingCodec::raw) return {};
  const AVCodec* codec = avcodec_find_encoder(AV_CODEC_ID_FFV1);
  if (codec == nullptr) return failure("this FFmpeg has no FFV1 encoder");
  encoder_.reset(avcodec_alloc_context3(codec));
  AVCodecContext& context = *encoder_;
  context.width = header_.format.width;
  context.height = header_.format.height;
  context.pix_fmt = picture_format(header_.format.pixel_format);
  context.bits_per_raw_sample = significant_bits(header_.format.pixel_format);
  context.time_base = {1, 1000};
  context.gop_size = 1;
  context.level = 3;
  // The encoder accepts one slice only up to this size, and small pictures gain nothing by more.
  const bool small = context.width <= 352 && context.height <= 288;
  context.slices = small ? 1 : 4;
  context.thread_type = FF_THREAD_SLICE;
  context.thread_count = small ? 1 : 2;
  av_opt_set_int(context.priv_data, "slicecrc", 1, 0);
  const int opened = avcodec_open2(&context, codec, nullptr);
  if (opened < 0) return failure("FFV1 encoder: " + av_error_text(opened));
  picture_->format = context.pix_fmt;
  picture_->width = context.width;
  picture_->height = context.height;
  if (av_frame_get_buffer(picture_.get(), 0) < 0) return failure("out of memory");
  return {};
}

void MatroskaWriter::add_tags() {
  AVDictionary** tags = &container_->metadata;
  av_dict_set(tags, "encoding_tool", "Lightwell", 0);
  av_dict_set(tags, kTagVersion, "1", 0);
  av_dict_set(tags, kTagPixelFormat, std::string(name(header_.format.pixel_format)).c_str(), 0);
  av_dict_set(tags, kTagRate, exact_text(header_.rate_hz).c_str(), 0);
  if (!header_.source.empty()) av_dict_set(tags, kTagSource, header_.source.c_str(), 0);
  av_dict_set(tags, kTagStart, std::to_string(header_.start_utc_ns).c_str(), 0);
  av_dict_set(tags, kTagHeaderCrc, header_crc(header_).c_str(), 0);
  av_dict_set(tags, kTagCalibrationCrc, calibration_crc(header_).c_str(), 0);
}

bool MatroskaWriter::add_calibration() {
  const std::string& text = header_.calibration_json;
  if (text.empty()) return true;
  AVStream* stream = avformat_new_stream(container_.get(), nullptr);
  if (stream == nullptr) return false;
  stream->codecpar->codec_type = AVMEDIA_TYPE_ATTACHMENT;
  stream->codecpar->extradata =
      static_cast<std::uint8_t*>(av_mallocz(text.size() + AV_INPUT_BUFFER_PADDING_SIZE));
  if (stream->codecpar->extradata == nullptr) return false;
  std::copy(text.begin(), text.end(), stream->codecpar->extradata);
  stream->codecpar->extradata_size = static_cast<int>(text.size());
  av_dict_set(&stream->metadata, "filename", kCalibrationName, 0);
  av_dict_set(&stream->metadata, "mimetype", kCalibrationType, 0);
  return true;
}

Status MatroskaWriter::open_container() {
  AVFormatContext* made = nullptr;
  if (avformat_alloc_output_context2(&made, nullptr, "matroska", nullptr) < 0)
    return failure("this FFmpeg has no Matroska muxer");
  container_.reset(made);
  made->pb = file_->io();
  made->flags |= AVFMT_FLAG_CUSTOM_IO | AVFMT_FLAG_BITEXACT;  // bit-exact: equal frames make equal files
  made->flush_packets = 0;
  av_opt_set_int(made->priv_data, "write_crc32", 0, 0);  // every frame carries its own
  av_opt_set_int(made->priv_data, "cluster_time_limit", kNeverMs, 0);
  av_opt_set_int(made->priv_data, "cluster_size_limit", std::numeric_limits<int>::max(), 0);

  video_ = avformat_new_stream(made, nullptr);
  if (video_ == nullptr) return failure("out of memory");
  AVCodecParameters& parameters = *video_->codecpar;
  const AVPixelFormat pixels = picture_format(header_.format.pixel_format);
  const unsigned tag_of_picture = avcodec_pix_fmt_to_codec_tag(pixels);
  if (encoder_) {
    if (avcodec_parameters_from_context(&parameters, encoder_.get()) < 0) return failure("out of memory");
  } else {
    parameters.codec_type = AVMEDIA_TYPE_VIDEO;
    parameters.codec_id = AV_CODEC_ID_RAWVIDEO;
    parameters.format = pixels;
    parameters.codec_tag = tag_of_picture;
    parameters.width = header_.format.width;
    parameters.height = header_.format.height;
  }
  video_->time_base = {1, 1000};
  if (header_.rate_hz > 0) video_->avg_frame_rate = av_d2q(header_.rate_hz, 1'000'000);
  add_tags();
  if (!add_calibration()) return failure("out of memory");

  int began = avformat_init_output(made, nullptr);
  // FFmpeg's table for this muxer knows 8 bit grey alone and drops the tags of the deeper ones, which its own
  // reader (and the Matroska specification's V_UNCOMPRESSED) takes as they are.
  if (!encoder_) parameters.codec_tag = tag_of_picture;
  if (began >= 0) began = avformat_write_header(made, nullptr);
  if (began < 0) return failure("cannot begin: " + av_error_text(began));
  avio_flush(made->pb);
  if (file_->error() != 0) return failure(std::string("cannot write: ") + std::strerror(file_->error()));
  whole_bytes_ = static_cast<std::uint64_t>(avio_tell(made->pb));
  return {};
}

// codes → packet_. verbatim: the picture does not hold all of them.
Status MatroskaWriter::encode(std::span<const std::byte> codes, bool& verbatim) {
  if (!encoder_) {
    const std::size_t size = picture_bytes(header_.format);
    if (av_new_packet(packet_.get(), static_cast<int>(size)) < 0) return failure("out of memory");
    const auto picture = std::as_writable_bytes(std::span(packet_->data, size));
    verbatim = !picture_from_codes(header_.format, codes, picture);
    return {};
  }
  verbatim = !picture_from_codes(header_.format, codes, samples_);
  if (std::min(header_.format.width, header_.format.height) < kMinFfv1Side) verbatim = true;
  if (av_frame_make_writable(picture_.get()) < 0) return failure("out of memory");
  const std::size_t row = samples_.size() / static_cast<std::size_t>(header_.format.height);
  for (int y = 0; y < header_.format.height; ++y)
    std::memcpy(picture_->data[0] + static_cast<std::ptrdiff_t>(y) * picture_->linesize[0],
                samples_.data() + static_cast<std::size_t>(y) * row, row);
  picture_->pts = static_cast<std::int64_t>(frames_);
  int code = avcodec_send_frame(encoder_.get(), picture_.get());
  if (code >= 0) code = avcodec_receive_packet(encoder_.get(), packet_.get());
  if (code < 0) return failure("FFV1 encoder: " + av_error_text(code));
  return {};
}

bool MatroskaWriter::attach_record(const FrameRecord& record, std::span<const std::byte> codes) {
  constexpr std::size_t kIdBytes =
      8;  // FFmpeg puts the block addition's number, big-endian, before its content
  const std::size_t size = kIdBytes + kFrameRecordBytes + (record.verbatim ? codes.size() : 0);
  std::uint8_t* data = av_packet_new_side_data(packet_.get(), AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL, size);
  if (data == nullptr) return false;
  std::memset(data, 0, kIdBytes);
  data[kIdBytes - 1] = 1;
  const auto packed = pack_record(record);
  std::memcpy(data + kIdBytes, packed.data(), packed.size());
  if (record.verbatim) std::memcpy(data + kIdBytes + packed.size(), codes.data(), codes.size());
  return true;
}

// For players only: milliseconds since the first frame, always rising. A capture time that does not follow
// the one before within an hour is no time to play by; the next millisecond serves.
std::int64_t MatroskaWriter::next_pts(const RecordedFrame& frame) {
  constexpr std::int64_t kHourMs = 3'600'000;
  if (frames_ == 0) {
    first_capture_ns_ = frame.capture_mono_ns;
    return 0;
  }
  std::int64_t since_ns = 0;
  std::int64_t pts = last_pts_ms_ + 1;
  if (!__builtin_sub_overflow(frame.capture_mono_ns, first_capture_ns_, &since_ns)) {
    const std::int64_t ms = since_ns / 1'000'000;
    if (ms > last_pts_ms_ && ms - last_pts_ms_ < kHourMs) pts = ms;
  }
  return pts;
}

Status MatroskaWriter::write(const RecordedFrame& frame, std::span<const std::byte> codes) {
  if (error_) return *error_;
  verify_bug(file_ != nullptr, "a take is written after its end");
  verify_bug(codes.size() == header_.format.bytes(), "a frame of another size is written into a take");
  FrameRecord record{.index = frames_, .frame = frame, .verbatim = false, .codes_crc32 = crc32(codes)};
  if (Status status = encode(codes, record.verbatim); !status) return status;
  if (!attach_record(record, codes)) return failure("out of memory");

  if (pending_bytes_ == 0) cluster_begin_ = std::chrono::steady_clock::now();
  pending_bytes_ += static_cast<std::uint64_t>(packet_->size) + kFrameRecordBytes;
  last_pts_ms_ = next_pts(frame);
  packet_->pts = packet_->dts = last_pts_ms_;
  packet_->stream_index = video_->index;
  packet_->flags |= AV_PKT_FLAG_KEY;
  const int code = av_write_frame(container_.get(), packet_.get());
  av_packet_unref(packet_.get());
  if (code < 0 || file_->error() != 0) return give_up(code);
  ++frames_;
  if (pending_bytes_ >= kClusterBytes || std::chrono::steady_clock::now() - cluster_begin_ >= kClusterTime)
    return end_cluster();
  return {};
}

Status MatroskaWriter::end_cluster() {
  if (pending_bytes_ == 0) return {};
  const int code = av_write_frame(container_.get(), nullptr);
  avio_flush(file_->io());
  if (code < 0 || file_->error() != 0) return give_up(code);
  whole_bytes_ = static_cast<std::uint64_t>(avio_tell(file_->io()));
  whole_frames_ = frames_;
  pending_bytes_ = 0;
  sync_->request();
  return {};
}

Status MatroskaWriter::flush() {
  if (error_) return *error_;
  return file_ ? end_cluster() : Status();
}

// The disk is full or gone: cut what is half written, keep what is whole.
Status MatroskaWriter::give_up(int code) {
  error_ = failure(std::string("cannot write: ") +
                   (file_->error() != 0 ? std::strerror(file_->error()) : av_error_text(code)));
  sync_.reset();
  container_.reset();
  if (whole_frames_ == 0) {
    error_->message += unlink_own() ? "; no frame was whole, the file is removed" : "; no frame was whole";
    whole_bytes_ = 0;
  } else if (::ftruncate(file_->fd(), static_cast<off_t>(whole_bytes_)) == 0) {
    error_->message += "; the take is kept up to its last whole cluster";
  } else {
    error_->message +=
        std::string("; the take cannot be cut to its last whole cluster: ") + std::strerror(errno);
  }
  file_.reset();
  frames_ = whole_frames_;
  pending_bytes_ = 0;
  return *error_;
}

// Nothing reads a take without frames.
Status MatroskaWriter::remove_without_frames() {
  sync_.reset();
  container_.reset();
  error_ = failure(unlink_own() ? "no frame came, the file is removed" : "no frame came");
  file_.reset();
  whole_bytes_ = 0;
  return *error_;
}

// Only the file that is open here; another may have got its name meanwhile.
bool MatroskaWriter::unlink_own() const {
  struct stat own {};
  struct stat named {};
  return ::fstat(file_->fd(), &own) == 0 && ::stat(path_.c_str(), &named) == 0 &&
         own.st_dev == named.st_dev && own.st_ino == named.st_ino && ::unlink(path_.c_str()) == 0;
}

Status MatroskaWriter::close() {
  if (error_) return *error_;
  if (!file_) return {};
  if (frames_ == 0) return remove_without_frames();
  if (Status status = end_cluster(); !status) return status;
  const int code = av_write_trailer(container_.get());
  avio_flush(file_->io());
  if (code < 0 || file_->error() != 0) return give_up(code);
  whole_bytes_ = static_cast<std::uint64_t>(std::max<std::int64_t>(avio_size(file_->io()), 0));
  sync_.reset();
  container_.reset();
  const bool safe = ::fsync(file_->fd()) == 0;
  const int why = errno;
  file_.reset();
  if (safe) return {};
  error_ = failure(std::string("cannot write: ") + std::strerror(why));
  return *error_;
}

}  // namespace

Result<std::unique_ptr<RecordingWriter>> RecordingWriter::create(const std::filesystem::path& file,
                                                                 const RecordingHeader& header) {
  silence_ffmpeg();
  for (const int side : {header.format.width, header.format.height})
    if (side < 1 || side > kMaxSide)
      return Error{ErrorKind::usage, file.string() + ": frame size " + std::to_string(header.format.width) +
                                         "x" + std::to_string(header.format.height) + " is outside 1x1 to " +
                                         std::to_string(kMaxSide) + "x" + std::to_string(kMaxSide)};
  auto writer = std::make_unique<MatroskaWriter>(file, header);
  if (Status status = writer->begin(); !status) return status.error();
  return std::unique_ptr<RecordingWriter>(std::move(writer));
}

}  // namespace lightwell
