# SPDX-FileCopyrightText: 2026 The Lightwell Authors
# SPDX-License-Identifier: Apache-2.0
# cmake -DOUTPUT=shaders.cpp -DSHADERS=a.glsl;b.glsl -P embed_shaders.cmake
set(entries "")
foreach(shader ${SHADERS})
  get_filename_component(name "${shader}" NAME)
  file(READ "${shader}" text)
  string(APPEND entries "    {\"${name}\", R\"glsl(${text})glsl\"},\n")
endforeach()
file(WRITE "${OUTPUT}" "#include \"render/shaders.h\"

#include <map>

namespace lightwell::render {

std::string_view shader_text(std::string_view name) {
  static const std::map<std::string_view, std::string_view> texts = {
${entries}  };
  const auto found = texts.find(name);
  verify_bug(found != texts.end(), \"unknown shader\");
  return found->second;
}

}  // namespace lightwell::render
")
