// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <system_error>
#include <vector>

#include "interface/atomic_file.h"
#include "interface/part_file.h"
#include "interface/recording_reader.h"

namespace lightwell {

Result<RepairReport> repair_recording(const std::filesystem::path& broken, const std::filesystem::path& out,
                                      const std::function<void(double)>& progress) {
  if (const Status named = check_output_name(out); !named) return named.error();
  MatroskaReader reader(broken);
  if (Status status = reader.begin(true); !status) return status.error();
  if (std::error_code ignored; std::filesystem::exists(std::filesystem::symlink_status(out, ignored)))
    return Error{ErrorKind::failed, out.string() + ": exists already and is not overwritten"};
  PartFile part(out);
  auto writer = RecordingWriter::create(part.path(), reader.header());
  if (!writer) return part.about_out(writer.error());

  RepairReport report;
  report.calibration_lost = reader.calibration_lost();
  std::vector<std::byte> codes(reader.header().format.bytes());
  for (;;) {
    const auto frame = reader.read(codes);
    if (!frame) continue;  // damage; the reader goes on behind it
    if (!*frame) break;
    if (Status status = (*writer)->write(**frame, codes); !status) return part.about_out(status.error());
    ++report.recovered;
    if (progress) progress(reader.share_done());
  }
  report.damaged = reader.frames_passed() - report.recovered;
  if (report.recovered == 0) return Error{ErrorKind::bad_input, broken.string() + ": holds no whole frame"};
  if (Status status = (*writer)->close(); !status) return part.about_out(status.error());
  if (Status status = part.keep(); !status) return status.error();
  return report;
}

}  // namespace lightwell
