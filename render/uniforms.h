// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/gl_objects.h"

namespace lightwell::render {

// Values for a program, which it makes current.
class Uniforms {
 public:
  explicit Uniforms(const gl::Program& program) : program_(program) { glUseProgram(program.id()); }
  [[nodiscard]] GLint place(const char* name) const { return gl::uniform(program_, name); }
  void set(const char* name, int value) const { glUniform1i(place(name), value); }
  void set(const char* name, float value) const { glUniform1f(place(name), value); }
  void set(const char* name, const float* vector) const { glUniform3fv(place(name), 1, vector); }
  void set_texture(const char* name, int unit, GLuint texture) const {
    gl::bind_texture(unit, texture);
    set(name, unit);
  }

 private:
  const gl::Program& program_;
};

}  // namespace lightwell::render
