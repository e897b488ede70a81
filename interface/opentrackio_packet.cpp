// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/opentrackio_packet.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "interface/cbor_shape.h"

namespace lightwell {
namespace {

using nlohmann::json;

constexpr std::size_t kHeader = 16;
constexpr std::size_t kLongestSample = std::size_t{1} << 20;
constexpr std::uint8_t kJson = 1;
constexpr std::uint8_t kCbor = 2;
constexpr std::size_t kDeepest = 32;  // of CBOR, whose reader recurs; samples need six

Error bad(const std::string& what) {
  return {ErrorKind::bad_input, "OpenTrackIO: " + what};
}

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

// The object or number at a key, nullptr where it is absent.
Result<const json*> member(const json& object, const char* key, bool number) {
  const auto found = object.find(key);
  if (found == object.end() || found->is_null()) return static_cast<const json*>(nullptr);
  if (number ? !found->is_number() : !found->is_object())
    return bad(std::string(key) + (number ? ": not a number" : ": not an object"));
  return &*found;
}

Result<std::optional<double>> number(const json& object, const char* key, double low, double high) {
  const auto found = member(object, key, true);
  if (!found) return found.error();
  if (*found == nullptr) return std::optional<double>();
  const double value = (*found)->get<double>();
  if (!(value >= low && value <= high))
    return bad(std::string(key) + ": value " + std::to_string(value) + ", allowed " + std::to_string(low) +
               " to " + std::to_string(high));
  return std::optional<double>(value);
}

// Three numbers of an object that may be absent; those that are missing in one that is there are an error.
Result<Vec3d> triple(const json& object, const char* key, const char* const (&names)[3], double limit,
                     double absent) {
  const auto found = member(object, key, false);
  if (!found) return found.error();
  Vec3d values = Vec3d::Constant(absent);
  if (*found == nullptr) return values;
  for (int i = 0; i < 3; ++i) {
    const auto value = number(**found, names[i], -limit, limit);
    if (!value) return value.error();
    if (!*value) return bad(std::string(key) + ": " + names[i] + " is missing");
    values[i] = **value;
  }
  return values;
}

constexpr const char* kXyz[3] = {"x", "y", "z"};
constexpr const char* kAngles[3] = {"pan", "tilt", "roll"};
constexpr double kMostDegrees = 1e6;  // angles may go round any number of times
constexpr double kMostScale = 1e3;

Status compose(const json& transforms, TrackedCamera& camera) {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  for (const json& transform : transforms) {
    if (!transform.is_object()) return bad("transforms: not a list of objects");
    const auto translation = triple(transform, "translation", kXyz, kFarthestTracked_m, 0);
    if (!translation) return translation.error();
    const auto angles = triple(transform, "rotation", kAngles, kMostDegrees, 0);
    if (!angles) return angles.error();
    const auto own_scale = triple(transform, "scale", kXyz, kMostScale, 1);
    if (!own_scale) return own_scale.error();
    const Eigen::Matrix3d rotation = rotation_from_pan_tilt_roll((*angles)[0], (*angles)[1], (*angles)[2]);
    camera.position_m += linear * *translation;
    camera.stage_from_camera *= rotation;
    linear *= rotation * own_scale->asDiagonal();
  }
  if (!camera.position_m.allFinite() || camera.position_m.cwiseAbs().maxCoeff() > kFarthestTracked_m)
    return bad("transforms: the camera is more than 1e6 m away");
  return {};
}

// What is at a path of objects, nullptr where something of it is absent.
Result<const json*> object_at(const json& root, std::initializer_list<const char*> path) {
  const json* at = &root;
  for (const char* key : path) {
    const auto next = member(*at, key, false);
    if (!next) return next.error();
    if (*next == nullptr) return *next;
    at = *next;
  }
  return at;
}

Result<std::optional<double>> number_at(const json& root, std::initializer_list<const char*> path,
                                        const char* key, double low, double high) {
  const auto object = object_at(root, path);
  if (!object) return object.error();
  if (*object == nullptr) return std::optional<double>();
  return number(**object, key, low, high);
}

// timing.sampleTimestamp: seconds and nanoseconds of the tracker's own clock.
Result<std::optional<std::int64_t>> sampled_ns(const json& root) {
  constexpr double kMostSeconds = 9e9;  // what nanoseconds of 64 bits hold
  const auto seconds = number_at(root, {"timing", "sampleTimestamp"}, "seconds", 0, kMostSeconds);
  if (!seconds) return seconds.error();
  const auto ns = number_at(root, {"timing", "sampleTimestamp"}, "nanoseconds", 0, 999'999'999);
  if (!ns) return ns.error();
  if (!*seconds || !*ns) return std::optional<std::int64_t>();
  return std::optional(static_cast<std::int64_t>(**seconds) * 1'000'000'000 +
                       static_cast<std::int64_t>(**ns));
}

struct Sample {
  bool has_pose = false;
  TrackedCamera camera;
};

Result<Sample> read_sample(const json& root) {
  if (!root.is_object()) return bad("the sample is no object");
  Sample sample;
  // Others are reserved, and to be discarded.
  const auto source = number(root, "sourceNumber", 1, 200);
  if (!source) return source.error();
  if (*source) sample.camera.number = static_cast<int>(**source);
  const auto focal = number_at(root, {"lens"}, "pinholeFocalLength", 0.1, 1e5);
  if (!focal) return focal.error();
  sample.camera.focal_length_mm = *focal;
  const auto height =
      number_at(root, {"static", "camera", "activeSensorPhysicalDimensions"}, "height", 0.01, 1e4);
  if (!height) return height.error();
  sample.camera.sensor_height_mm = *height;
  const auto sampled = sampled_ns(root);
  if (!sampled) return sampled.error();
  sample.camera.sampled_ns = *sampled;
  const auto transforms = root.find("transforms");
  if (transforms == root.end()) return sample;
  if (!transforms->is_array() || transforms->empty()) return bad("transforms: not a list of objects");
  if (Status s = compose(*transforms, sample.camera); !s) return s.error();
  sample.has_pose = true;
  return sample;
}

// The library recurs with what it reads, within strings before any limit could stop it.
json parse_cbor(const std::string& payload) {
  const std::vector<std::uint8_t> bytes(payload.begin(), payload.end());
  if (!is_shallow_cbor(bytes, kDeepest)) return json(json::value_t::discarded);
  return json::from_cbor(bytes, true, false);
}

Result<Sample> decode(const std::string& payload, std::uint8_t encoding) {
  const json root = encoding == kCbor ? parse_cbor(payload) : json::parse(payload, nullptr, false);
  if (root.is_discarded()) return bad(encoding == kCbor ? "not CBOR" : "not JSON");
  return read_sample(root);
}

}  // namespace

std::uint16_t fletcher16(std::span<const std::uint8_t> bytes, std::uint16_t start) {
  auto low = static_cast<std::uint8_t>(start & 255);
  auto high = static_cast<std::uint8_t>(start >> 8);
  for (const std::uint8_t byte : bytes) {
    low = static_cast<std::uint8_t>(low + byte);
    high = static_cast<std::uint8_t>(high + low);
  }
  return static_cast<std::uint16_t>(high << 8 | low);
}

std::vector<std::uint8_t> opentrackio_datagram(const TrackedCamera& camera, std::uint16_t sequence) {
  const PanTiltRoll turn = pan_tilt_roll_from(camera.stage_from_camera);
  const Vec3d& at = camera.position_m;
  json sample = {
      {"protocol", {{"name", "OpenTrackIO"}, {"version", {1, 0, 0}}}},
      {"sourceNumber", 1},
      {"transforms",
       {{{"id", "Probe"},
         {"translation", {{"x", at.x()}, {"y", at.y()}, {"z", at.z()}}},
         {"rotation", {{"pan", turn.pan_deg}, {"tilt", turn.tilt_deg}, {"roll", turn.roll_deg}}}}}}};
  if (camera.sampled_ns)
    sample["timing"]["sampleTimestamp"] = {{"seconds", *camera.sampled_ns / 1'000'000'000},
                                           {"nanoseconds", *camera.sampled_ns % 1'000'000'000}};
  const std::string payload = sample.dump();
  std::vector<std::uint8_t> bytes = {'O', 'T', 'r', 'k', 0, kJson};
  const auto put_16 = [&bytes](std::size_t value) {
    bytes.push_back(static_cast<std::uint8_t>(value >> 8 & 255));
    bytes.push_back(static_cast<std::uint8_t>(value & 255));
  };
  put_16(sequence);
  put_16(0);  // the segment's offset, 32 bits
  put_16(0);
  put_16(payload.size() | 0x8000u);  // the last segment
  const std::vector<std::uint8_t> body(payload.begin(), payload.end());
  put_16(fletcher16(body, fletcher16(bytes)));
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

Result<std::optional<TrackedCamera>> OpenTrackIoReader::fail(const std::string& what) {
  payload_.clear();
  return bad(what);
}

Result<std::optional<TrackedCamera>> OpenTrackIoReader::take(std::span<const std::uint8_t> datagram) {
  const std::string text(datagram.begin(), datagram.end());
  if (text.starts_with('{')) {
    payload_ = text;
    encoding_ = kJson;
  } else {
    if (datagram.size() < kHeader || !text.starts_with("OTrk")) return fail("no OTrk header");
    const std::size_t length = big_endian(datagram.subspan(12, 2)) & 0x7FFF;
    if (datagram.size() != kHeader + length) return fail("truncated datagram");
    const std::uint16_t sum = fletcher16(datagram.subspan(kHeader), fletcher16(datagram.first(14)));
    if (sum != big_endian(datagram.subspan(14, 2))) return fail("wrong checksum");
    const std::uint8_t encoding = datagram[5];
    if (encoding != kJson && encoding != kCbor)
      return fail("encoding " + std::to_string(encoding) + ", only 1 (JSON) and 2 (CBOR) are read");
    const std::size_t offset = big_endian(datagram.subspan(8, 4));
    if (offset == 0) payload_.clear();
    if (offset != payload_.size()) return fail("a segment is missing");
    if (offset > 0 && encoding != encoding_) return fail("segments of two encodings");
    encoding_ = encoding;
    if (payload_.size() + length > kLongestSample) return fail("a sample of more than 1 MiB");
    payload_.append(text, kHeader);
    const bool last = (datagram[12] & 0x80) != 0;
    if (!last) return std::optional<TrackedCamera>();
  }
  auto sample = decode(payload_, encoding_);
  payload_.clear();
  if (!sample) return sample.error();
  if (sample->camera.sensor_height_mm) sensor_height_mm_ = sample->camera.sensor_height_mm;
  if (!sample->has_pose) return std::optional<TrackedCamera>();
  sample->camera.sensor_height_mm = sensor_height_mm_;
  return std::optional<TrackedCamera>(sample->camera);
}

}  // namespace lightwell
