// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "calibration/report/html_report.h"

#include <optional>
#include <system_error>

#include "calibration/report/residual_plots.h"
#include "calibration/report/svg_plot.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/json_fields.h"

namespace lightwell::calibration {
namespace {

constexpr const char* kStyle =
    "body{font:16px/1.5 system-ui,sans-serif;color:#1c2733;background:#fff;max-width:680px;margin:2em "
    "auto;padding:0 1em}"
    "h1{font-size:1.5em;margin-bottom:.2em}h2{font-size:1.15em;margin-top:1.8em;border-top:1px solid "
    "#d8dee6;padding-top:.6em}"
    ".verdict{font-size:1.2em;font-weight:600;margin:.4em 0}.warning{color:#a3281c}"
    "svg{max-width:100%;height:auto}svg text{font:12px "
    "system-ui,sans-serif;fill:#435160}.grid{stroke:#e3e8ee}"
    ".curve{stroke:#08306b;stroke-width:2}.band{fill:#c9dcef}.zero{stroke:#8493a3}.error{stroke:#08306b;"
    "stroke-width:1.5}"
    ".fit{fill:#08306b;background:#08306b}.check{fill:#2e8b57;background:#2e8b57}.out{fill:#fff;stroke:#"
    "a3281c;"
    "stroke-width:2;background:#a3281c}.key{display:inline-block;width:.7em;height:.7em;border-radius:50%;"
    "margin:0 .3em 0 1em}"
    ".patches "
    "td{white-space:nowrap}.note{color:#435160;font-size:.9em}.row{display:flex;flex-wrap:wrap;gap:1em}"
    ".views{gap:.6em .8em}.views figure{width:196px}.views figcaption{overflow-wrap:anywhere}"
    "figure{margin:0}figcaption{"
    "font-size:.85em;color:#435160;text-"
    "align:center}"
    ".halo{paint-order:stroke;stroke:#fff;stroke-width:3px}.image{background:#f5f7f9;border:1px solid "
    "#d8dee6}"
    "table{border-collapse:collapse;font-size:.85em;margin-top:1em}td,th{padding:.15em .8em .15em "
    "0;text-align:left;"
    "border-bottom:1px solid #e3e8ee}";

bool is_there(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::symlink_status(file, ignored).type() != std::filesystem::file_type::not_found;
}

Result<nlohmann::json> json_of(const std::filesystem::path& file) {
  const auto text = read_text_file(file);
  if (!text) return text.error();
  return parse_json(*text, file.string());
}

// Adds the section of `file`, where it is there. read: checks the file as the daemon does.
template <class Read, class Make>
Status add(std::vector<ReportSection>& sections, const std::filesystem::path& file, Read read, Make make) {
  if (!is_there(file)) return {};
  const auto value = read(file);
  if (!value) return value.error();
  const auto json = json_of(file);
  if (!json) return json.error();
  try {
    sections.push_back(make(*value, *json));
  } catch (const nlohmann::json::exception&) {
    return Error{ErrorKind::bad_input,
                 file.string() + ": its report is not as calibrate wrote it: calibrate again"};
  }
  return {};
}

std::string joined(const std::vector<ReportSection>& sections, std::string ReportSection::*part,
                   const char* between) {
  std::string out;
  for (const ReportSection& s : sections)
    if (!(s.*part).empty()) out += (out.empty() ? "" : between) + s.*part;
  return out;
}

// The folder's own name, not where it lies.
std::string folder_name(const std::filesystem::path& directory) {
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(directory, error);
  const std::string name = file_name((error ? directory : whole).string());
  return name.empty() || name == "/" ? "this machine" : name;
}

}  // namespace

Result<std::string> calibration_page(const std::filesystem::path& directory) {
  std::vector<ReportSection> sections;
  std::optional<Lens> lens;
  const auto add_lens = [&](const Lens& read, const nlohmann::json& json) {
    lens = read;
    return lens_section(read, json);
  };
  const auto add_flat = [&](const FlatField& flat, const nlohmann::json& json) {
    return flat_section(flat, lens ? lens->max_theta_rad : kPi / 2, json);
  };
  if (Status s = add(sections, directory / "lens.json", read_lens, add_lens); !s) return s.error();
  if (Status s = add(sections, directory / "response.json", read_response, response_section); !s)
    return s.error();
  if (Status s = add(sections, directory / "flat.json", read_flat_field, add_flat); !s) return s.error();
  if (sections.empty())
    return Error{ErrorKind::bad_input,
                 directory.string() + ": holds no response.json, lens.json or flat.json"};
  const std::string good = joined(sections, &ReportSection::verdict, " and ");
  const std::string warning = joined(sections, &ReportSection::warning, "");
  std::string page =
      "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>Calibration</title><style>";
  page += kStyle;
  page += "</style></head><body><h1>Calibration of " + escaped(folder_name(directory)) +
          "</h1><p class=\"verdict\">" +
          (good.empty() ? "Its error is not known." : "Good to " + escaped(good) + ".") + "</p>";
  if (!warning.empty()) page += "<p class=\"warning\">But: " + escaped(warning) + "</p>";
  page += joined(sections, &ReportSection::html, "\n");
  return page + "</body></html>\n";
}

}  // namespace lightwell::calibration
