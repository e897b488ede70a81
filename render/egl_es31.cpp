// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/egl_es31.h"

#include <EGL/eglext.h>

#include <string_view>

namespace lightwell::render {

EGLContext create_es31_context(EGLDisplay display, EGLConfig config) {
  eglBindAPI(EGL_OPENGL_ES_API);
  const EGLint telling[] = {EGL_CONTEXT_MAJOR_VERSION,
                            3,
                            EGL_CONTEXT_MINOR_VERSION,
                            1,
                            EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY_EXT,
                            EGL_LOSE_CONTEXT_ON_RESET_EXT,
                            EGL_NONE};
  const EGLint plain[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 1, EGL_NONE};
  const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
  if (extensions != nullptr &&
      std::string_view(extensions).find("EGL_EXT_create_context_robustness") != std::string_view::npos) {
    const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, telling);
    if (context != EGL_NO_CONTEXT) return context;
  }
  return eglCreateContext(display, config, EGL_NO_CONTEXT, plain);
}

}  // namespace lightwell::render
