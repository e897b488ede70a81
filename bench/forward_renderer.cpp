// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "bench/forward_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>

#include "render/casters.h"
#include "render/read_back.h"

namespace lightwell::bench {
namespace {

namespace gl = render::gl;

constexpr std::size_t kMostLights = 256;  // 16 KB of uniform block

// As the shaders see it: rows that map a world position into the light's map, [0, 1] for every caster.
struct LightRow {
  float u[4], v[4], w[4];
  float illuminance[3];
  float extent_m;  // of the map
};

LightRow light_row(const DirectionalLight& light, const render::Sphere& casters) {
  LightRow row{};
  const Vec3f u = light.direction.unitOrthogonal();
  const Vec3f v = light.direction.cross(u);
  row.extent_m = 2.04f * casters.radius;  // a border that stays empty
  const auto set = [&](float(&out)[4], const Vec3f& axis) {
    for (int i = 0; i < 3; ++i) out[i] = axis[i] / row.extent_m;
    out[3] = 0.5f - axis.dot(casters.centre) / row.extent_m;
  };
  set(row.u, u);
  set(row.v, v);
  set(row.w, -light.direction);
  std::copy_n(light.illuminance.data(), 3, row.illuminance);
  return row;
}

constexpr const char* kLights = R"(#version 310 es
precision highp float;
precision highp int;
precision highp sampler2DShadow;
struct Light { vec4 u, v, w, illuminance; };
layout(std140) uniform Lights { Light lights[256]; };
)";
constexpr const char* kMapVertex = R"(
layout(location = 0) in vec3 position;
uniform int tiles;
void main() {
  Light light = lights[gl_InstanceID];
  vec4 p = vec4(position, 1.0);
  vec2 tile = vec2(gl_InstanceID % tiles, gl_InstanceID / tiles);
  vec2 place = (tile + vec2(dot(light.u, p), dot(light.v, p))) / float(tiles);
  gl_Position = vec4(place * 2.0 - 1.0, dot(light.w, p) * 2.0 - 1.0, 1.0);
}
)";
constexpr const char* kMapFragment = "void main() {}\n";
constexpr const char* kSurfaceVertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 clip_from_world;
out vec3 world;
out vec3 world_normal;
void main() {
  world = position;
  world_normal = normal;
  gl_Position = clip_from_world * vec4(position, 1.0);
}
)";
constexpr const char* kSurfaceFragment = R"(
in vec3 world;
in vec3 world_normal;
uniform int light_count;
uniform int tiles;
uniform float map_size;
uniform vec3 albedo;
uniform sampler2DShadow maps;
out vec4 radiance;
void main() {
  vec3 n = normalize(world_normal);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < light_count; ++i) {
    Light light = lights[i];
    float size = light.illuminance.w;
    vec3 to_light = light.w.xyz * -size;
    float cosine = max(dot(n, to_light), 0.0);
    // A texel and a half along the normal, more the more the surface slants.
    vec4 p = vec4(world + n * (size / map_size * (1.5 * sqrt(1.0 - cosine * cosine) + 0.2)), 1.0);
    vec2 place = vec2(dot(light.u, p), dot(light.v, p));
    vec2 inside = clamp(place, 0.5 / map_size, 1.0 - 0.5 / map_size);
    vec2 at = (vec2(i % tiles, i / tiles) + inside) / float(tiles);
    float lit = textureLod(maps, vec3(at, min(dot(light.w, p), 1.0)), 0.0);
    sum += light.illuminance.rgb * (cosine * (inside == place ? lit : 1.0));
  }
  radiance = vec4(albedo / 3.14159265 * sum, 1.0);
}
)";

Result<gl::Program> program_of(const std::string& vertex, const std::string& fragment) {
  gl::Program program(glCreateProgram());
  for (const auto& [kind, text] : {std::pair<GLenum, std::string>(GL_VERTEX_SHADER, kLights + vertex),
                                   std::pair<GLenum, std::string>(GL_FRAGMENT_SHADER, kLights + fragment)}) {
    const GLuint shader = glCreateShader(kind);
    const char* source = text.c_str();
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    glAttachShader(program.id(), shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program.id());
  GLint linked = 0;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &linked);
  if (linked != 0) return program;
  char log[1024] = "";
  glGetProgramInfoLog(program.id(), sizeof log, nullptr, log);
  return Error{ErrorKind::failed, std::string("forward peer: ") + log};
}

}  // namespace

Result<ForwardRenderer> ForwardRenderer::create(const render::Scene& scene, int width, int height,
                                                int shadow_size) {
  ForwardRenderer r;
  r.width_ = width;
  r.height_ = height;
  r.map_size_ = shadow_size;
  r.primitives_ = scene.primitives;
  std::vector<std::uint32_t> casting;
  std::vector<Vec3f> points;
  for (const render::Primitive& p : scene.primitives) {
    r.albedos_.push_back(scene.materials[static_cast<std::size_t>(p.material)].base_color);
    if (p.casts_shadow)
      casting.insert(casting.end(), scene.indices.begin() + p.first_index,
                     scene.indices.begin() + p.first_index + p.index_count);
  }
  for (const std::uint32_t i : casting) points.push_back(scene.vertices[i].position);
  r.casters_ = render::bounding_sphere(points);
  r.caster_indices_ = static_cast<GLsizei>(casting.size());
  auto maps = program_of(kMapVertex, kMapFragment);
  if (!maps) return maps.error();
  r.maps_program_ = std::move(maps).value();
  auto surface = program_of(kSurfaceVertex, kSurfaceFragment);
  if (!surface) return surface.error();
  r.surface_program_ = std::move(surface).value();
  for (const gl::Program* program : {&r.maps_program_, &r.surface_program_})
    if (const GLuint block = glGetUniformBlockIndex(program->id(), "Lights"); block != GL_INVALID_INDEX)
      glUniformBlockBinding(program->id(), block, 0);

  const auto vertex_array = [&](const std::vector<std::uint32_t>& indices, gl::Buffer& buffer) {
    gl::VertexArray array = gl::make_vertex_array();
    glBindVertexArray(array.id());
    if (r.vertices_.id() == 0)
      r.vertices_ = gl::make_buffer(GL_ARRAY_BUFFER, scene.vertices.data(),
                                    scene.vertices.size() * sizeof(render::Vertex));
    glBindBuffer(GL_ARRAY_BUFFER, r.vertices_.id());
    for (const auto& [place, offset] : {std::pair(0u, offsetof(render::Vertex, position)),
                                        std::pair(1u, offsetof(render::Vertex, normal))}) {
      glEnableVertexAttribArray(place);
      glVertexAttribPointer(place, 3, GL_FLOAT, GL_FALSE, sizeof(render::Vertex),
                            reinterpret_cast<const void*>(offset));
    }
    buffer = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, indices.data(), indices.size() * sizeof(indices[0]));
    glBindVertexArray(0);
    return array;
  };
  r.vertices_array_ = vertex_array(scene.indices, r.indices_);
  r.casters_array_ = vertex_array(casting, r.caster_indices_buffer_);
  r.lights_ = gl::make_buffer(GL_UNIFORM_BUFFER, nullptr, kMostLights * sizeof(LightRow), GL_DYNAMIC_DRAW);

  r.maps_ = gl::make_texture(GL_DEPTH_COMPONENT16, kTiles * shadow_size, kTiles * shadow_size);
  for (const GLenum filter : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  auto maps_target = gl::make_framebuffer({}, r.maps_.id());
  if (!maps_target) return maps_target.error();
  r.maps_target_ = std::move(maps_target).value();
  r.colour_ = gl::make_texture(GL_RGBA32F, width, height);
  r.depth_ = gl::make_texture(GL_DEPTH_COMPONENT24, width, height);
  auto target = gl::make_framebuffer({r.colour_.id()}, r.depth_.id());
  if (!target) return target.error();
  r.target_ = std::move(target).value();
  return r;
}

void ForwardRenderer::draw_maps(int count) {
  glBindFramebuffer(GL_FRAMEBUFFER, maps_target_.id());
  glViewport(0, 0, kTiles * map_size_, kTiles * map_size_);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(maps_program_.id());
  glUniform1i(gl::uniform(maps_program_, "tiles"), kTiles);
  glBindVertexArray(casters_array_.id());
  glDrawElementsInstanced(GL_TRIANGLES, caster_indices_, GL_UNSIGNED_INT, nullptr, count);
}

void ForwardRenderer::render(const LightSet& lights, const render::SceneCamera& camera) {
  std::vector<LightRow> rows;
  for (const DirectionalLight& light : lights.lights)
    if (rows.size() < kMostLights) rows.push_back(light_row(light, casters_));
  const auto count = static_cast<int>(rows.size());
  glBindBuffer(GL_UNIFORM_BUFFER, lights_.id());
  glBufferSubData(GL_UNIFORM_BUFFER, 0, static_cast<GLsizeiptr>(rows.size() * sizeof(rows[0])), rows.data());
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, lights_.id());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_CULL_FACE);
  draw_maps(count);

  glBindFramebuffer(GL_FRAMEBUFFER, target_.id());
  glViewport(0, 0, width_, height_);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glUseProgram(surface_program_.id());
  const render::View view = render::make_view(camera, width_, height_);
  glUniformMatrix4fv(gl::uniform(surface_program_, "clip_from_world"), 1, GL_FALSE,
                     view.clip_from_world.data());
  glUniform1i(gl::uniform(surface_program_, "light_count"), count);
  glUniform1i(gl::uniform(surface_program_, "tiles"), kTiles);
  glUniform1f(gl::uniform(surface_program_, "map_size"), static_cast<float>(map_size_));
  glUniform1i(gl::uniform(surface_program_, "maps"), 0);
  gl::bind_texture(0, maps_.id());
  glBindVertexArray(vertices_array_.id());
  for (std::size_t i = 0; i < primitives_.size(); ++i) {
    glUniform3fv(gl::uniform(surface_program_, "albedo"), 1, albedos_[i].data());
    glDrawElements(
        GL_TRIANGLES, static_cast<GLsizei>(primitives_[i].index_count), GL_UNSIGNED_INT,
        reinterpret_cast<const void*>(std::uintptr_t{primitives_[i].first_index} * sizeof(std::uint32_t)));
  }
  glBindVertexArray(0);
}

render::RadiancePicture ForwardRenderer::radiance() const {
  return {width_, height_, render::read_back<float>(target_.id(), width_, height_)};
}

}  // namespace lightwell::bench
