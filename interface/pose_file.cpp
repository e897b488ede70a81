// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/pose_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

#include "interface/atomic_file.h"
#include "interface/csv_table.h"
#include "interface/tracker_clock.h"

namespace lightwell {
namespace {

constexpr double kFarthest_m = 1e5;
constexpr double kMostTime_ns = 9.2e18;  // 64 bits hold a little more
constexpr const char* kTimes = "a whole number from 0 to 9200000000000000000 nanoseconds";
constexpr std::array<const char*, 4> kTurn = {"qx", "qy", "qz", "qw"};
constexpr double kUnitWithin = 0.01;  // of a quaternion's length: rounded to three digits it still is one

// Exactly: a double would lose nanoseconds after a hundred days.
Result<std::int64_t> nanoseconds(const CsvTable& table, std::size_t row, std::string_view column) {
  if (const auto number = table.number(row, column, 0, kMostTime_ns, kTimes); !number) return number.error();
  const std::string text = table.text(row, column);
  std::int64_t value = 0;
  const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc() || stop != text.data() + text.size())
    return Error{ErrorKind::bad_input, table.place(row) + ": " + std::string(column) + " = " +
                                           text.substr(0, 40) + ": allowed " + kTimes};
  return value;
}

Result<Vec3d> position(const CsvTable& table, std::size_t row) {
  Vec3d at;
  for (int axis = 0; axis < 3; ++axis) {
    const auto value = table.number(row, std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1),
                                    -kFarthest_m, kFarthest_m, "-100000 to 100000 metres");
    if (!value) return value.error();
    at[axis] = *value;
  }
  return at;
}

Result<Eigen::Quaterniond> turn(const CsvTable& table, std::size_t row) {
  Eigen::Vector4d q;
  for (int i = 0; i < 4; ++i) {
    const auto value =
        table.number(row, kTurn[static_cast<std::size_t>(i)], -1 - kUnitWithin, 1 + kUnitWithin, "-1 to 1");
    if (!value) return value.error();
    q[i] = *value;
  }
  if (!(std::abs(q.norm() - 1) <= kUnitWithin))
    return Error{ErrorKind::bad_input, table.place(row) + ": (qx, qy, qz, qw) has the length " +
                                           std::to_string(q.norm()) + ": allowed 0.99 to 1.01"};
  return Eigen::Quaterniond(q.normalized());  // x, y, z, w
}

// Whether the columns of a turn are there; all or none.
Result<bool> has_turns(const CsvTable& table) {
  if (std::none_of(kTurn.begin(), kTurn.end(), [&](const char* column) { return table.has(column); }))
    return false;
  if (const Status all = table.require({"qx", "qy", "qz", "qw"}); !all) return all.error();
  return true;
}

Error not_rising(const CsvTable& table, std::size_t row, std::int64_t value, std::int64_t before) {
  return {ErrorKind::bad_input, table.place(row) + ": time_ns = " + std::to_string(value) +
                                    ": allowed above " + std::to_string(before) +
                                    ", that of the line before"};
}

void use_tracker_clock(PoseFile& file, const std::vector<std::int64_t>& samples) {
  constexpr std::size_t kMostSteps = 10;
  std::vector<std::int64_t> arrivals;
  for (const TimedPose& pose : file.poses) arrivals.push_back(pose.time_ns);
  const std::vector<ClockStep> steps = clock_steps(arrivals, samples);
  if (steps.size() > kMostSteps) {
    file.remarks.push_back("the tracker's clock (sample_ns) was set " + std::to_string(steps.size()) +
                           " times, the first in line " + std::to_string(file.lines[steps[0].sample]) +
                           ": it is not used, poses have their times of arrival");
    return;
  }
  for (const ClockStep& step : steps) {
    char text[120];
    std::snprintf(text, sizeof text, "line %d: the tracker's clock (sample_ns) was set %s by %.3f s",
                  file.lines[step.sample], step.by_ns < 0 ? "back" : "forward",
                  std::abs(static_cast<double>(step.by_ns)) * 1e-9);
    file.remarks.emplace_back(text);
  }
  // Delays on either side of a step, or that fall by more than samples are apart, may bring two poses' times across.
  const std::vector<std::int64_t> times = sample_times(arrivals, samples, steps);
  PoseFile kept;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!kept.poses.empty() && times[i] <= kept.poses.back().time_ns) continue;
    kept.poses.push_back({times[i], file.poses[i].pose});
    kept.lines.push_back(file.lines[i]);
  }
  if (const std::size_t crossed = times.size() - kept.poses.size(); crossed > 0)
    file.remarks.push_back(
        std::to_string(crossed) +
        " poses are left out: by the tracker's clock they are no later than one before them");
  file.poses = std::move(kept.poses);
  file.lines = std::move(kept.lines);
  file.by_tracker_clock = true;
}

// Up to and with the last line end; all of it where no pose would be left.
std::string_view whole_lines(std::string_view text, const std::string& file) {
  const std::string_view whole = text.substr(0, text.find_last_of("\r\n") + 1);
  if (whole.size() == text.size() || text.find_first_not_of(" \t", whole.size()) == std::string_view::npos)
    return text;
  const auto table = CsvTable::parse(whole, file);
  return table && table->rows() > 0 ? whole : text;
}

}  // namespace

Result<PoseFile> parse_poses(std::string_view text, const std::string& file) {
  const std::string_view whole = whole_lines(text, file);
  const auto table = CsvTable::parse(whole, file);
  if (!table) return table.error();
  if (const Status required = table->require({"time_ns", "x", "y", "z"}); !required) return required.error();
  const auto turns = has_turns(*table);
  if (!turns) return turns.error();
  if (table->rows() == 0)
    return Error{ErrorKind::bad_input, file + ": has no poses: allowed 1 line or more of time_ns,x,y,z"};
  PoseFile out;
  out.has_turns = *turns;
  if (whole.size() < text.size())
    out.remarks.push_back("line " + std::to_string(1 + std::count(whole.begin(), whole.end(), '\n')) +
                          ", the last, has no line end: it was cut off and is left out");
  std::vector<std::int64_t> samples;
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto time = nanoseconds(*table, row, "time_ns");
    if (!time) return time.error();
    if (row > 0 && *time <= out.poses.back().time_ns)
      return not_rising(*table, row, *time, out.poses.back().time_ns);
    const auto at = position(*table, row);
    if (!at) return at.error();
    TimedPose pose{*time, {*at, Eigen::Quaterniond::Identity()}};
    if (*turns) {
      const auto turned = turn(*table, row);
      if (!turned) return turned.error();
      pose.pose.world_from_probe = *turned;
    }
    if (!table->text(row, "sample_ns").empty()) {
      const auto sample = nanoseconds(*table, row, "sample_ns");
      if (!sample) return sample.error();
      if (!samples.empty() && *sample == samples.back())
        return Error{ErrorKind::bad_input, table->place(row) + ": sample_ns = " + std::to_string(*sample) +
                                               ": allowed another than that of the line before"};
      samples.push_back(*sample);
    }
    out.poses.push_back(pose);
    out.lines.push_back(table->line(row));
  }
  if (samples.size() == out.poses.size()) use_tracker_clock(out, samples);
  return out;
}

Result<PoseFile> read_poses(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return parse_poses(*text, file.string());
}

std::filesystem::path poses_beside(const std::filesystem::path& take) {
  std::filesystem::path file = take;
  return file.replace_extension(".poses.csv");
}

Result<PoseFileWriter> PoseFileWriter::create(const std::filesystem::path& file, bool with_sample_ns) {
  if (std::error_code ignored; std::filesystem::exists(std::filesystem::symlink_status(file, ignored)))
    return Error{ErrorKind::failed, file.string() + ": exists already and is not overwritten"};
  auto part = std::make_unique<PartFile>(file);
  std::FILE* stream = std::fopen(part->path().c_str(), "we");
  if (stream == nullptr)
    return Error{ErrorKind::failed, file.string() + ": cannot write: " + std::strerror(errno)};
  PoseFileWriter writer(file, std::move(part), stream, with_sample_ns);
  std::fputs(with_sample_ns ? "time_ns,x,y,z,qx,qy,qz,qw,sample_ns\n" : "time_ns,x,y,z,qx,qy,qz,qw\n",
             stream);
  return writer;
}

Status PoseFileWriter::write(const TimedPose& pose, std::optional<std::int64_t> sample_ns) {
  const Vec3d& at = pose.pose.position_m;
  const Eigen::Quaterniond& q = pose.pose.world_from_probe;
  std::FILE* out = stream_.get();
  const bool shorter =
      std::fprintf(out, "%lld,%.7f,%.7f,%.7f,%.9f,%.9f,%.9f,%.9f", static_cast<long long>(pose.time_ns),
                   at.x(), at.y(), at.z(), q.x(), q.y(), q.z(), q.w()) < 0 ||
      (with_sample_ns_ &&
       std::fprintf(out, ",%s", sample_ns ? std::to_string(*sample_ns).c_str() : "") < 0) ||
      std::fputc('\n', out) == EOF || std::fflush(out) != 0;
  if (!shorter) return {};
  return Error{ErrorKind::failed, file_.string() + ": cannot write: " + std::strerror(errno)};
}

Status PoseFileWriter::keep() {
  stream_.reset();
  Status kept = part_->keep();
  if (kept) return {};
  const std::string hidden = part_->path().string();
  part_->leave();
  return Error{ErrorKind::failed, kept.error().message + "; the poses are in " + hidden};
}

}  // namespace lightwell
