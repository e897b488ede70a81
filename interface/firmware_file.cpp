// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/firmware_file.h"

#include <algorithm>
#include <span>

#include "interface/atomic_file.h"
#include "interface/base64.h"
#include "interface/json_fields.h"

namespace lightwell {
namespace {

constexpr const char* kSchema = "lightwell.firmware/1";
constexpr std::size_t kMostBytes = 1U << 20;  // all of the chip's flash

std::string encoded(std::span<const std::uint8_t> bytes) {
  return base64_encode(std::as_bytes(bytes));
}

std::vector<std::uint8_t> decoded(const JsonFields& fields, const char* key) {
  const auto bytes = base64_decode(fields.text(key));
  if (!bytes) fields.fail(key, "base64");
  std::vector<std::uint8_t> result(bytes->size());
  std::transform(bytes->begin(), bytes->end(), result.begin(),
                 [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  return result;
}

FirmwareFile from_fields(const JsonFields& fields) {
  fields.require_schema(kSchema);
  FirmwareFile firmware;
  firmware.board = fields.text("board");
  std::array<double, 3> version{};
  fields.numbers("version", version, 0, 255);
  std::transform(version.begin(), version.end(), firmware.version.begin(),
                 [](double part) { return static_cast<std::uint8_t>(part); });
  for (const JsonFields& image : fields.objects("images")) {
    FirmwareImage read;
    read.slot = static_cast<std::uint8_t>(image.integer("slot", 0, 1));
    read.bytes = decoded(image, "bytes");
    if (read.bytes.empty() || read.bytes.size() > kMostBytes) image.fail("bytes", "1 to 1048576 bytes");
    const auto signature = decoded(image, "signature");
    if (signature.size() != read.signature.size()) image.fail("signature", "64 bytes");
    std::copy(signature.begin(), signature.end(), read.signature.begin());
    for (const FirmwareImage& other : firmware.images)
      if (other.slot == read.slot) image.fail("slot", "each slot once");
    firmware.images.push_back(std::move(read));
  }
  if (firmware.images.empty()) fields.fail("images", "one image or two");
  return firmware;
}

}  // namespace

Result<FirmwareFile> read_firmware_file(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  const auto root = parse_json(*text, file.string());
  if (!root) return root.error();
  try {
    return from_fields(JsonFields(*root, file.string()));
  } catch (const FieldFailure& failure) {
    return failure.error;
  }
}

Status write_firmware_file(const std::filesystem::path& file, const FirmwareFile& firmware) {
  nlohmann::ordered_json images = nlohmann::ordered_json::array();
  for (const FirmwareImage& image : firmware.images)
    images.push_back(
        {{"slot", image.slot}, {"signature", encoded(image.signature)}, {"bytes", encoded(image.bytes)}});
  const nlohmann::ordered_json root = {
      {"schema", kSchema}, {"board", firmware.board}, {"version", firmware.version}, {"images", images}};
  return write_file_atomically(file, root.dump() + "\n");
}

}  // namespace lightwell
