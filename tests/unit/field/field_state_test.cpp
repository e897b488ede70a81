// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "field/field_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "field/field_builder.h"
#include "field/sample_store.h"
#include "interface/atomic_file.h"
#include "tests/support/analytic_fields.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

void flip_a_bit(const std::filesystem::path& file, std::streamoff at) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(at);
  const char byte = static_cast<char>(stream.get() ^ 4);
  stream.seekp(at);
  stream.put(byte);
}

class InterruptedBuild : public testing::Test {
 protected:
  InterruptedBuild() {
    options_.grid = {{6, 5, 4}, Vec3d::Zero(), Vec3d::Ones()};
    options_.directions = 300;
    options_.threads = 2;
    options_.scratch_folder = folder_.path();
    options_.state_name = "f.vdb.part";
    options_.made_from = "the box of lamps";
    options_.save_every = std::chrono::seconds(0);
    options_.remark = [this](const std::string& line) { remarks_ += line; };
    take_.positions = test::random_positions(200, 1);  // several files of samples
    take_.name = [](std::size_t i) { return std::to_string(i); };
    take_.picture = [this](std::size_t i) -> Result<LatLongImage> {
      ++pictures_;
      LatLongImage image{16, 8, {}};
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x)
          image.pixels.push_back(
              test::box_of_lamps(take_.positions[i], direction_from_lat_long((x + 0.5) / 16, (y + 0.5) / 8))
                  .cast<float>());
      return image;
    };
  }
  [[nodiscard]] LightField whole() {
    FieldBuildOptions alone = options_;
    alone.state_name.clear();
    auto build = build_field(take_, alone);
    verify_bug(build.ok(), "a build that cannot fail");
    return std::move(build->field);
  }
  // Ends as a killed program does: nothing is tidied up. done: of 200 pictures and 300 directions.
  void stop_after(std::size_t done) {
    EXPECT_THROW((void)build_field(take_, options_,
                                   [&](std::size_t now, std::size_t) {
                                     if (now >= done) throw std::runtime_error("killed");
                                   }),
                 std::runtime_error);
    pictures_ = 0;
  }
  void expect_the_same(const LightField& expected) {
    const auto build = build_field(take_, options_);
    ASSERT_TRUE(build);
    EXPECT_EQ(build->field.radiance, expected.radiance);
    EXPECT_EQ(build->field.confidence, expected.confidence);
    build->state->remove();
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  }
  [[nodiscard]] std::filesystem::path state() const { return folder_.path() / "f.vdb.part"; }

  test::TemporaryFolder folder_;
  FieldBuildOptions options_;
  ProbeTake take_;
  std::atomic<int> pictures_ = 0;
  std::string remarks_;
};

TEST_F(InterruptedBuild, EndsInTheSameBitsWhereverItStopped) {
  const LightField expected = whole();
  for (const std::size_t done : {1u, 100u, 200u, 215u, 350u, 500u}) {
    SCOPED_TRACE(done);
    stop_after(done);
    expect_the_same(expected);
    // The first picture tells the size; what was sorted is not read again.
    EXPECT_LE(pictures_, done >= 200 ? 1 : done == 100 ? 150 : 201);
  }
  EXPECT_THAT(remarks_, testing::HasSubstr("goes on where an interrupted build stands"));
}

TEST_F(InterruptedBuild, TrustsNothingDamaged) {
  const LightField expected = whole();
  stop_after(450);
  flip_a_bit(state() / "samples-1", 2000);
  flip_a_bit(state() / "sums", 1000);
  std::filesystem::resize_file(state() / "samples-2", 5000);
  expect_the_same(expected);
  // Two files were made again, and the first picture tells the size.
  const SampleStore store(state(), 0, take_.positions.size(), 300);
  EXPECT_EQ(static_cast<std::size_t>(pictures_), 1 + store.last_probe(2) - store.first_probe(1));
}

TEST_F(InterruptedBuild, OfOtherPicturesIsNotGoneOnWith) {
  stop_after(450);
  options_.made_from = "others";
  expect_the_same(whole());
  EXPECT_THAT(remarks_, testing::HasSubstr("f.vdb.part: was of other pictures or options, begins anew"));
}

TEST_F(InterruptedBuild, IsNotWrittenByTwo) {
  bool refused = false;
  const auto first = build_field(take_, options_, [&](std::size_t, std::size_t) {
    if (refused) return;
    const auto second = build_field(take_, options_);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::failed);
    EXPECT_THAT(second.error().message, testing::HasSubstr("f.vdb.part: another build is writing here"));
    refused = true;
  });
  ASSERT_TRUE(first);
  EXPECT_TRUE(refused);
  // Its field may not be written yet.
  const auto early = build_field(take_, options_);
  ASSERT_FALSE(early);
  EXPECT_THAT(early.error().message, testing::HasSubstr("another build is writing here"));
  first->state->remove();
  const auto next = build_field(take_, options_);
  ASSERT_TRUE(next) << next.error().message;
  // The first one's end takes nothing from it.
  first->state->remove();
  EXPECT_TRUE(std::filesystem::exists(state() / "sums"));
}

TEST_F(InterruptedBuild, OfAnotherVersionIsNotGoneOnWith) {
  const LightField expected = whole();
  stop_after(450);
  std::string text = *read_text_file(state() / "made_from.txt");
  const std::size_t line = text.find('\n');
  EXPECT_THAT(text.substr(0, line), testing::HasSubstr(" numerics "));
  std::ofstream(state() / "made_from.txt") << "lightwell.field-state/1 numerics 0" << text.substr(line);
  expect_the_same(expected);
  EXPECT_THAT(remarks_, testing::HasSubstr("f.vdb.part: was of another version of this program"));
  EXPECT_EQ(pictures_, 201);  // each of them again, and the first tells the size
}

// Builds that begin while others end: the lock that is taken is the one that stands in the folder.
TEST(FieldState, BelongsToOneAtATimeThroughManyRemovals) {
  const test::TemporaryFolder folder;
  std::atomic<int> owners = 0, turns = 0, wrong = 0;
  const auto take_turns = [&] {
    FieldRanks alone;
    while (turns < 400) {
      auto state = FieldState::open(folder.path(), "f.part", {"program", "take"}, alone);
      if (!state) {
        if (state.error().message.find("another build is writing here") == std::string::npos) {
          ADD_FAILURE() << state.error().message;
          ++wrong;
        }
        continue;
      }
      if (owners++ != 0) ++wrong;
      std::ofstream(state->folder() / "samples-0") << "light";
      if (!std::filesystem::exists(state->folder() / "made_from.txt")) ++wrong;
      if (--owners != 0) ++wrong;
      ++turns;
      state->remove();
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) threads.emplace_back(take_turns);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// What has the name of a state is the user's unless a build has left it.
TEST_F(InterruptedBuild, TouchesNothingThatIsNoneOfABuild) {
  const auto refused = [&] {
    const auto build = build_field(take_, options_);
    ASSERT_FALSE(build);
    EXPECT_EQ(build.error().kind, ErrorKind::failed);
    EXPECT_THAT(build.error().message,
                testing::HasSubstr("f.vdb.part: is not the folder of an interrupted build"));
  };
  std::filesystem::create_directory(state());
  std::ofstream(state() / "thesis.txt") << "years";
  refused();
  EXPECT_EQ(read_text_file(state() / "thesis.txt").value(), "years");
  EXPECT_FALSE(std::filesystem::exists(state() / "lock"));
  // Behind a link: even what a build has left.
  const std::filesystem::path elsewhere = folder_.path() / "elsewhere";
  std::filesystem::remove_all(state());
  stop_after(450);
  std::filesystem::rename(state(), elsewhere);
  std::filesystem::create_directory_symlink(elsewhere, state());
  refused();
  EXPECT_TRUE(std::filesystem::exists(elsewhere / "sums"));
  std::filesystem::remove(state());
  std::ofstream(state()) << "a file";
  refused();
  EXPECT_EQ(read_text_file(state()).value(), "a file");
}

TEST_F(InterruptedBuild, LeavesNothingWhereAPictureIsBad) {
  const auto good = take_.picture;
  take_.picture = [good](std::size_t i) -> Result<LatLongImage> {
    if (i == 150) return Error{ErrorKind::bad_input, "150: is torn"};
    return good(i);
  };
  const auto build = build_field(take_, options_);
  ASSERT_FALSE(build);
  EXPECT_EQ(build.error().message, "150: is torn");
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST(SampleStore, CutsATakeIntoPiecesThatCoverItOnce) {
  for (const std::size_t probes : {1u, 63u, 440u, 4397u, 100000u})
    for (const std::size_t directions : {1u, 300u, 12868u}) {
      const SampleStore store("x", 0, probes, directions);
      std::size_t probe = 0, direction = 0;
      for (std::size_t c = 0; c < store.chunks(); ++c) {
        EXPECT_EQ(store.first_probe(c), probe);
        probe = store.last_probe(c);
        EXPECT_LE((probe - store.first_probe(c)) * directions * sizeof(Rgb), 32u << 20);
      }
      for (std::size_t b = 0; b < store.buckets(); ++b) {
        EXPECT_EQ(store.first(b), direction);
        direction = store.last(b);
        EXPECT_LE((direction - store.first(b)) * probes * sizeof(Rgb), 32u << 20);
      }
      EXPECT_EQ(probe, probes);
      EXPECT_EQ(direction, directions);
    }
}

}  // namespace
}  // namespace lightwell
