// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <GLES3/gl31.h>

#include <string>
#include <utility>
#include <vector>

#include "lighting/result.h"

// OpenGL ES objects that delete themselves. They need the context they were made in to be current.
namespace lightwell::render::gl {

template <void (*Destroy)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint id) : id_(id) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle() {
    if (id_ != 0) Destroy(id_);
  }
  [[nodiscard]] GLuint id() const { return id_; }

 private:
  GLuint id_ = 0;
};

inline void destroy_texture(GLuint id) {
  glDeleteTextures(1, &id);
}
inline void destroy_buffer(GLuint id) {
  glDeleteBuffers(1, &id);
}
inline void destroy_framebuffer(GLuint id) {
  glDeleteFramebuffers(1, &id);
}
inline void destroy_vertex_array(GLuint id) {
  glDeleteVertexArrays(1, &id);
}
inline void destroy_program(GLuint id) {
  glDeleteProgram(id);
}

using Texture = Handle<destroy_texture>;
using Buffer = Handle<destroy_buffer>;
using Framebuffer = Handle<destroy_framebuffer>;
using VertexArray = Handle<destroy_vertex_array>;
using Program = Handle<destroy_program>;

// Immutable storage, one level, nearest, clamped.
Texture make_texture(GLenum format, int width, int height);
// Colour attachments in order; depth 0: none. Failed where the driver cannot render to them.
Result<Framebuffer> make_framebuffer(const std::vector<GLuint>& colour, GLuint depth);
Buffer make_buffer(GLenum target, const void* data, std::size_t bytes, GLenum usage = GL_STATIC_DRAW);
VertexArray make_vertex_array();

// Compiles render/shaders/<vertex>.glsl and <fragment>.glsl. defines: lines put before both.
Result<Program> make_program(const std::string& vertex, const std::string& fragment,
                             const std::string& defines = "");
Result<Program> make_compute_program(const std::string& compute);

inline GLint uniform(const Program& program, const char* name) {
  return glGetUniformLocation(program.id(), name);
}
void bind_texture(int unit, GLuint texture);

}  // namespace lightwell::render::gl
