// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/timecode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/support/ltc_signal.h"

namespace {

using lightwell::test::encode_ltc;
using lightwell::test::LtcSignal;

constexpr std::uint32_t kHz = 84'000'000;

struct Decoded {
  timecode_word word;
  double start;
};

std::vector<Decoded> decode(const LtcSignal& signal, double jitter_s = 0, double lost = 0) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, jitter_s);
  std::uniform_real_distribution<double> uniform;
  timecode self;
  timecode_init(&self, kHz);
  std::vector<Decoded> words;
  for (const double edge : signal.edges) {
    if (uniform(random) < lost) continue;
    timecode_word word;
    if (timecode_edge(&self, static_cast<std::uint64_t>((1 + edge + noise(random)) * kHz), &word))
      words.push_back({word, static_cast<double>(word.start) / kHz - 1});
  }
  return words;
}

bool same(const timecode_word& word, const SMPTETimecode& code) {
  return word.hours == code.hours && word.minutes == code.mins && word.seconds == code.secs &&
         word.frames == code.frame;
}

SMPTETimecode at(unsigned char hours, unsigned char minutes, unsigned char seconds, unsigned char frame) {
  return {"+0000", 0, 0, 0, hours, minutes, seconds, frame};
}

TEST(Timecode, EveryFrameOfAnIndependentEncoderIsReadAndPlaced) {
  for (const double fps : {24.0, 25.0, 30000.0 / 1001, 30.0})
    for (const double speed : {0.5, 1.0, 1.9}) {
      const LtcSignal signal = encode_ltc(fps, at(23, 59, 58, 5), 90, speed);
      const auto words = decode(signal);
      // The first frame finds the bits, the second is the first whole word, the last one's end has no edge.
      ASSERT_EQ(words.size(), signal.codes.size() - 3) << fps << " " << speed;
      const std::size_t first = 2;
      for (std::size_t i = 0; i < words.size(); ++i) {
        EXPECT_TRUE(same(words[i].word, signal.codes[first + i])) << i;
        EXPECT_EQ(words[i].word.user_bits, 0x12345678u);
        EXPECT_NEAR(words[i].start, signal.starts[first + i], 7e-6 / speed);  // a sample of the encoder's
      }
    }
}

TEST(Timecode, DropFrameIsSaid) {
  const auto words = decode(encode_ltc(30000.0 / 1001, at(1, 0, 59, 20), 30));
  ASSERT_FALSE(words.empty());
  EXPECT_TRUE(words[0].word.drop_frame);
  EXPECT_FALSE(decode(encode_ltc(25, at(1, 0, 0, 0), 10))[0].word.drop_frame);
}

TEST(Timecode, AJitteryLineIsRead) {
  const LtcSignal signal = encode_ltc(30, at(10, 20, 30, 0), 100);
  EXPECT_GE(decode(signal, 15e-6).size(), 97u);  // 15 µs rms of a half bit of 208 µs
}

TEST(Timecode, LostEdgesLoseFramesAndNeverMakeWrongOnes) {
  const LtcSignal signal = encode_ltc(25, at(10, 20, 30, 0), 3000);
  const auto words = decode(signal, 2e-6, 0.002);
  EXPECT_GT(words.size(),
            1000u);  // 120 edges a frame: four in five frames keep theirs; so must the two before
  for (const auto& [word, start] : words) {
    const auto frame = static_cast<std::size_t>(std::lround(start * 25));
    ASSERT_LT(frame, signal.codes.size());
    EXPECT_TRUE(same(word, signal.codes[frame])) << frame;
  }
}

TEST(Timecode, NoiseIsNoTimecode) {
  std::mt19937 random(3);
  timecode self;
  timecode_init(&self, kHz);
  std::uint64_t tick = 1;
  int words = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    tick += random() % 60'000;
    timecode_word word;
    words += timecode_edge(&self, tick, &word);
  }
  EXPECT_EQ(words, 0);
}

}  // namespace
