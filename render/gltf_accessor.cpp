// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_accessor.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lightwell::render {
namespace {

Error bad(const std::string& what, const std::string& why) {
  return {ErrorKind::bad_input, what + ": " + why};
}

// A checked window on an accessor's bytes.
struct View {
  const unsigned char* bytes = nullptr;
  std::size_t count = 0;
  std::size_t stride = 0;
  int component_type = 0;
  bool normalized = false;

  // p: the component itself
  [[nodiscard]] double component(const unsigned char* p) const;
};

template <class T>
double load(const unsigned char* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return static_cast<double>(value);
}

double View::component(const unsigned char* p) const {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return load<float>(p);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(p);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<std::uint16_t>(p) / (normalized ? 65535.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return *p / (normalized ? 255.0 : 1.0);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized ? std::max(load<std::int16_t>(p) / 32767.0, -1.0) : load<std::int16_t>(p);
    default:
      return normalized ? std::max(load<std::int8_t>(p) / 127.0, -1.0) : load<std::int8_t>(p);
  }
}

Result<View> view(const tinygltf::Model& model, int accessor, int components, const std::string& what) {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= model.accessors.size())
    return bad(what, "accessor " + std::to_string(accessor) + " is out of range, the file has " +
                         std::to_string(model.accessors.size()));
  const tinygltf::Accessor& a = model.accessors[static_cast<std::size_t>(accessor)];
  if (a.sparse.isSparse) return bad(what, "sparse accessors are not supported");
  if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type)) != components)
    return bad(what, "has the wrong type, expected " + std::to_string(components) + " components");
  const int component_bytes = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType));
  if (component_bytes <= 0 || a.componentType == TINYGLTF_COMPONENT_TYPE_DOUBLE ||
      a.componentType == TINYGLTF_COMPONENT_TYPE_INT)
    return bad(what, "component type " + std::to_string(a.componentType) + " is not one of glTF's");
  if (a.bufferView < 0 || static_cast<std::size_t>(a.bufferView) >= model.bufferViews.size())
    return bad(what, "bufferView " + std::to_string(a.bufferView) + " is out of range, the file has " +
                         std::to_string(model.bufferViews.size()));
  const tinygltf::BufferView& v = model.bufferViews[static_cast<std::size_t>(a.bufferView)];
  if (v.buffer < 0 || static_cast<std::size_t>(v.buffer) >= model.buffers.size())
    return bad(what, "buffer " + std::to_string(v.buffer) + " is out of range, the file has " +
                         std::to_string(model.buffers.size()));
  const auto& data = model.buffers[static_cast<std::size_t>(v.buffer)].data;
  const std::size_t element = static_cast<std::size_t>(component_bytes * components);
  const std::size_t stride = v.byteStride != 0 ? v.byteStride : element;
  const bool in_buffer = v.byteOffset <= data.size() && v.byteLength <= data.size() - v.byteOffset;
  // Divides rather than multiplies: a hostile count cannot overflow.
  const bool in_view = in_buffer && stride >= element && a.count > 0 && a.byteOffset <= v.byteLength &&
                       v.byteLength - a.byteOffset >= element &&
                       a.count - 1 <= (v.byteLength - a.byteOffset - element) / stride;
  if (!in_view)
    return bad(what, std::to_string(a.count) + " elements at byte " + std::to_string(a.byteOffset) +
                         " do not lie inside their buffer of " + std::to_string(data.size()) + " bytes");
  return View{data.data() + v.byteOffset + a.byteOffset, a.count, stride, a.componentType, a.normalized};
}

}  // namespace

Result<std::vector<float>> read_floats(const tinygltf::Model& model, int accessor, int components,
                                       const std::string& what) {
  const auto v = view(model, accessor, components, what);
  if (!v) return v.error();
  const auto component_bytes = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(v->component_type)));
  std::vector<float> values;
  values.reserve(v->count * static_cast<std::size_t>(components));
  for (std::size_t i = 0; i < v->count; ++i)
    for (std::size_t c = 0; c < static_cast<std::size_t>(components); ++c) {
      const auto value = static_cast<float>(v->component(v->bytes + i * v->stride + c * component_bytes));
      if (!std::isfinite(value)) return bad(what, "element " + std::to_string(i) + " is not finite");
      values.push_back(value);
    }
  return values;
}

Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor,
                                                std::size_t vertex_count, const std::string& what) {
  const auto v = view(model, accessor, 1, what);
  if (!v) return v.error();
  if (v->component_type == TINYGLTF_COMPONENT_TYPE_FLOAT ||
      v->component_type == TINYGLTF_COMPONENT_TYPE_SHORT || v->component_type == TINYGLTF_COMPONENT_TYPE_BYTE)
    return bad(what, "indices are unsigned integers of 8, 16 or 32 bits");
  std::vector<std::uint32_t> indices(v->count);
  for (std::size_t i = 0; i < v->count; ++i) {
    indices[i] = static_cast<std::uint32_t>(v->component(v->bytes + i * v->stride));
    if (indices[i] >= vertex_count)
      return bad(what, "index " + std::to_string(indices[i]) + " is out of range, the mesh has " +
                           std::to_string(vertex_count) + " vertices");
  }
  return indices;
}

}  // namespace lightwell::render
