// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_accessor.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

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

// count elements of so many components at a byte of a buffer view.
Result<View> view(const tinygltf::Model& model, int buffer_view, std::size_t offset, std::size_t count,
                  int component_type, int components, const std::string& what) {
  const int component_bytes = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type));
  if (component_bytes <= 0 || component_type == TINYGLTF_COMPONENT_TYPE_DOUBLE ||
      component_type == TINYGLTF_COMPONENT_TYPE_INT)
    return bad(what, "component type " + std::to_string(component_type) + " is not one of glTF's");
  if (buffer_view < 0 || static_cast<std::size_t>(buffer_view) >= model.bufferViews.size())
    return bad(what, "bufferView " + std::to_string(buffer_view) + " is out of range, the file has " +
                         std::to_string(model.bufferViews.size()));
  const tinygltf::BufferView& v = model.bufferViews[static_cast<std::size_t>(buffer_view)];
  if (v.buffer < 0 || static_cast<std::size_t>(v.buffer) >= model.buffers.size())
    return bad(what, "buffer " + std::to_string(v.buffer) + " is out of range, the file has " +
                         std::to_string(model.buffers.size()));
  const auto& data = model.buffers[static_cast<std::size_t>(v.buffer)].data;
  const std::size_t element = static_cast<std::size_t>(component_bytes * components);
  const std::size_t stride = v.byteStride != 0 ? v.byteStride : element;
  const bool in_buffer = v.byteOffset <= data.size() && v.byteLength <= data.size() - v.byteOffset;
  // Divides rather than multiplies: a hostile count cannot overflow.
  const bool in_view = in_buffer && stride >= element && count > 0 && offset <= v.byteLength &&
                       v.byteLength - offset >= element &&
                       count - 1 <= (v.byteLength - offset - element) / stride;
  if (!in_view)
    return bad(what, std::to_string(count) + " elements at byte " + std::to_string(offset) +
                         " do not lie inside their buffer of " + std::to_string(data.size()) + " bytes");
  return View{data.data() + v.byteOffset + offset, count, stride, component_type, false};
}

Result<const tinygltf::Accessor*> find(const tinygltf::Model& model, int accessor, int components,
                                       const std::string& what) {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= model.accessors.size())
    return bad(what, "accessor " + std::to_string(accessor) + " is out of range, the file has " +
                         std::to_string(model.accessors.size()));
  const tinygltf::Accessor& a = model.accessors[static_cast<std::size_t>(accessor)];
  if (tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type)) != components)
    return bad(what, "has the wrong type, expected " + std::to_string(components) + " components");
  return &a;
}

Result<std::vector<std::uint32_t>> whole_numbers(const View& v, const std::string& what) {
  if (v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      v.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    return bad(what, "indices are unsigned integers of 8, 16 or 32 bits");
  std::vector<std::uint32_t> numbers(v.count);
  for (std::size_t i = 0; i < v.count; ++i)
    numbers[i] = static_cast<std::uint32_t>(v.component(v.bytes + i * v.stride));
  return numbers;
}

// values: those of element i come to i × components
Status copy(const View& v, std::size_t components, std::span<const std::uint32_t> places,
            std::vector<float>& values, const std::string& what) {
  const auto component_bytes = static_cast<std::size_t>(
      tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(v.component_type)));
  for (std::size_t i = 0; i < v.count; ++i) {
    const std::size_t place = places.empty() ? i : places[i];
    for (std::size_t c = 0; c < components; ++c) {
      const auto value = static_cast<float>(v.component(v.bytes + i * v.stride + c * component_bytes));
      if (!std::isfinite(value)) return bad(what, "element " + std::to_string(place) + " is not finite");
      values[place * components + c] = value;
    }
  }
  return {};
}

// Elements that differ from the rest (glTF 2.0, 3.6.2.3).
Status overwrite(const tinygltf::Model& model, const tinygltf::Accessor& a, std::size_t components,
                 std::vector<float>& values, const std::string& what) {
  const auto& sparse = a.sparse;
  if (sparse.count <= 0 || static_cast<std::size_t>(sparse.count) > a.count ||
      sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    return bad(what, "sparse: " + std::to_string(sparse.count) + " of " + std::to_string(a.count) +
                         " elements, must be 1 to all");
  const auto count = static_cast<std::size_t>(sparse.count);
  const auto index_view =
      view(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
           sparse.indices.componentType, 1, what + " sparse indices");
  if (!index_view) return index_view.error();
  const auto places = whole_numbers(*index_view, what + " sparse");
  if (!places) return places.error();
  for (const std::uint32_t place : *places)
    if (place >= a.count)
      return bad(what, "sparse index " + std::to_string(place) + " is out of range, the accessor has " +
                           std::to_string(a.count) + " elements");
  auto value_view = view(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                         count, a.componentType, static_cast<int>(components), what + " sparse values");
  if (!value_view) return value_view.error();
  value_view->normalized = a.normalized;
  return copy(*value_view, components, *places, values, what);
}

// Elements that stand in no buffer are zeros; a count of them costs a file nothing.
constexpr std::size_t kMostZeros = 1u << 26;

}  // namespace

Result<std::vector<float>> read_floats(const tinygltf::Model& model, int accessor, int components,
                                       const std::string& what) {
  const auto found = find(model, accessor, components, what);
  if (!found) return found.error();
  const tinygltf::Accessor& a = **found;
  const auto width = static_cast<std::size_t>(components);
  std::vector<float> values;
  if (a.bufferView < 0 && a.sparse.isSparse) {
    if (a.count > kMostZeros) return bad(what, std::to_string(a.count) + " elements, at most 67108864");
    values.assign(a.count * width, 0.0f);
  } else {
    auto v = view(model, a.bufferView, a.byteOffset, a.count, a.componentType, components, what);
    if (!v) return v.error();
    v->normalized = a.normalized;
    values.resize(a.count * width);
    if (Status s = copy(*v, width, {}, values, what); !s) return s.error();
  }
  if (a.sparse.isSparse)
    if (Status s = overwrite(model, a, width, values, what); !s) return s.error();
  return values;
}

Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor,
                                                std::size_t vertex_count, const std::string& what) {
  const auto found = find(model, accessor, 1, what);
  if (!found) return found.error();
  const tinygltf::Accessor& a = **found;
  if (a.sparse.isSparse) return bad(what, "sparse indices are not supported");
  const auto v = view(model, a.bufferView, a.byteOffset, a.count, a.componentType, 1, what);
  if (!v) return v.error();
  auto indices = whole_numbers(*v, what);
  if (!indices) return indices.error();
  for (const std::uint32_t index : *indices)
    if (index >= vertex_count)
      return bad(what, "index " + std::to_string(index) + " is out of range, the mesh has " +
                           std::to_string(vertex_count) + " vertices");
  return indices;
}

}  // namespace lightwell::render
