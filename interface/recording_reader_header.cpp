// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// The part of the reader that opens the file and understands its header.
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include "interface/recording_reader.h"

namespace lightwell {
namespace {

std::string_view tag(const AVDictionary* tags, const char* key) {
  const AVDictionaryEntry* entry = av_dict_get(tags, key, nullptr, 0);
  return entry == nullptr ? std::string_view() : std::string_view(entry->value);
}

template <class T>
bool parse(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

int find_video(const AVFormatContext& container) {
  for (unsigned i = 0; i < container.nb_streams; ++i) {
    const AVCodecParameters& parameters = *container.streams[i]->codecpar;
    if (parameters.codec_type == AVMEDIA_TYPE_VIDEO &&
        (parameters.codec_id == AV_CODEC_ID_FFV1 || parameters.codec_id == AV_CODEC_ID_RAWVIDEO))
      return static_cast<int>(i);
  }
  return -1;
}

}  // namespace

Result<MatroskaReader::Open> MatroskaReader::open_container() const {
  silence_ffmpeg();
  Open open;
  open.file = AvFile::open(path_);
  if (!open.file)
    return bad(errno == EISDIR   ? std::string("is a directory, expected a take (.mkv)")
               : errno == EINVAL ? std::string("is not a file")
                                 : std::string("cannot read: ") + std::strerror(errno));
  const auto end = find_segment_end(open.file->fd());
  if (!end) return bad("is not a Matroska file, or cut within its first bytes");
  AVFormatContext* context = avformat_alloc_context();
  verify_bug(context != nullptr, "out of memory");
  context->pb = open.file->io();
  context->flags |= AVFMT_FLAG_CUSTOM_IO;
  // The format is given, not guessed: nothing but Matroska is ever opened.
  const int code = avformat_open_input(&context, "", av_find_input_format("matroska"), nullptr);
  const bool ends_early = code == AVERROR(EIO) || code == AVERROR_EOF;
  if (code < 0 && ends_early && open.file->error() == 0 && (!end->has_proper_end || end->missing_bytes > 0))
    return bad("cut within its header, before any frame");
  if (code < 0) return bad("is damaged: it cannot be read as Matroska");
  open.container = Container(context, [](AVFormatContext* closing) { avformat_close_input(&closing); });
  context->max_index_size = 1u << 30;  // the index counts the frames; a long take's must not be thinned
  open.video = find_video(*context);
  if (open.video < 0) return bad("has no video track in raw or FFV1 coding: not a Lightwell take");
  return open;
}

Status MatroskaReader::read_header(bool tolerant) {
  const AVCodecParameters& parameters = *open_.container->streams[open_.video]->codecpar;
  const AVDictionary* tags = open_.container->metadata;
  if (tag(tags, kTagVersion) != "1")
    return bad(std::string("tag ") + kTagVersion + " is '" + std::string(tag(tags, kTagVersion)) +
               "', expected '1': not a Lightwell take");
  header_.codec = parameters.codec_id == AV_CODEC_ID_FFV1 ? RecordingCodec::ffv1 : RecordingCodec::raw;
  header_.format.width = parameters.width;
  header_.format.height = parameters.height;
  const auto pixel_format = pixel_format_from_name(tag(tags, kTagPixelFormat));
  if (!pixel_format)
    return bad(std::string("tag ") + kTagPixelFormat + " is '" + std::string(tag(tags, kTagPixelFormat)) +
               "', expected a pixel format such as 'Mono12'");
  header_.format.pixel_format = *pixel_format;
  constexpr int kMaxSide = 16384;
  if (header_.format.width < 1 || header_.format.width > kMaxSide || header_.format.height < 1 ||
      header_.format.height > kMaxSide)
    return bad("frame size " + std::to_string(header_.format.width) + "x" +
               std::to_string(header_.format.height) + " is outside 1x1 to 16384x16384");
  header_.source = tag(tags, kTagSource);
  const bool numbers =
      parse(tag(tags, kTagRate), header_.rate_hz) && parse(tag(tags, kTagStart), header_.start_utc_ns);
  if (!tolerant && (!numbers || tag(tags, kTagHeaderCrc) != header_crc(header_)))
    return bad("the header is damaged: its checksum does not fit (`lightwell repair` saves the frames)");
  read_calibration(tolerant);
  if (calibration_lost_ && !tolerant)
    return bad(
        "the attached calibration is damaged: its checksum does not fit (`lightwell repair` saves the "
        "frames)");
  return {};
}

void MatroskaReader::read_calibration(bool tolerant) {
  for (unsigned i = 0; i < open_.container->nb_streams; ++i) {
    const AVStream& stream = *open_.container->streams[i];
    if (stream.codecpar->codec_type != AVMEDIA_TYPE_ATTACHMENT) continue;
    if (tag(stream.metadata, "filename") != kCalibrationName || stream.codecpar->extradata_size <= 0)
      continue;
    header_.calibration_json.assign(reinterpret_cast<const char*>(stream.codecpar->extradata),
                                    static_cast<std::size_t>(stream.codecpar->extradata_size));
  }
  calibration_lost_ = tag(open_.container->metadata, kTagCalibrationCrc) != calibration_crc(header_);
  if (calibration_lost_ && tolerant) header_.calibration_json.clear();
}

}  // namespace lightwell
