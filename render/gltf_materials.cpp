// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/gltf_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

namespace lightwell::render::gltf {
namespace {

using tinygltf::Value;

constexpr std::array<std::string_view, 3> kSupported = {"KHR_texture_transform", "KHR_mesh_quantization",
                                                        "KHR_materials_emissive_strength"};

void say_once(std::vector<std::string>& remarks, const std::string& sentence) {
  if (std::find(remarks.begin(), remarks.end(), sentence) == remarks.end()) remarks.push_back(sentence);
}

template <class Extensions>
const Value* extension(const Extensions& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

// What glTF calls a texture info, whichever of tinygltf's types holds it.
struct Info {
  int index = -1;
  int tex_coord = 0;
  const tinygltf::ExtensionMap* extensions = nullptr;
};

template <class T>
Info info_of(const T& source) {
  return {source.index, source.texCoord, &source.extensions};
}

std::array<float, 2> pair(const Value& object, const char* key, std::array<float, 2> standard,
                          const std::string& what) {
  const Value* v = member(object, key);
  if (v == nullptr) return standard;
  if (!v->IsArray() || v->ArrayLen() != 2) throw BadScene{what + "." + key + " must be two numbers"};
  return {number(v->Get(0), what + "." + key, -1e6, 1e6), number(v->Get(1), what + "." + key, -1e6, 1e6)};
}

// KHR_texture_transform: scale, then a turn (counter-clockwise on the picture, whose v points down), then a shift.
void apply_transform(const Value& transform, const std::string& what, TextureUse& use, int& uv_set) {
  const std::string name = what + ": KHR_texture_transform";
  const auto offset = pair(transform, "offset", {0, 0}, name);
  const auto scale = pair(transform, "scale", {1, 1}, name);
  float turn_rad = 0;
  if (const Value* v = member(transform, "rotation")) turn_rad = number(*v, name + ".rotation", -1e6, 1e6);
  if (const Value* v = member(transform, "texCoord"))
    uv_set = static_cast<int>(number(*v, name + ".texCoord", 0, 1000));
  const float c = std::cos(turn_rad);
  const float s = std::sin(turn_rad);
  use.from_uv = {c * scale[0], s * scale[1], offset[0], -s * scale[0], c * scale[1], offset[1]};
}

// One set of coordinates serves all textures of a material.
TextureUse texture(const tinygltf::Model& model, const Info& info, const std::string& what,
                   std::optional<int>& uv_set) {
  TextureUse use;
  if (info.index < 0) return use;
  use.texture = static_cast<int>(index_in(model.textures.size(), info.index, what + ": texture"));
  int set = info.tex_coord;
  if (const Value* t = extension(*info.extensions, "KHR_texture_transform"))
    apply_transform(*t, what, use, set);
  if (uv_set.value_or(set) != set)
    throw BadScene{what + " uses TEXCOORD_" + std::to_string(set) +
                   ", another texture of the material TEXCOORD_" + std::to_string(*uv_set) +
                   "; one set for all is supported"};
  uv_set = set;
  return use;
}

void read_alpha(const tinygltf::Material& source, const std::string& what, Material& m,
                std::vector<std::string>& remarks) {
  m.alpha = number(source.pbrMetallicRoughness.baseColorFactor[3], what + ": baseColorFactor", 0, 1);
  if (source.alphaMode == "MASK") m.alpha_cutoff = number(source.alphaCutoff, what + ": alphaCutoff", 0, 1e6);
  if (source.alphaMode == "BLEND") {
    m.alpha_cutoff = 0.5f;
    say_once(
        remarks,
        what + ": alphaMode BLEND is shown opaque where alpha is 0.5 and more, and not at all elsewhere");
  }
}

void read_emission(const tinygltf::Model& model, const tinygltf::Material& source, const std::string& what,
                   Material& m, std::optional<int>& uv_set) {
  if (source.emissiveFactor.empty()) return;
  if (source.emissiveFactor.size() != 3) throw BadScene{what + ": emissiveFactor must be three numbers"};
  float strength = 1;
  if (const Value* e = extension(source.extensions, "KHR_materials_emissive_strength"))
    if (const Value* v = member(*e, "emissiveStrength"))
      strength = number(*v, what + ": emissiveStrength", 0, std::numeric_limits<float>::max());
  for (int c = 0; c < 3; ++c)
    m.emission[c] = strength * number(source.emissiveFactor[static_cast<std::size_t>(c)],
                                      what + ": emissiveFactor", 0, 1e6);
  if ((m.emission > 0).any())
    m.emission_texture = texture(model, info_of(source.emissiveTexture), what + ": emissiveTexture", uv_set);
}

}  // namespace

std::vector<TextureImage> read_textures(const tinygltf::Model& model) {
  std::vector<TextureImage> textures;
  for (std::size_t i = 0; i < model.textures.size(); ++i) {
    const tinygltf::Texture& source = model.textures[i];
    const std::string what = "texture " + std::to_string(i);
    const tinygltf::Image& image =
        model.images[index_in(model.images.size(), source.source, what + ": image")];
    const auto bytes = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 4;
    if (image.width <= 0 || image.height <= 0 || image.component != 4 || image.bits != 8 ||
        image.image.size() != bytes)
      throw BadScene{"image " + std::to_string(source.source) +
                     (image.uri.empty() ? std::string() : " ('" + image.uri + "')") +
                     " is missing or no readable 8 bit picture"};
    TextureImage& texture = textures.emplace_back();
    texture.width = image.width;
    texture.height = image.height;
    texture.rgba = image.image;
    if (source.sampler < 0) continue;
    const tinygltf::Sampler& sampler =
        model.samplers[index_in(model.samplers.size(), source.sampler, what + ": sampler")];
    // Others than glTF knows are taken for its defaults.
    const auto choose = [](int value, std::initializer_list<int> known, int& to) {
      if (std::find(known.begin(), known.end(), value) != known.end()) to = value;
    };
    const auto wraps = {TINYGLTF_TEXTURE_WRAP_REPEAT, TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE,
                        TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT};
    choose(sampler.wrapS, wraps, texture.wrap_u);
    choose(sampler.wrapT, wraps, texture.wrap_v);
    choose(sampler.magFilter, {TINYGLTF_TEXTURE_FILTER_NEAREST, TINYGLTF_TEXTURE_FILTER_LINEAR},
           texture.mag_filter);
    choose(sampler.minFilter,
           {TINYGLTF_TEXTURE_FILTER_NEAREST, TINYGLTF_TEXTURE_FILTER_LINEAR,
            TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST, TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST,
            TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR, TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_LINEAR},
           texture.min_filter);
  }
  return textures;
}

MaterialFromFile read_material(const tinygltf::Model& model, std::size_t index,
                               std::vector<std::string>& remarks) {
  const tinygltf::Material& source = model.materials[index];
  const std::string what = "material " + std::to_string(index);
  const auto& pbr = source.pbrMetallicRoughness;
  Material m;
  std::optional<int> uv_set;
  if (pbr.baseColorFactor.size() != 4) throw BadScene{what + ": baseColorFactor must be four numbers"};
  for (int c = 0; c < 3; ++c)
    m.base_color[c] =
        number(pbr.baseColorFactor[static_cast<std::size_t>(c)], what + ": baseColorFactor", 0, 1);
  m.metallic = number(pbr.metallicFactor, what + ": metallicFactor", 0, 1);
  m.roughness = number(pbr.roughnessFactor, what + ": roughnessFactor", 0, 1);
  m.base_color_texture = texture(model, info_of(pbr.baseColorTexture), what + ": baseColorTexture", uv_set);
  m.metallic_roughness_texture =
      texture(model, info_of(pbr.metallicRoughnessTexture), what + ": metallicRoughnessTexture", uv_set);
  m.normal_texture = texture(model, info_of(source.normalTexture), what + ": normalTexture", uv_set);
  m.normal_scale = number(source.normalTexture.scale, what + ": normalTexture.scale", -1e3, 1e3);
  read_emission(model, source, what, m, uv_set);
  read_alpha(source, what, m, remarks);
  m.double_sided = source.doubleSided;
  if (source.occlusionTexture.index >= 0)
    say_once(remarks, "occlusion textures are not used: shadows are computed");
  apply_phong(source.extras, what, m);
  return {m, uv_set.value_or(0)};
}

bool apply_phong(const Value& extras, const std::string& what, Material& m) {
  const Value* phong = member(extras, "phong");
  if (phong == nullptr) return false;
  if (!phong->IsObject()) throw BadScene{what + ": extras.phong must be an object"};
  m.model = Material::Model::phong;
  m.base_color = Rgb::Zero();
  if (const Value* v = member(*phong, "diffuse")) m.base_color = colour(*v, what + ": extras.phong.diffuse");
  if (const Value* v = member(*phong, "specular")) m.specular = colour(*v, what + ": extras.phong.specular");
  if (const Value* v = member(*phong, "exponent"))
    m.exponent = number(*v, what + ": extras.phong.exponent", 0, 1e6);
  return true;
}

void check_extensions(const tinygltf::Model& model, std::vector<std::string>& remarks) {
  const auto supported = [](const std::string& name) {
    return std::find(kSupported.begin(), kSupported.end(), name) != kSupported.end();
  };
  for (const std::string& name : model.extensionsRequired)
    if (!supported(name)) throw BadScene{"requires the extension " + name + ", which is not supported"};
  std::string passed_by;
  for (const std::string& name : model.extensionsUsed)
    if (!supported(name)) passed_by += (passed_by.empty() ? "" : ", ") + name;
  if (!passed_by.empty()) say_once(remarks, "extensions that are passed by: " + passed_by);
}

}  // namespace lightwell::render::gltf
