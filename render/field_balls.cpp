// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/field_balls.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/uniforms.h"

namespace lightwell::render {
namespace {

constexpr float kRadiusOfStep = 0.15f;
constexpr std::uint16_t kRings = 8, kSectors = 12;

struct Ball {
  std::vector<Vec3f> positions;
  std::vector<std::uint16_t> triangles;
};

// Counter-clockwise from outside.
Ball unit_ball() {
  Ball ball;
  for (int r = 0; r <= kRings; ++r)
    for (int s = 0; s < kSectors; ++s) {
      const double theta = kPi * r / kRings, azimuth = 2 * kPi * s / kSectors;
      ball.positions.push_back(
          Vec3d(std::sin(theta) * std::sin(azimuth), std::cos(theta), std::sin(theta) * std::cos(azimuth))
              .cast<float>());
    }
  for (std::uint16_t r = 0; r < kRings; ++r)
    for (std::uint16_t s = 0; s < kSectors; ++s) {
      const auto a = static_cast<std::uint16_t>(r * kSectors + s);
      const auto b = static_cast<std::uint16_t>(r * kSectors + (s + 1) % kSectors);
      const auto below_a = static_cast<std::uint16_t>(a + kSectors),
                 below_b = static_cast<std::uint16_t>(b + kSectors);
      if (r > 0) ball.triangles.insert(ball.triangles.end(), {a, below_b, b});
      if (r + 1 < kRings) ball.triangles.insert(ball.triangles.end(), {a, below_a, below_b});
    }
  return ball;
}

}  // namespace

Material field_ball_material(const FieldBallsOptions& options) {
  Material m;
  m.model = options.mirror ? Material::Model::metallic_roughness : Material::Model::phong;
  m.metallic = 1;
  m.roughness = 0;
  return m;
}

Result<FieldBalls> FieldBalls::create(const FieldBallsOptions& options, std::size_t material, bool emission) {
  auto program = gl::make_program(
      "ball_vertex", "gbuffer_fragment",
      std::string("#define HAS_DETAIL 0\n#define HAS_EMISSION ") + (emission ? "1\n" : "0\n"));
  if (!program) return program.error();
  FieldBalls balls;
  balls.options_ = options;
  balls.material_ = material;
  balls.emission_ = emission;
  balls.program_ = std::move(program).value();
  const Ball ball = unit_ball();
  balls.vertex_array_ = gl::make_vertex_array();
  glBindVertexArray(balls.vertex_array_.id());
  balls.positions_ =
      gl::make_buffer(GL_ARRAY_BUFFER, ball.positions.data(), ball.positions.size() * sizeof(Vec3f));
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vec3f), nullptr);
  balls.indices_ = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, ball.triangles.data(),
                                   ball.triangles.size() * sizeof(std::uint16_t));
  balls.index_count_ = static_cast<GLsizei>(ball.triangles.size());
  glBindVertexArray(0);
  return balls;
}

void FieldBalls::set_grid(const FieldGrid& grid) {
  first_ = grid.low.cast<float>();
  for (std::size_t a = 0; a < 3; ++a) {
    shown_[a] = options_.most > 0 ? std::min(options_.most, grid.size[a]) : grid.size[a];
    const auto axis = static_cast<Eigen::Index>(a);
    step_[axis] = static_cast<float>((grid.high - grid.low)[axis] / (shown_[a] - 1));
  }
  radius_ = kRadiusOfStep * step_.minCoeff();
}

std::size_t FieldBalls::count() const {
  std::size_t count = 1;
  for (const int along : shown_) count *= static_cast<std::size_t>(along);
  return count;
}

void FieldBalls::draw(const View& view) const {
  const Uniforms balls(program_);
  glUniformMatrix4fv(balls.place("clip_from_world"), 1, GL_FALSE, view.clip_from_world.data());
  balls.set("first", first_.data());
  balls.set("step_m", step_.data());
  glUniform3iv(balls.place("shown"), 1, shown_.data());
  balls.set("radius", radius_);
  balls.set("material_number", static_cast<float>(material_ + 1));
  balls.set("in_shadow_map", 0.0f);
  if (emission_) balls.set("emission", Vec3f::Zero().eval().data());
  glEnable(GL_CULL_FACE);
  glCullFace(GL_BACK);
  glBindVertexArray(vertex_array_.id());
  glDrawElementsInstanced(GL_TRIANGLES, index_count_, GL_UNSIGNED_SHORT, nullptr,
                          static_cast<GLsizei>(count()));
  glDisable(GL_CULL_FACE);
}

}  // namespace lightwell::render
