// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/kms_screen.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fcntl.h>
#include <gbm.h>
#include <poll.h>
#include <unistd.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "render/egl_es31.h"
#include "render/kms_output.h"

namespace lightwell::render {
namespace {

template <class T, void (*Free)(T*)>
using Owned = std::unique_ptr<T, std::integral_constant<void (*)(T*), Free>>;
using Resources = Owned<drmModeRes, drmModeFreeResources>;
using Connector = Owned<drmModeConnector, drmModeFreeConnector>;
using Encoder = Owned<drmModeEncoder, drmModeFreeEncoder>;
using Crtc = Owned<drmModeCrtc, drmModeFreeCrtc>;

constexpr std::uint32_t kFormat = GBM_FORMAT_XRGB8888;

Error failure(const std::filesystem::path& device, const std::string& what) {
  return {ErrorKind::failed, "screen of " + device.string() + ": " + what};
}

Result<KmsTable> read_table(int device) {
  const Resources resources(drmModeGetResources(device));
  if (!resources)
    return Error{ErrorKind::failed, std::string("it has no mode setting: ") + std::strerror(errno)};
  KmsTable table;
  table.controllers.assign(resources->crtcs, resources->crtcs + resources->count_crtcs);
  for (int i = 0; i < resources->count_connectors; ++i) {
    const Connector connector(drmModeGetConnector(device, resources->connectors[i]));
    if (!connector) continue;
    KmsTable::Connector& entry = table.connectors.emplace_back();
    entry.id = connector->connector_id;
    entry.connected = connector->connection == DRM_MODE_CONNECTED;
    entry.modes.assign(connector->modes, connector->modes + connector->count_modes);
    for (int k = 0; k < connector->count_encoders; ++k)
      if (const Encoder encoder(drmModeGetEncoder(device, connector->encoders[k])); encoder)
        entry.encoder_controllers.push_back(encoder->possible_crtcs);
  }
  return table;
}

class Screen final : public KmsScreen {
 public:
  Screen(std::filesystem::path name, int device) : name_(std::move(name)), device_(device) {}
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  ~Screen() override {
    wait_for_flip();
    if (before_ && shown_ != nullptr)
      drmModeSetCrtc(device_, before_->crtc_id, before_->buffer_id, before_->x, before_->y,
                     &output_.connector, 1, &before_->mode);
    if (display_ != EGL_NO_DISPLAY) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      if (window_ != EGL_NO_SURFACE) eglDestroySurface(display_, window_);
      if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
    }
    if (shown_ != nullptr) gbm_surface_release_buffer(surface_, shown_);
    if (surface_ != nullptr) gbm_surface_destroy(surface_);
    if (display_ != EGL_NO_DISPLAY) eglTerminate(display_);
    if (gbm_ != nullptr) gbm_device_destroy(gbm_);
    ::close(device_);
  }

  Status start() {
    const auto table = read_table(device_);
    if (!table) return failure(name_, table.error().message);
    const auto output = choose_output(*table);
    if (!output) return failure(name_, output.error().message);
    output_ = *output;
    if (drmSetMaster(device_) != 0)
      return failure(name_, "another program has it, perhaps a desktop; a window works there");
    before_.reset(drmModeGetCrtc(device_, output_.controller));
    gbm_ = gbm_create_device(device_);
    if (gbm_ == nullptr) return failure(name_, "its driver has no GBM");
    surface_ = gbm_surface_create(gbm_, output_.mode.hdisplay, output_.mode.vdisplay, kFormat,
                                  GBM_BO_USE_SCANOUT | GBM_BO_USE_RENDERING);
    if (surface_ == nullptr) return failure(name_, "cannot make buffers of its size");
    return start_egl();
  }

  [[nodiscard]] std::pair<int, int> size() const override {
    return {output_.mode.hdisplay, output_.mode.vdisplay};
  }

  Status show() override {
    wait_for_flip();
    if (eglSwapBuffers(display_, window_) != EGL_TRUE) return failure(name_, "cannot show a picture");
    gbm_bo* next = gbm_surface_lock_front_buffer(surface_);
    if (next == nullptr) return failure(name_, "no free buffer");
    if (Status s = put_on_screen(next); !s) {
      gbm_surface_release_buffer(surface_, next);
      return s;
    }
    flipping_ = shown_ != nullptr;
    if (shown_ != nullptr) leaving_ = shown_;
    shown_ = next;
    return {};
  }

 private:
  Status start_egl() {
    const auto platform_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (platform_display == nullptr) return failure(name_, "this EGL has no platforms");
    display_ = platform_display(EGL_PLATFORM_GBM_KHR, gbm_, nullptr);
    if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) != EGL_TRUE) {
      display_ = EGL_NO_DISPLAY;
      return failure(name_, "no EGL driver for it");
    }
    const EGLConfig config = choose_config();
    if (config == nullptr) return failure(name_, "its driver has no 8 bit RGB for OpenGL ES 3");
    context_ = create_es31_context(display_, config);
    if (context_ == EGL_NO_CONTEXT) return failure(name_, "its driver has no OpenGL ES 3.1");
    window_ =
        eglCreateWindowSurface(display_, config, reinterpret_cast<EGLNativeWindowType>(surface_), nullptr);
    if (window_ == EGL_NO_SURFACE || eglMakeCurrent(display_, window_, window_, context_) != EGL_TRUE)
      return failure(name_, "its driver cannot draw to it");
    return {};
  }

  [[nodiscard]] EGLConfig choose_config() const {
    const EGLint wanted[] = {EGL_SURFACE_TYPE,
                             EGL_WINDOW_BIT,
                             EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_ES3_BIT,
                             EGL_RED_SIZE,
                             8,
                             EGL_GREEN_SIZE,
                             8,
                             EGL_BLUE_SIZE,
                             8,
                             EGL_NONE};
    EGLint count = 0;
    if (eglChooseConfig(display_, wanted, nullptr, 0, &count) != EGL_TRUE || count == 0) return nullptr;
    std::vector<EGLConfig> configs(static_cast<std::size_t>(count));
    eglChooseConfig(display_, wanted, configs.data(), count, &count);
    for (const EGLConfig config : configs) {
      EGLint format = 0;
      eglGetConfigAttrib(display_, config, EGL_NATIVE_VISUAL_ID, &format);
      if (static_cast<std::uint32_t>(format) == kFormat) return config;
    }
    return nullptr;
  }

  Status put_on_screen(gbm_bo* next) {
    const auto buffer = framebuffer_of(next);
    if (!buffer) return buffer.error();
    const int failed =
        shown_ == nullptr
            ? drmModeSetCrtc(device_, output_.controller, *buffer, 0, 0, &output_.connector, 1, &output_.mode)
            : drmModePageFlip(device_, output_.controller, *buffer, DRM_MODE_PAGE_FLIP_EVENT, &flipping_);
    return failed == 0 ? Status() : failure(name_, std::strerror(errno));
  }

  // The kernel's number of a buffer, made once and kept with it.
  Result<std::uint32_t> framebuffer_of(gbm_bo* bo) {
    struct Framebuffer {
      int device;
      std::uint32_t id;
    };
    if (auto* known = static_cast<Framebuffer*>(gbm_bo_get_user_data(bo)); known != nullptr) return known->id;
    const std::uint32_t handles[4] = {gbm_bo_get_handle(bo).u32, 0, 0, 0};
    const std::uint32_t strides[4] = {gbm_bo_get_stride(bo), 0, 0, 0};
    const std::uint32_t offsets[4] = {0, 0, 0, 0};
    std::uint32_t id = 0;
    if (drmModeAddFB2(device_, gbm_bo_get_width(bo), gbm_bo_get_height(bo), kFormat, handles, strides,
                      offsets, &id, 0) != 0)
      return failure(name_, std::string("cannot show a buffer: ") + std::strerror(errno));
    gbm_bo_set_user_data(bo, new Framebuffer{device_, id}, [](gbm_bo*, void* data) {
      const std::unique_ptr<Framebuffer> own(static_cast<Framebuffer*>(data));
      drmModeRmFB(own->device, own->id);
    });
    return id;
  }

  // Until the screen shows the last picture: then the one before is free.
  void wait_for_flip() {
    drmEventContext events{};
    events.version = 2;
    events.page_flip_handler = [](int, unsigned, unsigned, unsigned, void* flipping) {
      *static_cast<bool*>(flipping) = false;
    };
    constexpr int kLongestRefresh_ms = 1000;
    pollfd wait{device_, POLLIN, 0};
    while (flipping_) {
      const int ready = ::poll(&wait, 1, kLongestRefresh_ms);
      if (ready < 0 && errno == EINTR) continue;
      if (ready <= 0 || drmHandleEvent(device_, &events) != 0) flipping_ = false;
    }
    if (leaving_ != nullptr) gbm_surface_release_buffer(surface_, std::exchange(leaving_, nullptr));
  }

  std::filesystem::path name_;
  int device_;
  KmsOutput output_;
  Crtc before_;
  gbm_device* gbm_ = nullptr;
  gbm_surface* surface_ = nullptr;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLSurface window_ = EGL_NO_SURFACE;
  gbm_bo* shown_ = nullptr;    // on the screen, or about to be
  gbm_bo* leaving_ = nullptr;  // on the screen until the flip
  bool flipping_ = false;
};

}  // namespace

Result<std::unique_ptr<KmsScreen>> KmsScreen::open(const std::filesystem::path& folder) {
  const std::vector<std::filesystem::path> devices = graphics_devices(folder);
  if (devices.empty())
    return Error{ErrorKind::failed, "no screen: " + folder.string() +
                                        " has no graphics device (its kernel driver is not loaded)"};
  std::string why;  // of each device, in one line
  for (const auto& name : devices) {
    const auto refuse = [&](const Error& error) { why += (why.empty() ? "" : "; ") + error.message; };
    const int device = ::open(name.c_str(), O_RDWR | O_CLOEXEC);
    if (device < 0) {
      refuse(failure(name, std::string("cannot open it: ") + std::strerror(errno) + " (group video)"));
      continue;
    }
    auto screen = std::make_unique<Screen>(name, device);
    if (Status s = screen->start(); !s) {
      refuse(s.error());
      continue;
    }
    return std::unique_ptr<KmsScreen>(std::move(screen));
  }
  return Error{ErrorKind::failed, why};
}

}  // namespace lightwell::render
