// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/exr_file.h"

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "lighting/chromaticities.h"

namespace lightwell {
namespace {

constexpr std::string_view kMagic = "\x76\x2f\x31\x01";
constexpr int kNoThreads = 0;  // the caller's thread does the work; the library starts none

class MemoryInput : public Imf::IStream {
 public:
  MemoryInput(std::string_view bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}
  bool read(char to[], int count) override {
    const auto wanted = static_cast<std::size_t>(count);
    if (count < 0 || position_ > bytes_.size() || wanted > bytes_.size() - position_)
      throw Iex::InputExc("the file ends early");
    std::memcpy(to, bytes_.data() + position_, wanted);
    position_ += wanted;
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("memory") {}
  void write(const char from[], int count) override {
    const std::size_t end = position_ + static_cast<std::size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, from, static_cast<std::size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::uint64_t position_ = 0;
};

Error bad(const std::string& name, const std::string& what) {
  return {ErrorKind::bad_input, name + ": " + what};
}

std::string first_line(const std::string& text) {
  return text.substr(0, text.find('\n'));
}

// An attribute's memory is taken before its bytes are read: none may claim more than the file has. Walks the
// headers (OpenEXR file layout: name, type, size, value; an empty name ends a header, and of a multi-part
// file's headers an empty one is the last).
bool attributes_fit(std::string_view bytes) {
  constexpr unsigned char kMultiPart = 0x10;  // bit 12 of the version field
  if (bytes.size() < 8) return false;
  const bool multi_part = (static_cast<unsigned char>(bytes[5]) & kMultiPart) != 0;
  std::size_t at = 8;
  for (bool header_is_empty = true;;) {
    const std::size_t name_end = bytes.find('\0', at);
    if (name_end == std::string_view::npos) return false;
    if (name_end == at) {
      if (!multi_part || header_is_empty) return true;
      header_is_empty = true;
      ++at;
      continue;
    }
    header_is_empty = false;
    const std::size_t type_end = bytes.find('\0', name_end + 1);
    if (type_end == std::string_view::npos || bytes.size() - type_end < 5) return false;
    std::uint32_t size = 0;
    for (unsigned i = 0; i < 4; ++i)
      size |= std::uint32_t{static_cast<unsigned char>(bytes[type_end + 1 + i])} << (8 * i);
    at = type_end + 5;
    if (size > bytes.size() - at) return false;
    at += size;
  }
}

// Names of the channels that are red, green and blue; empty: dark. Gray: all three the same one.
using ColourChannels = std::array<std::string, 3>;

std::optional<ColourChannels> colour_channels(const std::vector<std::string>& names) {
  const auto find = [&](const std::string& wanted) -> std::string {
    const auto upper = [](char c) { return std::toupper(static_cast<unsigned char>(c)); };
    for (const std::string& name : names)
      if (std::equal(name.begin(), name.end(), wanted.begin(), wanted.end(),
                     [&](char a, char b) { return upper(a) == upper(b); }))
        return name;
    return {};
  };
  // The plain channels first, then those of the first layer that has any ("rgba.R").
  std::vector<std::string> prefixes = {""};
  for (const std::string& name : names)
    if (const auto dot = name.rfind('.'); dot != std::string::npos)
      prefixes.push_back(name.substr(0, dot + 1));
  for (const std::string& prefix : prefixes) {
    const ColourChannels rgb = {find(prefix + "R"), find(prefix + "G"), find(prefix + "B")};
    if (rgb != ColourChannels{}) return rgb;
    if (const std::string y = find(prefix + "Y"); !y.empty()) return ColourChannels{y, y, y};
  }
  if (names.size() == 1 && find("A").empty() && find("Z").empty())
    return ColourChannels{names[0], names[0], names[0]};
  return std::nullopt;
}

struct Window {
  std::int64_t x;
  std::int64_t y;
  std::int64_t width;
  std::int64_t height;
};

Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, std::int64_t{box.max.x} - box.min.x + 1,
          std::int64_t{box.max.y} - box.min.y + 1};
}

// Why the first part is not one we read; empty: it is.
std::string refusal(const Imf::Header& header, std::int64_t pixel_limit) {
  if (header.hasType() && Imf::isDeepData(header.type()))
    return "deep image data, expected a flat latitude–longitude image";
  if (Imf::hasEnvmap(header) && Imf::envmap(header) == Imf::ENVMAP_CUBE)
    return "attribute envmap is cube, expected latitude–longitude";
  const Window data = window_of(header.dataWindow());
  const Window display = window_of(header.displayWindow());
  const auto too_big = [&](std::int64_t w, std::int64_t h) {
    return w <= 0 || h <= 0 || w > pixel_limit / h;
  };
  if (too_big(data.width, data.height) || too_big(display.width, display.height))
    return "image size " + std::to_string(display.width) + "x" + std::to_string(display.height) +
           " with data " + std::to_string(data.width) + "x" + std::to_string(data.height) +
           ", allowed 1x1 to " + std::to_string(pixel_limit) + " pixels";
  // The library takes the memory of a row of tiles at once.
  if (header.hasTileDescription() &&
      too_big(std::max<std::int64_t>(data.width, header.tileDescription().xSize),
              header.tileDescription().ySize))
    return "tiles of " + std::to_string(header.tileDescription().xSize) + "x" +
           std::to_string(header.tileDescription().ySize) + " pixels, too large";
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
    if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
      return std::string("channel ") + c.name() + " is subsampled, expected full resolution";
  return {};
}

// The pixels of the data window, [height][width]; grows with what the file really holds.
std::vector<Rgb> read_data_window(Imf::InputPart& part, const ColourChannels& channels) {
  const Window data = window_of(part.header().dataWindow());
  const auto columns = static_cast<std::size_t>(data.width);
  constexpr std::int64_t kPixelsAtOnce = 1 << 20;
  const std::int64_t step = part.header().hasTileDescription()
                                ? std::int64_t{part.header().tileDescription().ySize}
                                : std::max<std::int64_t>(1, kPixelsAtOnce / data.width);
  const std::size_t rows_at_once = static_cast<std::size_t>(std::min(step, data.height));
  // Not initialised: pages that the file does not fill are never touched.
  const std::unique_ptr<float[]> rows(new float[3 * columns * rows_at_once]);
  std::vector<Rgb> pixels;
  for (std::int64_t y = 0; y < data.height; y += step) {
    const std::int64_t end = std::min(y + step, data.height);
    const int first_row = static_cast<int>(data.y + y);
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < 3; ++c)
      if (!channels[c].empty() && frame.findSlice(channels[c]) == nullptr)
        frame.insert(channels[c],
                     Imf::Slice::Make(Imf::FLOAT, &rows[c], Imath::V2i(static_cast<int>(data.x), first_row),
                                      data.width, end - y, 3 * sizeof(float), 3 * sizeof(float) * columns));
    part.setFrameBuffer(frame);
    part.readPixels(first_row, static_cast<int>(data.y + end) - 1);
    const bool gray = channels[0] == channels[1] && channels[0] == channels[2];
    for (std::size_t p = 0; p < columns * static_cast<std::size_t>(end - y); ++p) {
      const float* sample = &rows[3 * p];
      const auto value = [&](std::size_t c) { return channels[c].empty() ? 0.0f : sample[gray ? 0 : c]; };
      pixels.emplace_back(value(0), value(1), value(2));
    }
  }
  return pixels;
}

Chromaticities chromaticities_of(const Imf::Header& header) {
  if (!Imf::hasChromaticities(header)) return {};
  const Imf::Chromaticities& c = Imf::chromaticities(header);
  const auto xy = [](const Imath::V2f& v) { return Eigen::Vector2d(v.x, v.y); };
  return {xy(c.red), xy(c.green), xy(c.blue), xy(c.white)};
}

// The display window may be larger than the data window, or not cover it.
LatLongImage place(std::vector<Rgb> pixels, const Window& data, const Window& display) {
  LatLongImage image{static_cast<int>(display.width), static_cast<int>(display.height), {}};
  if (data.x == display.x && data.y == display.y && data.width == display.width &&
      data.height == display.height) {
    image.pixels = std::move(pixels);
    return image;
  }
  image.pixels.assign(static_cast<std::size_t>(display.width * display.height), Rgb::Zero());
  for (std::int64_t y = 0; y < data.height; ++y)
    for (std::int64_t x = 0; x < data.width; ++x) {
      const std::int64_t u = x + data.x - display.x;
      const std::int64_t v = y + data.y - display.y;
      if (u < 0 || v < 0 || u >= display.width || v >= display.height) continue;
      image.at(static_cast<int>(u), static_cast<int>(v)) =
          pixels[static_cast<std::size_t>(y * data.width + x)];
    }
  return image;
}

}  // namespace

bool is_exr(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

Result<LatLongImage> read_exr(std::string_view bytes, const std::string& name, std::int64_t pixel_limit,
                              bool* converted) {
  if (!attributes_fit(bytes)) return bad(name, "truncated or damaged EXR header");
  try {
    MemoryInput memory(bytes, name);
    constexpr bool kRepairOffsets = false;  // a file without its offsets is a truncated one
    Imf::MultiPartInputFile file(memory, kNoThreads, kRepairOffsets);
    const Imf::Header& header = file.header(0);
    if (const std::string why = refusal(header, pixel_limit); !why.empty()) return bad(name, why);
    std::vector<std::string> names;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) names.emplace_back(c.name());
    const auto channels = colour_channels(names);
    if (!channels) return bad(name, "no colour channels, expected R, G, B or Y");
    const Chromaticities space = chromaticities_of(header);
    const bool gray = (*channels)[0] == (*channels)[1] && (*channels)[0] == (*channels)[2];
    const bool other = !gray && !is_rec709(space);
    const auto to_rec709 = rec709_from(space);
    if (other && !to_rec709)
      return bad(name, "attribute chromaticities is no colour space: primaries on one line or no white");
    Imf::InputPart part(file, 0);
    std::vector<Rgb> pixels = read_data_window(part, *channels);
    if (other) convert_colours(pixels, *to_rec709);
    if (converted != nullptr) *converted = other;
    return place(std::move(pixels), window_of(header.dataWindow()), window_of(header.displayWindow()));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return bad(name, "truncated or damaged image data");
  }
}

Result<std::string> exr_from_floats(int width, int height, std::string_view channels,
                                    std::span<const float> pixels, ExrContent content,
                                    const ExrFacts& facts) {
  verify_bug(width > 0 && height > 0 &&
                 pixels.size() ==
                     channels.size() * static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
             "EXR of another size than its pixels");
  try {
    Imf::Header header(width, height);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());  // OpenEXR's default is Rec. 709, D65
    if (content == ExrContent::lat_long_environment) Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
    for (const ExrText& text : facts.texts) header.insert(text.name, Imf::StringAttribute(text.value));
    if (facts.white_luminance_cd_m2)
      Imf::addWhiteLuminance(header, static_cast<float>(*facts.white_luminance_cd_m2));
    if (facts.exposure_s) Imf::addExpTime(header, static_cast<float>(*facts.exposure_s));
    if (const auto& t = facts.timecode)
      Imf::addTimeCode(header, Imf::TimeCode(t->hours, t->minutes, t->seconds, t->frames, t->drop_frame));
    Imf::FrameBuffer frame;
    const std::size_t stride = channels.size() * sizeof(float);
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const std::string name(1, channels[c]);
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      frame.insert(name, Imf::Slice::Make(Imf::FLOAT, &pixels[c], Imath::V2i(0, 0), width, height, stride,
                                          stride * static_cast<std::size_t>(width)));
    }
    MemoryOutput memory;
    {
      Imf::OutputFile file(memory, header, kNoThreads);
      file.setFrameBuffer(frame);
      file.writePixels(height);
    }  // its destructor writes the offsets
    return memory.take();
  } catch (const std::exception& error) {
    return Error{ErrorKind::failed, "cannot encode as EXR: " + first_line(error.what())};
  }
}

Result<std::optional<std::string>> exr_text(std::string_view bytes, const std::string& attribute,
                                            const std::string& name) {
  if (!is_exr(bytes)) return bad(name, "is no EXR file");
  if (!attributes_fit(bytes)) return bad(name, "truncated or damaged EXR header");
  try {
    MemoryInput memory(bytes, name);
    constexpr bool kRepairOffsets = false;
    Imf::MultiPartInputFile file(memory, kNoThreads, kRepairOffsets);
    const auto* text = file.header(0).findTypedAttribute<Imf::StringAttribute>(attribute);
    return text == nullptr ? std::nullopt : std::optional(text->value());
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return bad(name, "truncated or damaged image data");
  }
}

}  // namespace lightwell
