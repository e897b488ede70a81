// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/developed_picture.h"
#include "cli/progress.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/exr_file.h"
#include "interface/frame_name.h"
#include "interface/grey_map.h"
#include "interface/option_range.h"
#include "interface/printable.h"
#include "interface/recording.h"
#include "interface/same_file.h"

namespace lightwell::cli {
namespace {

struct DevelopArguments {
  std::string input, calibration, out, size, pixel_format;
  std::string projection = "latlong";
  std::optional<double> exposure_us;
  bool json = false;
};

struct Counts {
  int frames = 0, damaged = 0, clipped_frames = 0;
  std::uint32_t most_clipped = 0;
};

Status write_frame(const DevelopedPicture& picture, const RecordedFrame& info,
                   const std::filesystem::path& file) {
  ExrFacts facts;
  facts.white_luminance_cd_m2 = 1;  // radiance is in cd/m²
  facts.exposure_s = info.exposure_us * 1e-6;
  facts.timecode = info.timecode;
  char coverage[32];
  std::snprintf(coverage, sizeof coverage, "%.6g", picture.coverage);
  facts.texts = {{"lightwell_coverage", coverage},
                 {"lightwell_projection", picture.projection},
                 {"lightwell_capture_utc_ns", std::to_string(info.capture_utc_ns)}};
  const auto bytes = exr_from_floats(
      picture.width, picture.height, "RGBA", picture.rgba,
      picture.projection == "latlong" ? ExrContent::lat_long_environment : ExrContent::picture, facts);
  if (!bytes) return Error{bytes.error().kind, file.string() + ": " + bytes.error().message};
  return write_file_atomically(file, *bytes);
}

// A developer of the options' projection and size.
Result<PictureDeveloper> developer_of(const DevelopArguments& o, const Calibration& calibration,
                                      const FrameFormat& format) {
  std::optional<PictureSize> size;
  if (!o.size.empty()) {
    PictureSize given;
    char end = 0;
    if (std::sscanf(o.size.c_str(), "%dx%d%c", &given.width, &given.height, &end) != 2)
      return usage("--size is " + o.size + ", allowed: WIDTHxHEIGHT");
    size = given;
  }
  return PictureDeveloper::create(calibration, format, o.projection, size);
}

Status develop_picture(PictureDeveloper& developer, std::span<const std::byte> codes,
                       const RecordedFrame& info, const std::filesystem::path& file, Counts& counts) {
  const DevelopedPicture& picture = developer.develop(codes, info.exposure_us);
  if (picture.clipped_pixels > 0) ++counts.clipped_frames;
  counts.most_clipped = std::max(counts.most_clipped, picture.clipped_pixels);
  if (const Status written = write_frame(picture, info, file); !written) return written;
  ++counts.frames;
  return {};
}

Result<Calibration> calibration_of(const DevelopArguments& o, const std::string& attached) {
  if (!o.calibration.empty()) return read_calibration(o.calibration);
  if (attached.empty())
    return Error{ErrorKind::bad_input,
                 o.input + ": has no calibration attached: allowed with --calibration DIR"};
  return calibration_from_json(attached, o.input + " (attached calibration.json)");
}

Status develop_take(const DevelopArguments& o, const FrameName& out, Counts& counts) {
  const auto opened = RecordingReader::open(o.input);
  if (!opened) return opened.error();
  RecordingReader& reader = **opened;
  const auto calibration = calibration_of(o, reader.header().calibration_json);
  if (!calibration) return calibration.error();
  auto developer = developer_of(o, *calibration, reader.header().format);
  if (!developer) return developer.error();
  std::vector<std::byte> codes(reader.header().format.bytes());
  const auto expected = reader.frame_count();
  if (!out.numbered && (!expected || *expected != 1))
    return usage("--out is " + o.out +
                 ", allowed for more than one frame: a name with a number, frame_%06d.exr");
  Progress progress(expected ? *expected : 0);
  for (int number = 0;;) {
    const auto frame = reader.read(codes);
    if (!frame) {
      ++counts.damaged;
      if (counts.damaged > 100000) return frame.error();
      continue;
    }
    if (!*frame) break;
    if (!((*frame)->exposure_us > 0))
      return Error{ErrorKind::bad_input,
                   o.input + ": frame " + std::to_string(number) + ": exposure_us is not above 0"};
    if (const Status done = develop_picture(*developer, codes, **frame, out.file(number), counts); !done)
      return done;
    progress.done(static_cast<std::size_t>(++number));
  }
  if (counts.frames == 0) return Error{ErrorKind::bad_input, o.input + ": holds no whole frame"};
  return {};
}

Status develop_frame(const DevelopArguments& o, const FrameName& out, Counts& counts) {
  const auto frame = read_grey_map(o.input);
  if (!frame) return frame.error();
  const auto calibration = calibration_of(o, {});
  if (!calibration) return calibration.error();
  RecordedFrame info;
  info.exposure_us = o.exposure_us.value_or(calibration->response.reference_exposure_us);
  FrameFormat format{frame->width, frame->height, PixelFormat::mono8};
  if (frame->bytes_a_sample == 2) {  // the sensor's bits in the low ones
    const int bits = calibration->response.bits;
    format.pixel_format = bits == 12   ? PixelFormat::mono12
                          : bits == 10 ? PixelFormat::mono10
                                       : PixelFormat::mono16;
  }
  if (!o.pixel_format.empty()) {
    const auto named = pixel_format_from_name(o.pixel_format);
    if (!named || storage_bits(*named) != 8 * frame->bytes_a_sample)
      return usage("--pixel-format is " + o.pixel_format +
                   ", allowed: a GenICam name of unpacked samples of " +
                   std::to_string(8 * frame->bytes_a_sample) + " bits");
    format.pixel_format = *named;
  }
  auto developer = developer_of(o, *calibration, format);
  if (!developer) return developer.error();
  return develop_picture(*developer, frame->samples, info, out.file(0), counts);
}

int run(const DevelopArguments& o) {
  const auto out = FrameName::parse(o.out);
  if (!out) return fail(out.error());
  if (out->format != FrameName::Format::exr) return fail(usage("--out is " + o.out + ", allowed: .exr"));
  if (const Status other = check_output_is_no_input(o.out, {o.input}); !other) return fail(other.error());
  Counts counts;
  const bool frame = is_grey_map(o.input);
  if (o.exposure_us && !frame)
    return fail(usage("--exposure needs a single frame, a .pgm; a take has its own"));
  const Status done = frame ? develop_frame(o, *out, counts) : develop_take(o, *out, counts);
  if (!done) return fail(done.error());
  if (counts.damaged > 0)
    std::fprintf(stderr, "lightwell: %s: damaged in %d places, the frames there are lost\n",
                 printable(o.input).c_str(), counts.damaged);
  if (counts.clipped_frames > 0)
    std::fprintf(stderr,
                 "lightwell: %s: %d frames have clipped pixels, up to %u: they count at the sensor's limit\n",
                 printable(o.input).c_str(), counts.clipped_frames, counts.most_clipped);
  if (o.json) {
    const nlohmann::ordered_json json = {{"schema", "lightwell.develop/1"},
                                         {"frames", counts.frames},
                                         {"damaged", counts.damaged},
                                         {"clipped_frames", counts.clipped_frames},
                                         {"most_clipped_pixels", counts.most_clipped}};
    std::printf("%s\n", json.dump(2).c_str());
  } else {
    std::printf("%d frames\n", counts.frames);
  }
  return 0;
}

}  // namespace

Command add_develop(CLI::App& app) {
  const auto o = std::make_shared<DevelopArguments>();
  CLI::App* command = app.add_subcommand("develop", "Raw frames to pictures of radiance");
  command->footer(
      "Example: lightwell develop take.mkv --calibration calibration --out 'frame_%06d.exr'\n"
      "         lightwell develop frame.pgm --calibration calibration --exposure 10000 --out frame.exr\n"
      "R, G, B in cd/m2, Rec. 709; alpha 0 where the camera did not look");
  command->add_option("input", o->input, "A take (.mkv), or one raw frame (.pgm of 8 or 16 bits)")
      ->required()
      ->type_name("TAKE|FRAME");
  command->add_option("--calibration", o->calibration, "Folder; else the one attached to the take")
      ->type_name("DIR");
  command->add_option("--out", o->out, "EXR files, frame_%06d.exr; numbers count from 0")
      ->required()
      ->check(output_file())
      ->type_name("PATTERN");
  command
      ->add_option("--projection", o->projection,
                   "latlong, polar (rings from the zenith), fisheye (as the lens shows it)")
      ->capture_default_str();
  command
      ->add_option("--size", o->size,
                   "latlong: twice as wide as high (360x180); polar: sectors x rings (360 x one a degree); "
                   "fisheye (the camera's)")
      ->type_name("WxH");
  command
      ->add_option("--exposure", o->exposure_us, "Of a single frame, microseconds; else the response's own")
      ->check(numbers_above_0_to(1e9, "above 0 to 1e9 microseconds"))
      ->type_name("US");
  command
      ->add_option("--pixel-format", o->pixel_format, "Of a single frame, Mono12, BayerRG12 ...; else grey")
      ->type_name("NAME");
  command->add_flag("--json", o->json, "Machine-readable result on stdout");
  return {command, [o] { return run(*o); }};
}

}  // namespace lightwell::cli
