// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// FieldLayout::code(): harmonics of a fixed degree as straight lines of GLSL, for loops over arrays are slow on many drivers.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/field_layout.h"

namespace lightwell::render {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  const std::string shortest = text;
  return shortest.find_first_of(".e") == std::string::npos ? shortest + ".0" : shortest;
}

std::string indexed(const char* name, int i) {
  return name + std::to_string(i);
}

// The variable of a triple: h0, h1 … for harmonics, e0, e1 … for main lights.
std::string variable(int triple, int harmonics) {
  return triple < harmonics ? indexed("h", triple) : indexed("e", triple - harmonics);
}

// Y_lm(d) as expressions of d: N_lm Q_lm(y) times Re or Im (z + ix)^m, with Q by the recurrence of lighting/harmonics.cpp.
class HarmonicCode {
 public:
  explicit HarmonicCode(int degree) : degree_(degree) {}

  // Declares re1, im1 … and q_l_m.
  [[nodiscard]] std::string preparation() const {
    std::string text = "  float x = d.x, y = d.y, z = d.z, re1 = z, im1 = x;\n";
    for (int m = 2; m <= degree_; ++m) {
      const std::string re = indexed("re", m - 1), im = indexed("im", m - 1);
      text += "  float " + indexed("re", m) + " = " + re + " * z - " + im + " * x, " + indexed("im", m) +
              " = " + re + " * x + " + im + " * z;\n";
    }
    double diagonal = 1;  // (2m − 1)!!
    for (int m = 0; m <= degree_; ++m) {
      text += "  float " + q(m, m) + " = " + number(diagonal) + ";\n";
      if (m < degree_) text += "  float " + q(m + 1, m) + " = " + number((2 * m + 1) * diagonal) + " * y;\n";
      for (int l = m + 2; l <= degree_; ++l)
        text += "  float " + q(l, m) + " = " + number((2.0 * l - 1) / (l - m)) + " * y * " + q(l - 1, m) +
                " - " + number((l + m - 1.0) / (l - m)) + " * " + q(l - 2, m) + ";\n";
      diagonal *= 2 * m + 1;
    }
    return text;
  }

  // Σ_m h_lm Y_lm.
  [[nodiscard]] static std::string band(int l) {
    std::string sum;
    for (int m = -l; m <= l; ++m) {
      const int n = std::abs(m);
      double ratio = 1;  // (l − n)! / (l + n)!
      for (int k = l - n + 1; k <= l + n; ++k) ratio /= k;
      const double norm = std::sqrt((2 * l + 1) / (4 * kPi) * ratio * (n > 0 ? 2 : 1));
      const std::string azimuth = m == 0 ? "" : " * " + indexed(m > 0 ? "re" : "im", n);
      sum += (sum.empty() ? "" : " + ") + indexed("h", harmonic_index(l, m)) + " * (" + number(norm) + " * " +
             q(l, n) + azimuth + ")";
    }
    return "(" + sum + ")";
  }

 private:
  static std::string q(int l, int m) { return "q_" + std::to_string(l) + "_" + std::to_string(m); }
  int degree_;
};

std::string bands_code(const char* name, int degree, bool of_irradiance) {
  std::string text =
      std::string("void ") + name + "(vec3 d, out vec3 b[BANDS]) {\n" + HarmonicCode(degree).preparation();
  for (int l = 0; l <= degree; ++l)
    text += "  b[" + std::to_string(l) +
            "] = " + (of_irradiance && irradiance_factor(l) == 0 ? "vec3(0.0)" : HarmonicCode::band(l)) +
            ";\n";
  return text + "}\n";
}

// By the addition theorem: Σ_m Y_lm(d) Y_lm(light) = (2l + 1)/4π P_l.
std::string bands_of_light_code(int degree) {
  std::string text = "void bands_of_light(float t, out float b[BANDS]) {\n  float p0 = 1.0, p1 = t;\n";
  for (int l = 2; l <= degree; ++l)
    text += "  float " + indexed("p", l) + " = " + number((2.0 * l - 1) / l) + " * t * " +
            indexed("p", l - 1) + " - " + number((l - 1.0) / l) + " * " + indexed("p", l - 2) + ";\n";
  for (int l = 0; l <= degree; ++l)
    text += "  b[" + std::to_string(l) + "] = " + number((2 * l + 1) / (4 * kPi)) + " * " + indexed("p", l) +
            ";\n";
  return text + "}\n";
}

std::string irradiance_code(int degree) {
  std::string text = "const float kIrradiance[BANDS] = float[BANDS](";
  for (int l = 0; l <= degree; ++l) text += (l > 0 ? ", " : "") + number(irradiance_factor(l));
  return text + ");\n";
}

}  // namespace

std::string FieldLayout::code(bool lobes) const {
  const int harmonics = harmonic_count(degree_);
  std::string text = "#define BANDS " + std::to_string(degree_ + 1) + "\n#define MAIN_LIGHTS " +
                     std::to_string(main_lights_) + "\n#define FIELD_TEXTURES " + std::to_string(textures_) +
                     "\nuniform sampler3D field[FIELD_TEXTURES];\n"
                     "#ifndef FIELD_TEXEL\n"
                     "#define FIELD_TEXEL(number, map, corner) texture(field[map], place + (corner))\n"
                     "#endif\n";
  // Those that no lobe needs stand last, and with it their texels.
  std::size_t count = triples_.size();
  if (!lobes)
    count = static_cast<std::size_t>(
        std::find_if(triples_.begin(), triples_.end(),
                     [&](int t) { return t < harmonics && !takes_part_in_irradiance(t); }) -
        triples_.begin());
  for (std::size_t i = 0; i < count; ++i) text += "vec3 " + variable(triples_[i], harmonics) + ";\n";
  text += "void fetch_field(vec3 place) {\n";
  const auto size = texture_size();
  const int texels_here = static_cast<int>(3 * count + 3) / 4;
  for (int i = 0; i < texels_here; ++i) {
    const Tile t = tile(i);
    text += "  vec4 " + indexed("t", i) + " = FIELD_TEXEL(" + std::to_string(i) + ", " +
            std::to_string(t.texture) + ", vec3(" + number(static_cast<double>(t.corner[0]) / size[0]) +
            ", " + number(static_cast<double>(t.corner[1]) / size[1]) + ", " +
            number(static_cast<double>(t.corner[2]) / size[2]) + "));\n";
  }
  for (std::size_t i = 0; i < count; ++i) {
    text += "  " + variable(triples_[i], harmonics) + " = vec3(";
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = 3 * i + c;
      text += (c > 0 ? ", " : "") + indexed("t", static_cast<int>(at / 4)) + "." + "xyzw"[at % 4];
    }
    text += ");\n";
  }
  text += "}\n" + irradiance_code(degree_) + bands_code("bands_of_irradiance", degree_, true) +
          bands_of_light_code(degree_);
  if (lobes) text += bands_code("bands", degree_, false);
  text += "vec3 light_here(int i) {\n";
  for (int i = 0; i < main_lights_; ++i)
    text += "  if (i == " + std::to_string(i) + ") return " + indexed("e", i) + ";\n";
  return text + "  return vec3(0.0);\n}\n";
}

}  // namespace lightwell::render
