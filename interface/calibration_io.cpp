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
#include "interface/flat_field_json.h"
#include "interface/json_fields.h"
#include "interface/lens_json.h"
#include "interface/response_json.h"

namespace lightwell {
namespace {

using nlohmann::json;

constexpr const char* kCalibrationSchema = "lightwell.calibration/1";

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
  return {response_from_json(fields), colour_matrix_from(fields, root)};
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

void add(Digest& digest, const LogResponse& m) {
  for (const double v : {m.a, m.b, m.c}) digest.add(v);
}
void add(Digest& digest, const LinearResponse& m) {
  for (const double v : {m.black, m.gain}) digest.add(v);
}
void add(Digest& digest, const LinLogResponse& m) {
  for (const double v : {m.black, m.gain, m.knee_cd_m2}) digest.add(v);
}
void add(Digest& digest, const PiecewiseLinearResponse& m) {
  for (const auto& point : m.points) {
    digest.add(point.luminance_cd_m2);
    digest.add(point.code);
  }
}

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
      *text, file.string(), [&](const json& root) { return lens_from_json(JsonFields(root, file.string())); },
      [](const Lens& lens) { return check(lens); });
}

Result<FlatField> read_flat_field(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  // Whether it fits the lens is known to read_calibration alone.
  return from_text(
      *text, file.string(),
      [&](const json& root) { return flat_field_from_json(JsonFields(root, file.string())); },
      [](const FlatField&) { return Status(); });
}

Result<std::vector<FlatAtTemperature>> flats_by_temperature(const std::filesystem::path& directory) {
  std::vector<FlatAtTemperature> flats;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(directory, failed)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("flat", 0) != 0 || entry.path().extension() != ".json") continue;
    const auto text = read_text_file(entry.path());
    if (!text) return text.error();
    const auto root = parse_json(*text, entry.path().string());
    if (!root) return root.error();
    if (!root->is_object())
      return Error{ErrorKind::bad_input,
                   entry.path().string() + ": not a JSON object, as a fixed pattern is"};
    const json fit = root->value("fit", json::object());
    if (!fit.is_object()) continue;
    for (const char* key : {"dark_temperature_c", "temperature_c"}) {
      const auto found = fit.find(key);
      if (found == fit.end() || !found->is_number()) continue;
      flats.push_back({found->get<double>(), entry.path()});
      break;
    }
  }
  if (failed) return Error{ErrorKind::bad_input, directory.string() + ": " + failed.message()};
  std::sort(flats.begin(), flats.end(),
            [](const auto& a, const auto& b) { return a.temperature_c < b.temperature_c; });
  for (std::size_t i = 1; i < flats.size(); ++i)
    if (flats[i].temperature_c - flats[i - 1].temperature_c < 0.1)
      return Error{ErrorKind::bad_input, flats[i].file.string() + " and " +
                                             flats[i - 1].file.filename().string() +
                                             ": taken at the same temperature; keep one"};
  return flats;
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
  json response = response_to_json(calibration.response, true);
  add_colour_matrix(response, calibration.rec709_from_camera);
  // What a calibration may lack comes first: whoever waits for lens.json finds the folder whole.
  const std::pair<const char*, json> files[] = {{"flat.json", flat_field_to_json(calibration.flat)},
                                                {"response.json", std::move(response)},
                                                {"lens.json", lens_to_json(calibration.lens)}};
  for (const auto& [name, content] : files)
    if (Status status = write_file_atomically(directory / name, content.dump() + "\n"); !status)
      return status;
  return {};
}

std::string calibration_to_json(const Calibration& calibration) {
  json response = response_to_json(calibration.response, false);
  add_colour_matrix(response, calibration.rec709_from_camera);
  const json out = {{"schema", kCalibrationSchema},
                    {"id", calibration_id(calibration)},
                    {"response", std::move(response)},
                    {"lens", lens_to_json(calibration.lens)},
                    {"flat", flat_field_to_json(calibration.flat)}};
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
    calibration.lens = lens_from_json(fields.object("lens"));
    calibration.flat = flat_field_from_json(fields.object("flat"));
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
  std::visit([&](const auto& model) { add(digest, model); }, r.model);
  for (const double v : {static_cast<double>(r.bits), r.black_code, r.clip_code, r.reference_exposure_us})
    digest.add(v);
  const Lens& lens = calibration.lens;
  for (const int v : lens.image_size) digest.add(v);
  for (const double v : {lens.focal.x(), lens.focal.y(), lens.center.x(), lens.center.y()}) digest.add(v);
  for (const double v : lens.k) digest.add(v);
  // Degrees to radians and back is not always exact: equal to 1e-9 degrees is equal.
  digest.add(std::round(lens.max_theta_rad * 180 / kPi * 1e9));
  if (lens.zenith != Vec3d::UnitZ())  // ids from before it was known stay
    for (Eigen::Index i = 0; i < 3; ++i) digest.add(lens.zenith[i]);
  for (const double v : calibration.flat.vignetting) digest.add(v);
  // As a file holds them, so that what was written and read back is the same calibration.
  for (const float v : as_stored(calibration.flat.offset_codes)) digest.add(static_cast<double>(v));
  for (const float v : as_stored(calibration.flat.gain)) digest.add(static_cast<double>(v));
  for (Eigen::Index i = 0; i < 9; ++i) digest.add(calibration.rec709_from_camera(i / 3, i % 3));
  return digest.hex();
}

}  // namespace lightwell
