// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_values.h"

#include <cmath>
#include <cstdio>

namespace lightwell::render::gltf {

using tinygltf::Value;

const Value* member(const Value& object, const char* key) {
  return object.IsObject() && object.Has(key) ? &object.Get(key) : nullptr;
}

float number(double value, const std::string& what, double low, double high) {
  if (value >= low && value <= high) return static_cast<float>(value);
  char range[96];
  std::snprintf(range, sizeof range, " is %g, must be a number from %g to %g", value, low, high);
  throw BadScene{what + range};
}

float number(const Value& value, const std::string& what, double low, double high) {
  return number(value.IsNumber() ? value.GetNumberAsDouble() : std::nan(""), what, low, high);
}

Rgb colour(const Value& value, const std::string& what) {
  if (!value.IsArray() || value.ArrayLen() != 3) throw BadScene{what + " must be three numbers"};
  Rgb c;
  for (int i = 0; i < 3; ++i) c[i] = number(value.Get(i), what, 0, 1e6);
  return c;
}

std::size_t index_in(std::size_t size, int index, const std::string& what) {
  if (index < 0 || static_cast<std::size_t>(index) >= size)
    throw BadScene{what + " " + std::to_string(index) + " is out of range, the file has " +
                   std::to_string(size)};
  return static_cast<std::size_t>(index);
}

}  // namespace lightwell::render::gltf
