// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gbuffer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace lightwell::render {
namespace {

constexpr int kMaterialRow = 1024;

gl::Texture upload(const TextureImage& image, GLenum format) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  const int levels = 1 + static_cast<int>(std::floor(std::log2(std::max(image.width, image.height))));
  glTexStorage2D(GL_TEXTURE_2D, levels, format, image.width, image.height);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, GL_RGBA, GL_UNSIGNED_BYTE,
                  image.rgba.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return gl::Texture(id);
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

Result<GBuffer> GBuffer::create(const Scene& scene, const Casters& casters) {
  GBuffer g;
  auto program = gl::make_program("scene_vertex", "gbuffer_fragment");
  if (!program) return program.error();
  g.program_ = std::move(program).value();
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  for (const TextureImage& image : scene.textures) {
    if (image.width > limit || image.height > limit)
      return Error{ErrorKind::bad_input, "a texture of " + std::to_string(image.width) + "x" +
                                             std::to_string(image.height) + " is larger than this driver's " +
                                             std::to_string(limit)};
    g.textures_.push_back(upload(image, GL_SRGB8_ALPHA8));
    g.textures_.push_back(upload(image, GL_RGBA8));
  }
  g.textures_.push_back(upload({1, 1, {255, 255, 255, 255}}, GL_RGBA8));
  g.materials_ = upload_materials(scene.materials);
  const GLuint white = g.textures_.back().id();
  const auto texture = [&](const TextureUse& use, int kind) {
    return use ? g.textures_[static_cast<std::size_t>(use.texture * 2 + kind)].id() : white;
  };
  for (std::size_t i = 0; i < scene.primitives.size(); ++i) {
    const Primitive& p = scene.primitives[i];
    const Material& m = scene.materials[static_cast<std::size_t>(p.material)];
    const float in_shadow_map = !p.casts_shadow ? 0.0f : casters.is_support[i] ? 0.5f : 1.0f;
    g.draws_.push_back({p, in_shadow_map, texture(m.base_color_texture, 0),
                        texture(m.metallic_roughness_texture, 1), m.double_sided || p.turns_inside_out});
  }
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
  auto framebuffer = gl::make_framebuffer({position_material_.id(), surface_.id()}, depth_.id());
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
  glUseProgram(program_.id());
  glUniformMatrix4fv(gl::uniform(program_, "clip_from_world"), 1, GL_FALSE, view.clip_from_world.data());
  glUniform1i(gl::uniform(program_, "base_color_map"), 0);
  glUniform1i(gl::uniform(program_, "metallic_roughness_map"), 1);
  const GLint material_number = gl::uniform(program_, "material_number");
  const GLint in_shadow_map = gl::uniform(program_, "in_shadow_map");
  glBindVertexArray(vertex_array_.id());
  glCullFace(GL_BACK);
  for (const Draw& draw : draws_) {
    if (draw.double_sided)
      glDisable(GL_CULL_FACE);
    else
      glEnable(GL_CULL_FACE);
    gl::bind_texture(0, draw.base_color);
    gl::bind_texture(1, draw.metallic_roughness);
    glUniform1f(material_number, static_cast<float>(draw.primitive.material + 1));
    glUniform1f(in_shadow_map, draw.in_shadow_map);
    const auto offset = static_cast<std::uintptr_t>(draw.primitive.first_index) * sizeof(std::uint32_t);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(draw.primitive.index_count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(offset));
  }
  glDisable(GL_CULL_FACE);
}

}  // namespace lightwell::render
