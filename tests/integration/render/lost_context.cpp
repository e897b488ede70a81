// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
// Preloaded, it makes of the driver one that loses the context after a number of frames, which LIGHTWELL_FRAMES says: no
// driver of software does that.
#include <EGL/egl.h>
#include <GLES3/gl31.h>
#include <dlfcn.h>

#include <cstdlib>
#include <cstring>

namespace {

GLenum status_after_frames() {
  static int asked = 0;
  const char* frames = std::getenv("LIGHTWELL_FRAMES");
  // A frame is checked twice.
  return ++asked > 2 * std::atoi(frames != nullptr ? frames : "0") ? 0x8254 /* GL_INNOCENT_CONTEXT_RESET */
                                                                   : 0;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) __eglMustCastToProperFunctionPointerType eglGetProcAddress(
    const char* name) {
  if (std::strncmp(name, "glGetGraphicsResetStatus", 24) == 0)
    return reinterpret_cast<__eglMustCastToProperFunctionPointerType>(status_after_frames);
  using Get = __eglMustCastToProperFunctionPointerType (*)(const char*);
  return reinterpret_cast<Get>(dlsym(RTLD_NEXT, "eglGetProcAddress"))(name);
}
