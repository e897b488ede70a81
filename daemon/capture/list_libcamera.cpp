// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/capture/list_libcamera.h"

#ifdef LIGHTWELL_LIBCAMERA

#include <algorithm>
#include <set>

#include "daemon/capture/libcamera_session.h"

namespace lightwell {
namespace {

void add_formats(libcamera::Camera& camera, libcamera::StreamRole role, std::set<std::string>& seen,
                 LibcameraDescription& out) {
  const auto configuration = camera.generateConfiguration({role});
  if (configuration == nullptr || configuration->empty()) return;
  const libcamera::StreamFormats& formats = configuration->at(0).formats();
  for (const libcamera::PixelFormat& format : formats.pixelformats()) {
    if (!seen.insert(format.toString()).second) continue;
    LibcameraDescription::Format f;
    f.name = format.toString();
    if (const auto ours = libcamera_format_of(format.fourcc(), format.modifier())) {
      f.pixel_format = name(ours->frame_format(16, 16).pixel_format);
      f.raw = !ours->processed;
    }
    for (const libcamera::Size& size : formats.sizes(format)) f.sizes.push_back(size.toString());
    out.formats.push_back(std::move(f));
  }
}

}  // namespace

std::vector<LibcameraDescription> list_libcamera() {
  std::vector<LibcameraDescription> list;
  const auto manager = libcamera_manager();
  if (manager == nullptr) return list;
  for (const auto& camera : manager->cameras()) {
    LibcameraDescription d;
    d.id = camera->id();
    d.model = camera->properties().get(libcamera::properties::Model).value_or("");
    std::set<std::string> seen;
    add_formats(*camera, libcamera::StreamRole::Raw, seen, d);
    add_formats(*camera, libcamera::StreamRole::Viewfinder, seen, d);
    for (const auto& [id, range] : camera->controls()) d.controls.emplace_back(id->name(), range.toString());
    std::sort(d.controls.begin(), d.controls.end());
    list.push_back(std::move(d));
  }
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  return list;
}

}  // namespace lightwell

#else

namespace lightwell {

std::vector<LibcameraDescription> list_libcamera() {
  return {};
}

}  // namespace lightwell

#endif
