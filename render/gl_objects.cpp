// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gl_objects.h"

#include <algorithm>
#include <string_view>

#include "render/shaders.h"

namespace lightwell::render::gl {
namespace {

constexpr std::string_view kHeader =
    "#version 310 es\n"
    "precision highp float;\nprecision highp int;\n"
    "precision highp sampler2D;\nprecision highp sampler2DShadow;\nprecision highp usampler2D;\n"
    "precision highp sampler3D;\nprecision highp sampler2DArray;\n";

Error shader_error(const std::string& name, std::string log) {
  std::replace(log.begin(), log.end(), '\n', ' ');
  return {ErrorKind::failed, "shader " + name + ": " + log};
}

Status attach(const Program& program, GLenum kind, const std::string& name, const std::string& defines) {
  const std::string text = std::string(kHeader) + defines + std::string(shader_text(name + ".glsl"));
  const GLuint shader = glCreateShader(kind);
  const char* source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  char log[2048] = "";
  if (good == 0) glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  glAttachShader(program.id(), shader);
  glDeleteShader(shader);  // lives as long as the program
  if (good == 0) return shader_error(name, log);
  return {};
}

Status link(const Program& program, const std::string& name) {
  glLinkProgram(program.id());
  GLint good = 0;
  glGetProgramiv(program.id(), GL_LINK_STATUS, &good);
  if (good != 0) return {};
  char log[2048] = "";
  glGetProgramInfoLog(program.id(), sizeof log, nullptr, log);
  return shader_error(name, log);
}

}  // namespace

Texture make_texture(GLenum format, int width, int height) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
  for (const GLenum filter : {GLenum{GL_TEXTURE_MIN_FILTER}, GLenum{GL_TEXTURE_MAG_FILTER}})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  for (const GLenum wrap : {GLenum{GL_TEXTURE_WRAP_S}, GLenum{GL_TEXTURE_WRAP_T}})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  return Texture(id);
}

Result<Framebuffer> make_framebuffer(const std::vector<GLuint>& colour, GLuint depth) {
  GLuint id = 0;
  glGenFramebuffers(1, &id);
  Framebuffer framebuffer(id);
  glBindFramebuffer(GL_FRAMEBUFFER, id);
  std::vector<GLenum> targets;
  for (const GLuint texture : colour) {
    targets.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(targets.size()));
    glFramebufferTexture2D(GL_FRAMEBUFFER, targets.back(), GL_TEXTURE_2D, texture, 0);
  }
  if (depth != 0) glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
  if (targets.empty()) targets.push_back(GL_NONE);
  glDrawBuffers(static_cast<GLsizei>(targets.size()), targets.data());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Error{ErrorKind::failed,
                 "this OpenGL ES driver cannot render to float textures (EXT_color_buffer_float)"};
  return framebuffer;
}

Buffer make_buffer(GLenum target, const void* data, std::size_t bytes, GLenum usage) {
  GLuint id = 0;
  glGenBuffers(1, &id);
  glBindBuffer(target, id);
  glBufferData(target, static_cast<GLsizeiptr>(bytes), data, usage);
  return Buffer(id);
}

VertexArray make_vertex_array() {
  GLuint id = 0;
  glGenVertexArrays(1, &id);
  return VertexArray(id);
}

Result<Program> make_program(const std::string& vertex, const std::string& fragment,
                             const std::string& defines) {
  Program program(glCreateProgram());
  if (Status s = attach(program, GL_VERTEX_SHADER, vertex, defines); !s) return s.error();
  if (Status s = attach(program, GL_FRAGMENT_SHADER, fragment, defines); !s) return s.error();
  if (Status s = link(program, fragment); !s) return s.error();
  return program;
}

Result<Program> make_compute_program(const std::string& compute) {
  Program program(glCreateProgram());
  if (Status s = attach(program, GL_COMPUTE_SHADER, compute, ""); !s) return s.error();
  if (Status s = link(program, compute); !s) return s.error();
  return program;
}

void bind_texture(int unit, GLuint texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, texture);
}

}  // namespace lightwell::render::gl
