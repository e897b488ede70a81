// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tiny_gltf.h>

#include <string>

#include "lighting/result.h"
#include "lighting/vector.h"

// What the readers of a glTF file's parts share.
namespace lightwell::render::gltf {

// Thrown by the readers, caught in read_gltf.
struct BadScene {
  std::string message;
  ErrorKind kind = ErrorKind::bad_input;
};

// nullptr: not an object, or without that key.
const tinygltf::Value* member(const tinygltf::Value& object, const char* key);

// A finite number within a range, or BadScene with what and the range.
float number(double value, const std::string& what, double low, double high);
float number(const tinygltf::Value& value, const std::string& what, double low, double high);
Rgb colour(const tinygltf::Value& value, const std::string& what);

template <class T>
T take(Result<T> result) {
  if (!result) throw BadScene{result.error().message};
  return std::move(result).value();
}

// An index into one of the file's lists, or BadScene: "node 0: mesh 7 is out of range, the file has 2".
std::size_t index_in(std::size_t size, int index, const std::string& what);

}  // namespace lightwell::render::gltf
