// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "bench/pictures/judged_scenes.h"
#include "lighting/decomposition/decompose.h"
#include "render/egl_context.h"
#include "render/renderer.h"

// side_by_side REFERENCES OUT.png: the judged scenes one below the other; in a row the renderer's picture at its
// defaults, the traced one, and their difference ten times as strong on grey.
namespace {

using namespace lightwell;  // NOLINT(google-build-using-namespace)
using pictures::kPictureHeight;
using pictures::kPictureWidth;

constexpr int kGap = 4;
constexpr float kDifferenceGain = 10;

std::uint8_t code_of(float linear) {  // IEC 61966-2-1
  const float c = std::clamp(linear, 0.0f, 1.0f);
  const float encoded = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

class Sheet {
 public:
  explicit Sheet(int rows)
      : picture_{3 * kPictureWidth + 2 * kGap, rows * kPictureHeight + (rows - 1) * kGap, {}} {
    picture_.rgba.assign(
        static_cast<std::size_t>(picture_.width) * static_cast<std::size_t>(picture_.height) * 4, 255);
  }
  void put(int column, int row, const std::vector<Rgb>& linear) {
    for (int y = 0; y < kPictureHeight; ++y)
      for (int x = 0; x < kPictureWidth; ++x)
        for (int c = 0; c < 3; ++c)
          picture_.rgba[4 * (static_cast<std::size_t>(row * (kPictureHeight + kGap) + y) *
                                 static_cast<std::size_t>(picture_.width) +
                             static_cast<std::size_t>(column * (kPictureWidth + kGap) + x)) +
                        static_cast<std::size_t>(c)] =
              code_of(linear[static_cast<std::size_t>(y) * kPictureWidth + static_cast<std::size_t>(x)][c]);
  }
  [[nodiscard]] const render::DisplayPicture& picture() const { return picture_; }

 private:
  render::DisplayPicture picture_;
};

Status add_row(Sheet& sheet, int row, const pictures::JudgedPicture& judged) {
  auto renderer = render::Renderer::create(judged.scene, {});
  if (!renderer) return renderer.error();
  const auto lights = decompose(polar_map_from_lat_long(judged.light, true), Method::best, 72);
  if (!lights) return lights.error();
  if (Status s = renderer->render(*lights, judged.scene.cameras.at(0)); !s) return s;
  const auto ours = pictures::displayed(pictures::colours_of(renderer->radiance()), judged.reference).pixels;
  const auto truth = pictures::displayed(judged.reference.radiance, judged.reference).pixels;
  std::vector<Rgb> difference;
  constexpr float kGrey = 0.214f;  // half of a display's codes
  for (std::size_t i = 0; i < ours.size(); ++i)
    difference.push_back(judged.reference.mask[i] == 0 ? Rgb::Constant(kGrey)
                                                       : Rgb(kGrey + kDifferenceGain * (ours[i] - truth[i])));
  sheet.put(0, row, ours);
  sheet.put(1, row, truth);
  sheet.put(2, row, difference);
  const pictures::PictureError error =
      pictures::picture_error(pictures::colours_of(renderer->radiance()), judged.reference);
  std::printf("%s: relative RMSE %.4f, FLIP %.4f, bias %+.4f\n", judged.name.c_str(), error.relative_rmse,
              error.flip, error.bias);
  return {};
}

Status make(const std::filesystem::path& references, const std::filesystem::path& out) {
  const auto context = render::EglContext::create();
  if (!context) return context.error();
  const auto& scenes = pictures::judged_scenes();
  Sheet sheet(static_cast<int>(scenes.size()));
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const auto judged = pictures::judged_picture(scenes[i], references);
    if (!judged) return judged.error();
    if (Status s = add_row(sheet, static_cast<int>(i), *judged); !s) return s;
  }
  return render::write_png(out, sheet.picture());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: side_by_side REFERENCES OUT.png\n");
    return 2;
  }
  const Status made = make(argv[1], argv[2]);
  if (made) return 0;
  std::fprintf(stderr, "side_by_side: %s\n", made.error().message.c_str());
  return static_cast<int>(made.error().kind);
}
