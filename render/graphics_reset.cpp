// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/graphics_reset.h"

#include <EGL/egl.h>
#include <GLES2/gl2ext.h>

#include <string_view>

namespace lightwell::render {
namespace {

constexpr const char* kStartAgain = "; it must be started again";

bool has_extension(std::string_view wanted) {
  GLint count = 0;
  glGetIntegerv(GL_NUM_EXTENSIONS, &count);
  for (GLint i = 0; i < count; ++i) {
    const auto* name = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
    if (name != nullptr && wanted == name) return true;
  }
  return false;
}

GraphicsReset::StatusQuery driver_query() {
  for (const auto& [extension, function] : {std::pair("GL_EXT_robustness", "glGetGraphicsResetStatusEXT"),
                                            std::pair("GL_KHR_robustness", "glGetGraphicsResetStatusKHR")})
    if (has_extension(extension))
      return reinterpret_cast<GraphicsReset::StatusQuery>(eglGetProcAddress(function));
  return nullptr;
}

Error lost(const char* why) {
  return {ErrorKind::failed, std::string("the OpenGL ES context is lost: ") + why + kStartAgain};
}

}  // namespace

GraphicsReset::GraphicsReset() : status_(driver_query()), error_([]() -> GLenum { return glGetError(); }) {}

Status GraphicsReset::check() const {
  const GLenum status = status_ != nullptr ? status_() : GLenum{GL_NO_ERROR};
  if (status == GL_GUILTY_CONTEXT_RESET_EXT)
    return lost("the graphics driver was reset because of this program");
  if (status == GL_INNOCENT_CONTEXT_RESET_EXT) return lost("another program made the graphics driver reset");
  if (status != GL_NO_ERROR) return lost("the graphics driver was reset");
  const GLenum error = error_();
  if (error == GL_CONTEXT_LOST_KHR) return lost("the graphics driver was reset");
  if (error != GL_NO_ERROR) return Error{ErrorKind::failed, "the OpenGL ES driver failed (out of memory?)"};
  return {};
}

}  // namespace lightwell::render
