// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// make_seeds FOLDER: what the project itself writes and what its tests import, as first inputs: FOLDER/TARGET/file.
#include <cstdio>
#include <filesystem>

#include "calibration/lens/correspondences.h"
#include "interface/atomic_file.h"
#include "interface/calibration_io.h"
#include "interface/recording.h"
#include "interface/sync_frame.h"
#include "tests/support/gltf_document.h"

using namespace lightwell;

namespace {

void write(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  const Status written = write_file_atomically(file, text);
  verify_bug(written.ok(), "cannot write a seed");
}

using ResponseModel = decltype(Response::model);

Calibration calibration_of(const ResponseModel& model) {
  Calibration c;
  c.response.model = model;
  c.response.clip_code = 4000;
  c.response.reference_exposure_us = 1000;
  c.lens.image_size = {8, 6};
  c.lens.focal = {3, 3};
  c.lens.center = {3.5, 2.5};
  c.lens.k = {-0.01, 0.001, 0, 0};
  c.lens.max_theta_rad = 1.5;
  c.lens.zenith = Vec3d(0.1, -0.2, 0.9).normalized();
  c.flat.image_size = c.lens.image_size;
  c.flat.vignetting = {-0.1, 0.01, 0};
  c.flat.offset_codes.assign(48, 1.5F);
  c.flat.gain.assign(48, 1.01F);
  c.rec709_from_camera << 1.5, -0.3, -0.2, -0.1, 1.2, -0.1, 0, -0.4, 1.4;
  return c;
}

void calibration_files(const std::filesystem::path& folder) {
  const ResponseModel models[] = {LogResponse{64, 208, 0.1}, LinearResponse{12, 0.25},
                                  LinLogResponse{64, 30, 20},
                                  PiecewiseLinearResponse{{{0, 60}, {12, 1084}, {95, 2108}, {24000, 4000}}}};
  for (std::size_t i = 0; i < std::size(models); ++i) {
    const Calibration c = calibration_of(models[i]);
    const auto own = folder / ("folder" + std::to_string(i));
    const Status written = write_calibration(own, c);
    verify_bug(written.ok(), "a seed's calibration is refused");
    for (const char* name : {"lens.json", "response.json", "flat.json"})
      std::filesystem::rename(own / name, folder / (std::to_string(i) + name));
    std::filesystem::remove(own);
    write(folder / (std::to_string(i) + "attachment.json"), calibration_to_json(c));
  }
}

void corners(const std::filesystem::path& folder) {
  calibration::TargetViews views;
  views.image_size = {640, 480};
  for (int v = 0; v < 2; ++v) {
    calibration::TargetView view{"view " + std::to_string(v), {}};
    for (int i = 0; i < 4; ++i)
      view.points.push_back({Vec3d(30 * i, 30 * v, 0), Vec2d(100 + 40 * i, 90 + v)});
    views.views.push_back(view);
  }
  write(folder / "corners.json", calibration::to_json(views));
}

void patches(const std::filesystem::path& folder) {
  write(folder / "patches.csv",
        "name,luminance_cd_m2,code,code_sigma,use,channel,exposure_us\n\"a, "
        "\"\"b\"\"\",0.1,400,0.5,fit,R,1000\n"
        "c,1.6,900,0.5,fit,R,1000\nd,25,1400,,fit,R,1000\ne,400,2000,0.5,fit,R,1000\nf,6300,2600,0.5,check,R,"
        "1000\n");
  write(folder / "positions.csv", "\xef\xbb\xbfpatch,x,y,w,h\r\n1,10,20,30,40\r\n2,60,20,30,40\r\n");
  write(folder / "chart.csv",
        "name,camera_r,camera_g,camera_b,rec709_r,rec709_g,rec709_b\nwhite,50,100,80,100,100,100\n"
        "red,20,5,2,40,5,2.5\ngreen,4,40,10,8,40,12.5\nblue,3,10,32,6,10,40\n");
  write(folder / "codes.csv", "code_r,code_g,code_b,X,Y,Z,use\n500,1000,800,95,100,108,fit\n");
}

void photometric(const std::filesystem::path& folder) {
  write(
      folder / "lamp.ies",
      "IESNA:LM-63-2002\n[LUMINAIRE] Spot\nTILT=INCLUDE\n1\n2\n0 90\n1 0.8\n1 -1 1 3 2 1 2 .1 .1 0\n1 1 40\n"
      "0 45 90\n0 90\n30 20 10\n30 15 5\n");
  std::string flood =
      "Maker\n1\n4\n4\n90\n2\n90\nreport\nFlood\n1\nf."
      "ldt\ndate\n500\n0\n80\n400\n0\n1\n2\n3\n4\n100\n50\n1\n0\n1\n1\n"
      "LED\n2000\n4000\n80\n25\n";
  for (int i = 0; i < 10; ++i) flood += "0.5\n";
  write(folder / "lamp.ldt", flood + "0\n90\n180\n270\n0\n90\n100\n50\n80\n40\n");
}

// The header of TM-25 and two rays.
void rays(const std::filesystem::path& folder) {
  std::string text = "TM25";
  const auto put = [&](const auto& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::int32_t{2013});
  put(std::int32_t{1});
  put(100.0F);
  put(2.0F);
  put(std::uint64_t{2});
  text.append(28 + 4 * 8 + 168, '\0');
  for (const std::int32_t flag : {1, 1, 1, 0, 0, 0, 0, 0}) put(flag);
  text.append(std::size_t{9} * 4000, '\0');
  for (const float item :
       {1.0F, 2.0F, 3.0F, 0.0F, 0.0F, 1.0F, 0.5F, 0.0F, 0.0F, 0.0F, 0.6F, 0.0F, 0.8F, 1.5F})
    put(item);
  write(folder / "lamp.tm25ray", text);
  write(folder / "lamp.csv", "# lamp\nx,y,z,u,v,w,flux\n0.01,0,0,0,0,-1,0.5\n0,0.01,0,0.6,0,-0.8,1.5\n");
  write(folder / "lamp.dat", "2 4\n1 2 3 0 0 1 0.5 0.55\n0 0 0 0.6 0 0.8 1.5 0.55\n");
}

void imports(const std::filesystem::path& folder) {
  write(folder / "lens_import_opencv/a.yaml",
        "%YAML:1.0\n---\nimage_width: 848\nimage_height: 800\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   "
        "cols: 3\n"
        "   dt: d\n   data: [ 285.5, 0., 421.25, 0., 286.5, 398.75, 0., 0., 1. ]\n"
        "distortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   dt: d\n"
        "   data: [ -0.0031, 0.0412, -0.0384, 0.0067 ]\n");
  write(folder / "lens_import_opencv/b.xml",
        "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_size>848 800</image_size>\n"
        "<K type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt>\n"
        "<data>285.5 0. 421.25 0. 286.5 398.75 0. 0. 1.</data></K>\n"
        "<D><!-- k "
        "--><_>-0.0031</_><_>0.0412</_><_>-0.0384</_><_>0.0067</_></D>\n<xi>1.2</xi>\n</opencv_storage>\n");
  write(folder / "lens_import_opencv/c.json",
        R"({"K": [[285.5, 0.0, 421.25], [0.0, 286.5, 398.75], [0.0, 0.0, 1.0]],
            "D": [[-0.0031], [0.0412], [-0.0384], [0.0067]], "DIM": [848, 800], "model": "fisheye"})");
  const char* models[][4] = {{"pinhole", "400, 401, 320, 240", "radtan", "-0.2, 0.05, 0.001, -0.001"},
                             {"pinhole", "400, 401, 320, 240", "equidistant", "-0.01, 0.05, 0.001, -0.001"},
                             {"pinhole", "300, 301, 320, 240", "fov", "0.9"},
                             {"omni", "1.4, 500, 501, 320, 240", "radtan", "-0.1, 0.02, 0.001, -0.001"},
                             {"eucm", "0.6, 1.1, 200, 201, 320, 240", "none", ""},
                             {"ds", "-0.17, 0.59, 158, 158, 320, 240", "none", ""}};
  int n = 0;
  for (const auto& [model, intrinsics, distortion, numbers] : models)
    write(folder / "lens_import_kalibr" / (std::to_string(n++) + ".yaml"),
          std::string("cam0:\n  camera_model: ") + model + "\n  intrinsics: [" + intrinsics +
              "]\n  distortion_model: " + distortion + "\n  distortion_coeffs: [" + numbers +
              "]\n  resolution: [640, 480]\n");
  write(folder / "lens_import_ocamcalib/calib_results.txt",
        "#polynomial\n\n5 -4.714441e+02 0 7.356108e-04 -3.773045e-07 5.800006e-10\n\n"
        "3 772.405470 504.754051 7.034666\n\n794.308657 798.175741\n\n1.000305 -0.000277 -0.000925\n\n1600 "
        "1500\n");
  const std::string begin = "# a comment\n{ 'lensmodel': 'LENSMODEL_",
                    end =
                        " 'imagersize': [ 1000, 800,], 'x': b'ab'\n b'c',\n"
                        " 'valid_intrinsics_region': [ [0, 0], [0, 799], [999, 799], [0, 0], ], }\n";
  write(folder / "lens_import_mrcal/a.cameramodel",
        begin + "STEREOGRAPHIC',\n 'intrinsics': [ 600, 601, 500, 400, ],\n" + end);
  write(folder / "lens_import_mrcal/b.cameramodel",
        begin + "CAHVOR',\n 'intrinsics': [ 600, 601, 500, 400, 0.02, -0.03, 0.01, 0.05, -0.02 ],\n" + end);
  write(folder / "lens_import_mrcal/c.cameramodel",
        begin + "OPENCV8',\n 'intrinsics': [ 600, 601, 500, 400, 0.1, 0, 0, 0, 0, 0.1, 0, 0 ],\n" + end);
  std::string control;
  for (int i = 0; i < 40; ++i) control += "0.01, ";
  write(folder / "lens_import_mrcal/d.cameramodel",
        begin +
            "SPLINED_STEREOGRAPHIC_order=2_Nx=5_Ny=4_fov_x_deg=170',\n 'intrinsics': [ 600, 601, 500, 400, " +
            control + "],\n" + end);
}

// A triangle as it is, and one that is skinned, morphs and moves.
void scenes(const std::filesystem::path& folder) {
  using test::animate;
  using test::json;
  test::Document d = test::triangle();
  json& attributes = d.primitive()["attributes"];
  attributes["NORMAL"] = d.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 5126, 3);
  attributes["TEXCOORD_0"] = d.add<float>({0, 0, 1, 0, 0, 1}, "VEC2", 5126, 2);
  attributes["COLOR_0"] = d.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3", 5126, 3);
  write(folder / "still.gltf", d.text());
  attributes["JOINTS_0"] = d.add<std::uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 5121, 4);
  attributes["WEIGHTS_0"] = d.add<float>({1, 0, 0, 0, 0.5F, 0.5F, 0, 0, 1, 0, 0, 0}, "VEC4", 5126, 4);
  const int target = d.add<float>({0, 0, 1, 0, 0, 0, 0, 0, 1}, "VEC3", 5126, 3);
  const int places = d.add<std::uint16_t>({1}, "SCALAR", 5123, 1);
  const int values = d.add<float>({0, 1, 0}, "VEC3", 5126, 3);
  d.root["accessors"][static_cast<std::size_t>(target)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", places}, {"componentType", 5123}}},
      {"values", {{"bufferView", values}}}};
  d.primitive()["targets"] = json::array({{{"POSITION", target}}});
  d.primitive()["indices"] = d.add<std::uint16_t>({0, 1, 2}, "SCALAR", 5123, 1);
  d.primitive()["material"] = 0;
  d.root["materials"] = json::array({{{"alphaMode", "MASK"},
                                      {"emissiveFactor", {1, 0, 0}},
                                      {"extras", {{"phong", {{"diffuse", {1, 1, 1}}, {"exponent", 9}}}}}}});
  d.root["skins"] = json::array({{{"joints", {1, 2}}}});
  d.root["cameras"] =
      json::array({{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}});
  d.root["nodes"] = json::array({{{"mesh", 0}, {"skin", 0}},
                                 {{"children", json::array({2})}, {"scale", {1, 2, 1}}},
                                 {{"translation", {0, 1, 0}}, {"camera", 0}}});
  d.root["scenes"][0]["nodes"] = {0, 1};
  animate(d, 2, "rotation", {0, 1}, {0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4);
  animate(d, 1, "translation", {0, 1}, std::vector<float>(18, 1), "VEC3", 3, "CUBICSPLINE");
  animate(d, 0, "weights", {0, 1}, {0, 1}, "SCALAR", 1, "STEP");
  write(folder / "moving.gltf", d.text());
}

void radiance(const std::filesystem::path& folder) {
  const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\nCOLORCORR=1 1 2\n";
  write(folder / "flat.hdr", head + "\n-Y 2 +X 2\n" + std::string(16, '\x80'));
  std::string row = {2, 2, 0, 8};
  for (int plane = 0; plane < 4; ++plane) row += std::string{'\x84', '\x40', 4, 1, 2, 3, 4};
  write(folder / "runs.hdr",
        head + "PRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n\n-Y 1 +X 8\n" + row);
}

void takes(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (const RecordingCodec codec : {RecordingCodec::raw, RecordingCodec::ffv1})
    for (const PixelFormat pixels : {PixelFormat::mono8, PixelFormat::mono12p}) {
      RecordingHeader header;
      header.format = {8, 6, pixels};
      header.codec = codec;
      header.rate_hz = 30;
      header.source = "seed";
      header.calibration_json = R"({"schema":"lightwell.calibration/1"})";
      const auto file =
          folder / (std::string(name(codec)) + std::to_string(significant_bits(pixels)) + ".mkv");
      std::filesystem::remove(file);
      auto writer = RecordingWriter::create(file, header);
      verify_bug(writer.ok(), "cannot write a take");
      for (int i = 0; i < 2; ++i) {
        RecordedFrame frame;
        frame.sequence = static_cast<std::uint64_t>(i);
        frame.capture_mono_ns = frame.received_mono_ns = frame.capture_utc_ns = 33'000'000 * (i + 1);
        frame.exposure_us = 1000;
        const std::vector<std::byte> codes(header.format.bytes(), std::byte{7});
        const Status written = (*writer)->write(frame, codes);
        verify_bug(written.ok(), "cannot write a frame");
      }
      const Status closed = (*writer)->close();
      verify_bug(closed.ok(), "cannot close a take");
    }
}

void poses(const std::filesystem::path& folder) {
  write(folder / "places", "time_ns,x,y,z\n1000,0,1,2\n2000,0.1,1,2\n");
  write(folder / "turns",
        "time_ns,x,y,z,qx,qy,qz,qw,sample_ns\n"
        "1000,0,1,2,0,0,0,1,77\n9000000,0.1,1,2,0,0.7071,0,0.7071,8999000\n");
}

void tracking(const std::filesystem::path& folder) {
  std::string freed = std::string(1, '\0') + "\xD1\x01" + std::string(26, '\x02');
  freed += '\x3B';
  write(folder / "freed", freed);
  write(
      folder / "opentrackio.json",
      std::string(1, '\x02') +
          R"({"static":{"camera":{"activeSensorPhysicalDimensions":{"width":36.0,"height":24.0}}},)"
          R"("timing":{"sampleTimestamp":{"seconds":1718806554,"nanoseconds":500000000}},)"
          R"("lens":{"pinholeFocalLength":24.0},"transforms":[{"id":"Camera","translation":{"x":0,"y":2,"z":1.5},)"
          R"("rotation":{"pan":0,"tilt":45,"roll":0},"scale":{"x":1,"y":1,"z":1}}]})");
  write(folder / "opentrackio.cbor",
        std::string(1, '\x02') + "\xBF\x6Atransforms\x81\xA1\x6Btranslation\xA3\x61x\xF9\x3E" +
            std::string(1, '\0') + "\x61y\x21\x61z\xFA\x3E\x80" + std::string(2, '\0') + "\xFF");
  const std::string chunks = "\x7F\x64" + std::string("lens") + "\x60\xFF";  // of a text of no given length
  write(folder / "opentrackio_chunks.cbor", std::string(1, '\2') + "\xA1" + chunks + "\x5F\x41\x01\xFF");
  // What may nest, and bytes and texts must not: more than a reader's stack holds.
  for (const char* byte : {"5F", "7F", "9F", "BF", "81", "A1", "C0"}) {
    const auto nested = static_cast<char>(std::stoi(byte, nullptr, 16));
    write(folder / (std::string("opentrackio_nested_") + byte),
          std::string(1, '\2') + std::string(60'000, nested));
    write(folder / (std::string("opentrackio_nested_value_") + byte),
          std::string(1, '\2') + "\xA1\x64lens" + std::string(64, nested));
  }
}

void rigs(const std::filesystem::path& folder) {
  const std::string planes =
      "schema = \"lightwell.rig/1\"\nname = \"Lamp\"\n[sampling]\nspacing_m = 0.005\nfilter = \"finite\"\n"
      "peak_transmission = 0.8\nmoves = \"lamp\"\nz_m = 0.01\n[measurement]\ndistance_m = 0.1\n"
      "low_m = [-0.2, -0.2]\nhigh_m = [0.2, 0.2]\npixels = [300, 300]\n";
  std::string marks =
      planes +
      "[camera]\nunit = \"codes\"\ncalibration = \"camera\"\nscreen_reflectance = 0.9\n"
      "exposure_us = 20000\ndark = \"dark.exr\"\ndark_exposure_us = 1000\nmost_saturated = 0\n"
      "most_negative = 0.1\nmost_mark_error_px = 1\n";
  for (const char* at : {"[-0.2, -0.2]", "[0.2, -0.2]", "[0.2, 0.2]", "[-0.2, 0.2]"})
    marks += std::string("[[marks]]\npixel = [100.5, 20]\nscreen_m = ") + at + "\n";
  write(folder / "marks.toml", marks);
  write(folder / "edges.toml",
        planes +
            "[camera]\nunit = \"relative\"\nsaturation = 4.0\n[picture]\n"
            "first_m = [-0.2, 0.2]\nlast_m = [0.2, -0.2]\n[reference]\nat_m = [0, 0, -1]\n"
            "toward = [0, 0, 1]\nlux = 120\n");
}

void sync_protocol(const std::filesystem::path& folder) {
  for (unsigned type = 0; type < 256; ++type) {
    const auto known = static_cast<std::uint8_t>(type);
    const std::size_t size = sync_payload_size(known);
    if (size == SIZE_MAX) continue;
    const std::vector<std::uint8_t> payload(size, 1);
    std::string wire(SYNC_MAX_WIRE, '\0');
    wire.resize(frame_encode(known, 1, payload.data(), size, reinterpret_cast<std::uint8_t*>(wire.data())));
    write(folder / std::to_string(type), wire);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "make_seeds FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder / "calibration_files");
  calibration_files(folder / "calibration_files");
  corners(folder / "corners");
  patches(folder / "patches");
  photometric(folder / "photometric");
  rays(folder / "ray_file");
  rigs(folder / "rig");
  imports(folder);
  radiance(folder / "radiance_hdr");
  scenes(folder / "gltf");
  takes(folder / "recording");
  tracking(folder / "tracking");
  poses(folder / "poses");
  std::filesystem::create_directories(folder / "sync_protocol");
  sync_protocol(folder / "sync_protocol");
  return 0;
}
