// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <EGL/egl.h>

namespace lightwell::render {

// A context of OpenGL ES 3.1 that tells when it is lost (GraphicsReset) where the driver can; EGL_NO_CONTEXT where there is
// none. config: EGL_NO_CONFIG_KHR without a surface
EGLContext create_es31_context(EGLDisplay display, EGLConfig config);

}  // namespace lightwell::render
