// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/calibration_io.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "interface/atomic_file.h"
#include "interface/base64.h"
#include "interface/json_fields.h"

namespace lightwell {
namespace {

using nlohmann::json;

constexpr const char* kResponseSchema = "lightwell.response/1";
constexpr const char* kLensSchema = "lightwell.lens/1";
constexpr const char* kFlatSchema = "lightwell.flat/1";
constexpr const char* kCalibrationSchema = "lightwell.calibration/1";
constexpr double kDegreesPerRadian = 180 / kPi;

// ---- response.json ----

json table_of(const Response& response) {
  json code = json::array();
  json luminance = json::array();
  const int last = static_cast<int>(std::floor(response.clip_code));
  for (int c = static_cast<int>(std::ceil(response.black_code)); c <= last; ++c) {
    code.push_back(c);
    luminance.push_back(response.luminance_cd_m2(c));
  }
  return {{"code", std::move(code)}, {"luminance_cd_m2", std::move(luminance)}};
}

json json_from(const Response& response, bool with_table) {
  json out = {{"schema", kResponseSchema},
              {"bits", response.bits},
              {"black_code", response.black_code},
              {"clip_code", response.clip_code},
              {"reference_exposure_us", response.reference_exposure_us}};
  if (const auto* log = std::get_if<LogResponse>(&response.model)) {
    out["model"] = "log";
    out["parameters"] = {{"a", log->a}, {"b", log->b}, {"c", log->c}};
  } else if (const auto* linear = std::get_if<LinearResponse>(&response.model)) {
    out["model"] = "linear";
    out["parameters"] = {{"black", linear->black}, {"gain", linear->gain}};
  }
  if (with_table) out["table"] = table_of(response);
  return out;
}

void check_table(const JsonFields& table) {
  const std::vector<double> code = table.number_list("code");
  const std::vector<double> luminance = table.number_list("luminance_cd_m2");
  if (code.size() != luminance.size())
    table.fail("luminance_cd_m2", "has " + std::to_string(luminance.size()) + " values, code has " +
                                      std::to_string(code.size()) + ": allowed equal numbers");
  for (std::size_t i = 1; i < code.size(); ++i) {
    if (!(code[i] > code[i - 1])) table.fail("code[" + std::to_string(i) + "]", "does not increase");
    if (!(luminance[i] > luminance[i - 1]))
      table.fail("luminance_cd_m2[" + std::to_string(i) + "]", "does not increase");
  }
}

Response response_from(const JsonFields& fields) {
  fields.require_schema(kResponseSchema);
  Response response;
  const std::string model = fields.text("model");
  const JsonFields parameters = fields.object("parameters");
  if (model == "log") {
    response.model = LogResponse{parameters.number("a"), parameters.number("b"), parameters.number("c")};
  } else if (model == "linear") {
    response.model = LinearResponse{parameters.number("black"), parameters.number("gain")};
  } else {
    fields.fail("model", "= \"" + model.substr(0, 40) + "\": allowed log, linear");
  }
  response.bits = fields.integer("bits", 1, 16);
  response.black_code = fields.number("black_code");
  response.clip_code = fields.number("clip_code");
  response.reference_exposure_us = fields.number("reference_exposure_us");
  if (fields.has("table")) check_table(fields.object("table"));
  return response;
}

// The colour matrix stands in response.json, because it belongs to the sensor too; a monochrome camera has
// none.
void add_colour(json& out, const Eigen::Matrix3d& m) {
  if (m.isIdentity(0)) return;
  json rows = json::array();
  for (Eigen::Index r = 0; r < 3; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2)});
  out["rec709_from_camera"] = std::move(rows);
}

Eigen::Matrix3d colour_from(const JsonFields& fields, const json& object) {
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
  if (!fields.has("rec709_from_camera")) return m;
  const json& rows = object.at("rec709_from_camera");
  const auto bad = [&] { fields.fail("rec709_from_camera", "is not 3 rows of 3 finite numbers"); };
  if (!rows.is_array() || rows.size() != 3) bad();
  for (std::size_t r = 0; r < 3; ++r) {
    if (!rows[r].is_array() || rows[r].size() != 3) bad();
    for (std::size_t c = 0; c < 3; ++c) {
      if (!rows[r][c].is_number() || !(std::abs(rows[r][c].get<double>()) <= 1e3)) bad();
      m(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[r][c].get<double>();
    }
  }
  return m;
}

// ---- lens.json ----

json json_from(const Lens& lens) {
  return {{"schema", kLensSchema},
          {"model", "kannala-brandt"},
          {"image_size", lens.image_size},
          {"focal", {lens.focal.x(), lens.focal.y()}},
          {"center", {lens.center.x(), lens.center.y()}},
          {"k", lens.k},
          {"max_theta_deg", lens.max_theta_rad * kDegreesPerRadian}};
}

Lens lens_from(const JsonFields& fields) {
  fields.require_schema(kLensSchema);
  Lens lens;
  std::array<double, 2> size{};
  fields.numbers("image_size", size);
  for (std::size_t i = 0; i < 2; ++i) {
    if (size[i] != std::floor(size[i]) || size[i] < 1 || size[i] > 16384)
      fields.fail("image_size[" + std::to_string(i) + "]",
                  "= " + std::to_string(size[i]) + ": allowed a whole number from 1 to 16384");
    lens.image_size[i] = static_cast<int>(size[i]);
  }
  fields.numbers("focal", {lens.focal.data(), 2});
  fields.numbers("center", {lens.center.data(), 2});
  fields.numbers("k", lens.k);
  const double degrees = fields.number("max_theta_deg");
  if (!(degrees > 0 && degrees <= 180))
    fields.fail("max_theta_deg", "= " + std::to_string(degrees) + ": allowed above 0, at most 180");
  lens.max_theta_rad = std::min(degrees / kDegreesPerRadian, kPi);
  return lens;
}

// ---- flat.json ----

// Offsets are stored as 16 bit integers times a power of two: exact for what has been read back once, within
// 1/65536 of the largest offset for what has not.
struct PackedOffsets {
  double scale = 1;
  std::vector<std::int16_t> values;
};

PackedOffsets pack(const std::vector<float>& offsets) {
  float largest = 0;
  for (const float o : offsets) largest = std::max(largest, std::abs(o));
  PackedOffsets packed;
  if (largest > 0) packed.scale = std::ldexp(1.0, std::ilogb(largest) - 14);  // largest / scale in [2¹⁴, 2¹⁵)
  // Rounding may reach 2¹⁵ itself, which does not fit.
  if (std::round(static_cast<double>(largest) / packed.scale) > 32767) packed.scale *= 2;
  packed.values.reserve(offsets.size());
  for (const float o : offsets)
    packed.values.push_back(static_cast<std::int16_t>(std::round(static_cast<double>(o) / packed.scale)));
  return packed;
}

float unpack(std::int16_t value, double scale) {
  return static_cast<float>(value * scale);
}

json json_from(const FlatField& flat) {
  json out = {{"schema", kFlatSchema}, {"image_size", flat.image_size}, {"vignetting", flat.vignetting}};
  if (flat.offset_codes.empty()) return out;
  const PackedOffsets packed = pack(flat.offset_codes);
  std::vector<std::byte> bytes;
  bytes.reserve(packed.values.size() * 2);
  for (const std::int16_t v : packed.values) {
    const auto u = static_cast<std::uint16_t>(v);
    bytes.push_back(static_cast<std::byte>(u & 255));
    bytes.push_back(static_cast<std::byte>(u >> 8));
  }
  out["offset_codes"] = {
      {"encoding", "int16le-base64"}, {"scale", packed.scale}, {"data", base64_encode(bytes)}};
  return out;
}

std::vector<float> offsets_from(const JsonFields& fields, std::size_t pixels) {
  if (fields.text("encoding") != "int16le-base64")
    fields.fail("encoding", "is unknown: allowed \"int16le-base64\"");
  const double scale = fields.number("scale");
  if (!(scale > 0 && scale <= 4))
    fields.fail("scale", "= " + std::to_string(scale) + ": allowed above 0, at most 4");
  const auto bytes = base64_decode(fields.text("data"));
  if (!bytes) fields.fail("data", "is not base64");
  if (bytes->size() != 2 * pixels)
    fields.fail("data", "holds " + std::to_string(bytes->size()) +
                            " bytes: allowed 2 a pixel of image_size, " + std::to_string(2 * pixels));
  std::vector<float> offsets(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto u = std::to_integer<std::uint16_t>((*bytes)[2 * i]) |
                   std::to_integer<std::uint16_t>((*bytes)[2 * i + 1]) << 8;
    offsets[i] = unpack(static_cast<std::int16_t>(u), scale);
  }
  return offsets;
}

FlatField flat_from(const JsonFields& fields) {
  fields.require_schema(kFlatSchema);
  FlatField flat;
  std::array<double, 2> size{};
  fields.numbers("image_size", size);
  for (std::size_t i = 0; i < 2; ++i) {
    if (size[i] != std::floor(size[i]) || size[i] < 0 || size[i] > 16384)
      fields.fail("image_size[" + std::to_string(i) + "]",
                  "= " + std::to_string(size[i]) + ": allowed a whole number from 0 to 16384");
    flat.image_size[i] = static_cast<int>(size[i]);
  }
  fields.numbers("vignetting", flat.vignetting);
  if (fields.has("offset_codes"))
    flat.offset_codes =
        offsets_from(fields.object("offset_codes"), static_cast<std::size_t>(flat.image_size[0]) *
                                                        static_cast<std::size_t>(flat.image_size[1]));
  return flat;
}

// ---- files ----

Error in_file(const std::string& file, const Error& error) {
  return {error.kind, file + ": " + error.message};
}

// Parses, reads fields by `read`, then checks the value as a whole by `verify`.
template <class Read, class Verify>
auto from_text(const std::string& text, const std::string& file, Read read, Verify verify)
    -> Result<decltype(read(std::declval<const json&>()))> {
  const auto parsed = parse_json(text, file);
  if (!parsed) return parsed.error();
  try {
    auto value = read(*parsed);
    if (const Status status = verify(value); !status) return in_file(file, status.error());
    return value;
  } catch (const FieldFailure& failure) {
    return failure.error;
  }
}

struct SensorFile {
  Response response;
  Eigen::Matrix3d rec709_from_camera;
};

SensorFile sensor_from(const json& root, const std::string& file, const std::string& path = "") {
  const JsonFields fields(root, file, path);
  return {response_from(fields), colour_from(fields, root)};
}

Result<SensorFile> read_sensor(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return from_text(
      *text, file.string(), [&](const json& root) { return sensor_from(root, file.string()); },
      [](const SensorFile& s) { return check(s.response); });
}

Status check_all(const Calibration& calibration) {
  if (Status s = check(calibration.response); !s) return s;
  if (Status s = check(calibration.lens); !s) return s;
  return check(calibration.flat, calibration.lens);
}

// FNV-1a, 64 bit: short, fixed forever, the same on every machine.
class Digest {
 public:
  void add(double value) {
    std::uint64_t bits = std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value);  // −0 is 0
    for (int i = 0; i < 8; ++i, bits >>= 8) hash_ = (hash_ ^ (bits & 255)) * 0x100000001b3u;
  }
  [[nodiscard]] std::string hex() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash_));
    return text;
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace

Result<Response> read_response(const std::filesystem::path& file) {
  const auto sensor = read_sensor(file);
  if (!sensor) return sensor.error();
  return sensor->response;
}

Result<Lens> read_lens(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return from_text(
      *text, file.string(), [&](const json& root) { return lens_from(JsonFields(root, file.string())); },
      [](const Lens& lens) { return check(lens); });
}

Result<FlatField> read_flat_field(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  // Whether it fits the lens is known to read_calibration alone.
  return from_text(
      *text, file.string(), [&](const json& root) { return flat_from(JsonFields(root, file.string())); },
      [](const FlatField&) { return Status(); });
}

Result<Calibration> read_calibration(const std::filesystem::path& directory) {
  const auto sensor = read_sensor(directory / "response.json");
  if (!sensor) return sensor.error();
  auto lens = read_lens(directory / "lens.json");
  if (!lens) return lens.error();
  Calibration calibration;
  calibration.response = sensor->response;
  calibration.rec709_from_camera = sensor->rec709_from_camera;
  calibration.lens = *lens;
  const auto flat_file = directory / "flat.json";
  // Only what is not there may be absent: a file that cannot be read, or a link to nowhere, is an error.
  std::error_code ignored;
  if (std::filesystem::symlink_status(flat_file, ignored).type() != std::filesystem::file_type::not_found) {
    auto flat = read_flat_field(flat_file);
    if (!flat) return flat.error();
    calibration.flat = *std::move(flat);
    if (const Status status = check(calibration.flat, calibration.lens); !status)
      return in_file(flat_file.string(), status.error());
  }
  calibration.id = calibration_id(calibration);
  return calibration;
}

Status write_calibration(const std::filesystem::path& directory, const Calibration& calibration) {
  if (const Status status = check_all(calibration); !status) return status;
  std::error_code error;
  std::filesystem::create_directory(directory, error);
  if (error)
    return Error{ErrorKind::failed, directory.string() + ": cannot make the folder: " + error.message()};
  json response = json_from(calibration.response, true);
  add_colour(response, calibration.rec709_from_camera);
  const std::pair<const char*, json> files[] = {{"response.json", std::move(response)},
                                                {"lens.json", json_from(calibration.lens)},
                                                {"flat.json", json_from(calibration.flat)}};
  for (const auto& [name, content] : files)
    if (Status status = write_file_atomically(directory / name, content.dump() + "\n"); !status)
      return status;
  return {};
}

std::string calibration_to_json(const Calibration& calibration) {
  json response = json_from(calibration.response, false);
  add_colour(response, calibration.rec709_from_camera);
  const json out = {{"schema", kCalibrationSchema},
                    {"id", calibration_id(calibration)},
                    {"response", std::move(response)},
                    {"lens", json_from(calibration.lens)},
                    {"flat", json_from(calibration.flat)}};
  return out.dump();
}

Result<Calibration> calibration_from_json(const std::string& text, const std::string& name_for_errors) {
  const auto read = [&](const json& root) {
    const JsonFields fields(root, name_for_errors);
    fields.require_schema(kCalibrationSchema);
    (void)fields.object("response");  // present, an object: what follows may look inside
    SensorFile sensor = sensor_from(root.at("response"), name_for_errors, "response");
    Calibration calibration;
    calibration.response = sensor.response;
    calibration.rec709_from_camera = sensor.rec709_from_camera;
    calibration.lens = lens_from(fields.object("lens"));
    calibration.flat = flat_from(fields.object("flat"));
    return calibration;
  };
  auto calibration = from_text(text, name_for_errors, read, check_all);
  if (calibration) calibration->id = calibration_id(*calibration);
  return calibration;
}

std::string calibration_id(const Calibration& calibration) {
  Digest digest;
  const Response& r = calibration.response;
  digest.add(static_cast<double>(r.model.index()));
  if (const auto* log = std::get_if<LogResponse>(&r.model))
    for (const double v : {log->a, log->b, log->c}) digest.add(v);
  if (const auto* linear = std::get_if<LinearResponse>(&r.model))
    for (const double v : {linear->black, linear->gain}) digest.add(v);
  for (const double v : {static_cast<double>(r.bits), r.black_code, r.clip_code, r.reference_exposure_us})
    digest.add(v);
  const Lens& lens = calibration.lens;
  for (const int v : lens.image_size) digest.add(v);
  for (const double v : {lens.focal.x(), lens.focal.y(), lens.center.x(), lens.center.y()}) digest.add(v);
  for (const double v : lens.k) digest.add(v);
  // Degrees to radians and back is not always exact: equal to 1e-9 degrees is equal.
  digest.add(std::round(lens.max_theta_rad * kDegreesPerRadian * 1e9));
  for (const double v : calibration.flat.vignetting) digest.add(v);
  // As a file holds them, so that what was written and read back is the same calibration.
  const PackedOffsets packed = pack(calibration.flat.offset_codes);
  for (const std::int16_t v : packed.values) digest.add(static_cast<double>(unpack(v, packed.scale)));
  for (Eigen::Index i = 0; i < 9; ++i) digest.add(calibration.rec709_from_camera(i / 3, i % 3));
  return digest.hex();
}

}  // namespace lightwell
