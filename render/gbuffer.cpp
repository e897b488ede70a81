// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gbuffer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace lightwell::render {
namespace {

constexpr int kMaterialRow = 1024;

gl::Texture upload(const TextureImage& image, GLenum format) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  const bool has_levels = image.min_filter != GL_NEAREST && image.min_filter != GL_LINEAR;
  const int levels =
      has_levels ? 1 + static_cast<int>(std::floor(std::log2(std::max(image.width, image.height)))) : 1;
  glTexStorage2D(GL_TEXTURE_2D, levels, format, image.width, image.height);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                  image.rgba.data());
  if (has_levels) glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, image.min_filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, image.mag_filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, image.wrap_u);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, image.wrap_v);
  return gl::Texture(id);
}

bool has_vertex_colors(const Scene& scene, const Primitive& p) {
  for (std::uint32_t i = p.first_index; i < p.first_index + p.index_count; ++i)
    if (scene.vertices[scene.indices[i]].color != Vertex().color) return true;
  return false;
}

bool needs_detail(const Scene& scene, const Primitive& p, const Material& m) {
  return m.base_color_texture || m.metallic_roughness_texture || m.normal_texture || m.emission_texture ||
         m.alpha_cutoff > 0 || has_vertex_colors(scene, p);
}

gl::Texture upload_materials(const std::vector<Material>& materials) {
  const int rows =
      std::max<int>(1, (static_cast<int>(materials.size()) * 2 + kMaterialRow - 1) / kMaterialRow);
  std::vector<float> texels(static_cast<std::size_t>(rows * kMaterialRow) * 4, 0.0f);
  float* out = texels.data();
  for (const Material& m : materials) {
    const bool phong = m.model == Material::Model::phong;
    const float row[8] = {m.base_color[0],
                          m.base_color[1],
                          m.base_color[2],
                          phong ? 1.0f : 0.0f,
                          phong ? m.specular[0] : m.metallic,
                          phong ? m.specular[1] : m.roughness,
                          phong ? m.specular[2] : 0.0f,
                          phong ? m.exponent : 0.0f};
    out = std::copy_n(row, 8, out);
  }
  gl::Texture texture = gl::make_texture(GL_RGBA32F, kMaterialRow, rows);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kMaterialRow, rows, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

}  // namespace

Result<GBuffer::Program> GBuffer::make_program(bool detail) const {
  auto made = gl::make_program("scene_vertex", "gbuffer_fragment",
                               std::string("#define HAS_DETAIL ") + (detail ? "1" : "0") +
                                   "\n#define HAS_EMISSION " + (emits_ ? "1" : "0") + "\n");
  if (!made) return made.error();
  Program p;
  p.program = std::move(made).value();
  p.material_number = gl::uniform(p.program, "material_number");
  p.in_shadow_map = gl::uniform(p.program, "in_shadow_map");
  return p;
}

// Colours are stored as sRGB, everything else as it is; a texture may be used as both.
Status GBuffer::make_textures(const Scene& scene) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  textures_.push_back(upload({1, 1, {255, 255, 255, 255}}, GL_RGBA8));
  const GLuint white = textures_.back().id();
  std::map<std::pair<int, GLenum>, GLuint> made;
  const auto texture = [&](const TextureUse& use, GLenum format) {
    if (!use) return white;
    const auto [place, is_new] = made.try_emplace({use.texture, format}, 0);
    if (is_new) {
      textures_.push_back(upload(scene.textures[static_cast<std::size_t>(use.texture)], format));
      place->second = textures_.back().id();
    }
    return place->second;
  };
  for (const TextureImage& image : scene.textures)
    if (image.width > limit || image.height > limit)
      return Error{ErrorKind::bad_input, "a texture of " + std::to_string(image.width) + "x" +
                                             std::to_string(image.height) + " is larger than this driver's " +
                                             std::to_string(limit)};
  for (Draw& draw : draws_) {
    draw.base_color = texture(draw.material.base_color_texture, GL_SRGB8_ALPHA8);
    draw.metallic_roughness = texture(draw.material.metallic_roughness_texture, GL_RGBA8);
    draw.normal = texture(draw.material.normal_texture, GL_RGBA8);
    draw.emission = texture(draw.material.emission_texture, GL_SRGB8_ALPHA8);
  }
  return {};
}

Result<GBuffer> GBuffer::create(const Scene& scene, const Casters& casters) {
  GBuffer g;
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    Draw& draw = g.draws_.emplace_back();
    draw.primitive = p;
    draw.material = scene.materials[static_cast<std::size_t>(p.material)];
    draw.in_shadow_map = !p.casts_shadow ? 0.0f : casters.is_support[i] ? 0.5f : 1.0f;
    draw.detail = needs_detail(scene, p, draw.material);
    g.emits_ = g.emits_ || (draw.material.emission > 0).any();
  }
  for (const bool detail : {false, true}) {
    auto program = g.make_program(detail);
    if (!program) return program.error();
    (detail ? g.detail_ : g.plain_) = std::move(program).value();
  }
  if (Status s = g.make_textures(scene); !s) return s.error();
  g.materials_ = upload_materials(scene.materials);
  g.vertex_array_ = gl::make_vertex_array();
  glBindVertexArray(g.vertex_array_.id());
  g.vertices_ =
      gl::make_buffer(GL_ARRAY_BUFFER, scene.vertices.data(), scene.vertices.size() * sizeof(Vertex),
                      scene.rig.moves() ? GL_DYNAMIC_DRAW : GL_STATIC_DRAW);
  const auto attribute = [](GLuint index, GLint components, std::size_t offset) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, components, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                          reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 2, offsetof(Vertex, uv));
  glEnableVertexAttribArray(3);
  glVertexAttribPointer(3, 4, GL_UNSIGNED_SHORT, GL_TRUE, sizeof(Vertex),
                        reinterpret_cast<const void*>(offsetof(Vertex, color)));
  g.indices_ = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, scene.indices.data(),
                               scene.indices.size() * sizeof(scene.indices[0]));
  glBindVertexArray(0);
  return g;
}

void GBuffer::move(const Scene& scene, std::span<const std::size_t> moved) {
  glBindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  for (const std::size_t i : moved) {
    const Primitive& p = scene.primitives[i];
    glBufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(p.first_vertex * sizeof(Vertex)),
                    static_cast<GLsizeiptr>(p.vertex_count * sizeof(Vertex)),
                    &scene.vertices[p.first_vertex]);
  }
}

Status GBuffer::resize(int width, int height) {
  if (width == width_ && height == height_) return {};
  width_ = width;
  height_ = height;
  position_material_ = gl::make_texture(GL_RGBA32F, width, height);
  surface_ = gl::make_texture(GL_RGBA32UI, width, height);
  depth_ = gl::make_texture(GL_DEPTH_COMPONENT24, width, height);
  std::vector<GLuint> colour = {position_material_.id(), surface_.id()};
  if (emits_) {
    emission_ = gl::make_texture(GL_RGBA32F, width, height);  // halves end at 65504 cd/m²
    colour.push_back(emission_.id());
  }
  auto framebuffer = gl::make_framebuffer(colour, depth_.id());
  if (!framebuffer) return framebuffer.error();
  framebuffer_ = std::move(framebuffer).value();
  return {};
}

void GBuffer::draw(const View& view) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  glViewport(0, 0, width_, height_);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  const float nothing[4] = {0, 0, 0, 0};
  const GLuint no_surface[4] = {0, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, nothing);
  glClearBufferuiv(GL_COLOR, 1, no_surface);
  glClear(GL_DEPTH_BUFFER_BIT);
  if (emits_) glClearBufferfv(GL_COLOR, 2, nothing);
  glBindVertexArray(vertex_array_.id());
  glCullFace(GL_BACK);
  for (const Program* program : {&plain_, &detail_}) {
    const bool detail = program == &detail_;
    glUseProgram(program->program.id());
    glUniformMatrix4fv(gl::uniform(program->program, "clip_from_world"), 1, GL_FALSE,
                       view.clip_from_world.data());
    for (const Draw& draw : draws_) {
      if (draw.detail != detail) continue;
      if (draw.material.double_sided || draw.primitive.turns_inside_out)
        glDisable(GL_CULL_FACE);
      else
        glEnable(GL_CULL_FACE);
      glUniform1f(program->material_number, static_cast<float>(draw.primitive.material + 1));
      glUniform1f(program->in_shadow_map, draw.in_shadow_map);
      if (emits_) glUniform3fv(gl::uniform(program->program, "emission"), 1, draw.material.emission.data());
      if (detail) set_detail(draw);
      const auto offset = static_cast<std::uintptr_t>(draw.primitive.first_index) * sizeof(std::uint32_t);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(draw.primitive.index_count), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(offset));
    }
  }
  glDisable(GL_CULL_FACE);
}

void GBuffer::set_detail(const Draw& draw) const {
  const gl::Program& program = detail_.program;
  const Material& m = draw.material;
  const auto use = [&](int unit, const char* name, GLuint id, const TextureUse& texture) {
    gl::bind_texture(unit, id);
    glUniform1i(gl::uniform(program, (std::string(name) + "_map").c_str()), unit);
    glUniform3fv(gl::uniform(program, (std::string(name) + "_uv").c_str()), 2, texture.from_uv.data());
  };
  use(0, "base_color", draw.base_color, m.base_color_texture);
  use(1, "metallic_roughness", draw.metallic_roughness, m.metallic_roughness_texture);
  use(2, "normal", draw.normal, m.normal_texture);
  use(3, "emission", draw.emission, m.emission_texture);
  glUniform1f(gl::uniform(program, "normal_scale"), m.normal_texture ? m.normal_scale : 0.0f);
  glUniform1f(gl::uniform(program, "alpha"), m.alpha);
  glUniform1f(gl::uniform(program, "alpha_cutoff"), m.alpha_cutoff);
}

}  // namespace lightwell::render
