// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/egl_context.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <utility>

#include "render/egl_es31.h"

namespace lightwell::render {
namespace {

// Mesa's surfaceless platform first; NVIDIA's driver offers devices instead; then whatever EGL takes as its
// default.
EGLDisplay open_display() {
  const auto platform_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  const auto try_display = [](EGLDisplay display) {
    return display != EGL_NO_DISPLAY && eglInitialize(display, nullptr, nullptr) == EGL_TRUE;
  };
  if (platform_display != nullptr) {
    const EGLDisplay surfaceless =
        platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (try_display(surfaceless)) return surfaceless;
    const auto query_devices =
        reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(eglGetProcAddress("eglQueryDevicesEXT"));
    EGLDeviceEXT device = nullptr;
    EGLint count = 0;
    if (query_devices != nullptr && query_devices(1, &device, &count) == EGL_TRUE && count > 0) {
      const EGLDisplay on_device = platform_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
      if (try_display(on_device)) return on_device;
    }
  }
  const EGLDisplay standard = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  return try_display(standard) ? standard : EGL_NO_DISPLAY;
}

}  // namespace

Result<EglContext> EglContext::create() {
  const EGLDisplay display = open_display();
  if (display == EGL_NO_DISPLAY)
    return Error{ErrorKind::failed,
                 "no EGL driver for off-screen rendering (packages libegl-mesa0, libgl1-mesa-dri)"};
  const EGLContext context = create_es31_context(display, EGL_NO_CONFIG_KHR);
  EglContext result(display, context);
  if (context == EGL_NO_CONTEXT ||
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE)
    return Error{ErrorKind::failed, "this machine's EGL driver has no OpenGL ES 3.1 without a window"};
  return result;
}

EglContext::EglContext(EglContext&& other) noexcept
    : display_(std::exchange(other.display_, nullptr)), context_(std::exchange(other.context_, nullptr)) {}

EglContext& EglContext::operator=(EglContext&& other) noexcept {
  std::swap(display_, other.display_);
  std::swap(context_, other.context_);
  return *this;
}

EglContext::~EglContext() {
  if (display_ == nullptr) return;
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_ != nullptr) eglDestroyContext(display_, context_);
  eglTerminate(display_);
}

}  // namespace lightwell::render
