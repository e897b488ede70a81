// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "render/light_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "tests/unit/render/render_fixture.h"

namespace lightwell {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace)
using render::LightLists;
using render::LightRow;

Vec3f any_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return Vec3f(normal(random), normal(random), normal(random)).normalized();
}

std::vector<LightRow> rows_all_over(std::size_t count) {
  std::mt19937 random(3);
  std::vector<LightRow> rows(count);
  for (LightRow& row : rows) {
    const Vec3f d = any_direction(random);
    std::copy_n(d.data(), 3, row.to_light);
  }
  return rows;
}

bool reaches(const LightRow& row, const Vec3f& normal) {
  return normal.dot(Vec3f(row.to_light[0], row.to_light[1], row.to_light[2])) > 0;
}

struct Listed {
  std::vector<std::size_t> all;
  std::size_t strong;
  std::vector<std::vector<std::size_t>> subsets;
};
Listed listed_at(const std::vector<std::uint16_t>& table, int cell, std::size_t subsets) {
  const auto row =
      table.begin() + static_cast<std::ptrdiff_t>(cell) * static_cast<std::ptrdiff_t>(LightLists::kColumns);
  Listed listed{{row + LightLists::kListed, row + LightLists::kListed + row[0]}, row[1], {}};
  for (std::size_t s = 2; s < 2 + subsets; ++s) {
    const auto at = static_cast<std::ptrdiff_t>(s);
    listed.subsets.emplace_back(row + LightLists::kGrouped + row[at],
                                row + LightLists::kGrouped + row[at + 1]);
  }
  return listed;
}

TEST(LightLists, NoLightThatANormalSeesIsMissing) {
  const std::vector<LightRow> rows = rows_all_over(256);
  const auto table = LightLists::table(rows, 20, 4);
  std::mt19937 random(5);
  std::vector<Vec3f> normals = {Vec3f::UnitX(),
                                -Vec3f::UnitX(),
                                Vec3f::UnitY(),
                                -Vec3f::UnitY(),
                                Vec3f::UnitZ(),
                                -Vec3f::UnitZ(),
                                Vec3f(1, 1, 1).normalized(),
                                Vec3f(-1, -1, -1).normalized(),
                                Vec3f(1, -1, 0).normalized()};
  for (int i = 0; i < 20000; ++i) normals.push_back(any_direction(random));
  std::size_t listed_lights = 0;
  for (const Vec3f& normal : normals) {
    const int cell = LightLists::cell_of(normal);
    ASSERT_GE(cell, 0);
    ASSERT_LT(cell, LightLists::kCells);
    const Listed listed = listed_at(table, cell, 4);
    listed_lights += listed.all.size();
    ASSERT_TRUE(std::is_sorted(listed.all.begin(), listed.all.end())) << "the lights' order";
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (reaches(rows[i], normal)) {
        ASSERT_TRUE(std::binary_search(listed.all.begin(), listed.all.end(), i)) << normal.transpose();
      }
  }
  // A hemisphere is half of all; a cell reaches 8 degrees from its middle on average, which adds sin 8° / 2.
  EXPECT_LT(static_cast<double>(listed_lights) / static_cast<double>(256 * normals.size()), 0.59);
}

TEST(LightLists, EveryCellIsReached) {
  std::mt19937 random(7);
  std::set<int> cells;
  for (int i = 0; i < 40000; ++i) cells.insert(LightLists::cell_of(any_direction(random)));
  EXPECT_EQ(cells.size(), static_cast<std::size_t>(LightLists::kCells));
}

TEST(LightLists, SubsetsShareTheWeakLightsOfACellAsWithoutLists) {
  const std::vector<LightRow> rows = rows_all_over(200);
  for (const std::size_t subsets : {1, 4, 16}) {
    const auto table = LightLists::table(rows, 30, static_cast<int>(subsets));
    for (int cell = 0; cell < LightLists::kCells; ++cell) {
      const Listed listed = listed_at(table, cell, subsets);
      std::vector<std::size_t> together;
      for (std::size_t s = 0; s < subsets; ++s)
        for (const std::size_t i : listed.subsets[s]) {
          ASSERT_EQ((i - 30) % subsets, s);
          together.push_back(i);
        }
      std::sort(together.begin(), together.end());
      const auto weak = std::lower_bound(listed.all.begin(), listed.all.end(), 30u);
      ASSERT_EQ(static_cast<std::size_t>(weak - listed.all.begin()), listed.strong);
      ASSERT_TRUE(std::equal(together.begin(), together.end(), weak, listed.all.end()));
    }
  }
}

TEST(LightLists, NoLightsMakeEmptyLists) {
  const auto table = LightLists::table({}, 0, 4);
  for (int cell = 0; cell < LightLists::kCells; ++cell) EXPECT_TRUE(listed_at(table, cell, 4).all.empty());
}

class LightListPictures : public Rendering {
 protected:
  static std::vector<float> picture_of(render::Renderer& renderer, const LightSet& lights,
                                       const SceneCamera& camera, bool lists, bool shadows) {
    EXPECT_TRUE(renderer.set_light_lists(lists));
    EXPECT_TRUE(renderer.set_shadows(shadows));
    EXPECT_TRUE(renderer.render(lights, camera));
    return renderer.radiance().rgba;
  }
};

TEST_F(LightListPictures, ArePicturesWithoutThem) {
  Scene scene;
  add_ground(scene, lambertian(Rgb(0.8f, 0.5f, 0.1f)));
  Material gloss = lambertian(Rgb(0.2f, 0.3f, 0.4f));
  gloss.specular = Rgb(0.5f, 0.4f, 0.3f);
  gloss.exponent = 20;
  add_sphere(scene, Vec3f(0, 1, 0), 0.9f, gloss);
  // From all sides, so that normals of all faces of the cube are seen.
  std::vector<SceneCamera> cameras;
  for (const Vec3f& from : {Vec3f(0, 1.5f, 4), Vec3f(0, 1.5f, -4), Vec3f(4, 1.5f, 0), Vec3f(-4, 1.5f, 0),
                            Vec3f(0.1f, 5, 0), Vec3f(0.1f, -4, 0)})
    cameras.push_back(camera_at(from, Vec3f(0, 0.8f, 0)));
  std::mt19937 random(11);
  // 400: two blocks of uniforms. A renderer each: lights may take maps that stand from those before.
  const std::vector<std::pair<int, int>> cases = {{1, 72}, {2, 3}, {2, 72}, {2, 400}, {4, 400}};
  for (const auto& [interleave, count] : cases) {
    render::RendererOptions options;
    options.width = 64;
    options.height = 48;
    options.shadow_size = 64;
    options.interleave = interleave;
    options.light_lists = true;
    auto renderer = render::Renderer::create(scene, options);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message;
    LightSet lights;
    for (int i = 0; i < count; ++i) {
      DirectionalLight light;
      light.direction = any_direction(random);
      light.illuminance = Rgb(100, 60, 3) * (i == 0 ? 40.0f : 1.0f);
      lights.lights.push_back(light);
    }
    for (std::size_t side = 0; side < cameras.size(); ++side) {
      const bool shadows = side % 2 == 0 || count == 72;
      const auto with = picture_of(*renderer, lights, cameras[side], true, shadows);
      const auto without = picture_of(*renderer, lights, cameras[side], false, shadows);
      const float most = *std::max_element(without.begin(), without.end());
      ASSERT_GT(most, 0);
      ASSERT_EQ(with.size(), without.size());
      float off = 0;
      for (std::size_t i = 0; i < with.size(); ++i) off = std::max(off, std::abs(with[i] - without[i]));
      // What a list leaves out adds 0: compilers may still round the two loops differently.
      EXPECT_LE(off, 1e-6f * most) << count << " lights, interleave " << interleave << ", side " << side;
    }
  }
}

// Light without end from below the ground: 0 times that is no number, unless its list leaves it out.
TEST_F(LightListPictures, LookAtNothingElse) {
  Scene scene;
  add_ground(scene, lambertian(Rgb(0.8f, 0.5f, 0.1f)));
  const LightSet lights =
      light_set({{Vec3f(0.2f, 1, 0), Rgb::Constant(100)},
                 {Vec3f(0.1f, -1, 0.2f), Rgb::Constant(std::numeric_limits<float>::infinity())}});
  render::RendererOptions options;
  options.width = 16;
  options.height = 12;
  options.interleave = 1;
  auto renderer = render::Renderer::create(scene, options);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message;
  const SceneCamera camera = camera_at(Vec3f(0, 3, 0.1f), Vec3f::Zero());
  const auto all_finite = [](const std::vector<float>& picture) {
    return std::all_of(picture.begin(), picture.end(), [](float x) { return std::isfinite(x); });
  };
  EXPECT_FALSE(all_finite(picture_of(*renderer, lights, camera, false, false)));
  EXPECT_TRUE(all_finite(picture_of(*renderer, lights, camera, true, false)));
}

}  // namespace
}  // namespace lightwell
