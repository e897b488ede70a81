// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/cbor_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace lightwell {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(const std::string& hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

bool holds(const std::string& hex, std::size_t most_depth = 32) {
  return is_shallow_cbor(from_hex(hex), most_depth);
}

// It throws where no memory could hold an array of such a length, though told not to throw.
bool reader_takes(const Bytes& bytes) {
  try {
    return !nlohmann::json::from_cbor(bytes, true, false).is_discarded();
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

// RFC 8949, appendix A.
const char* const kExamples[] = {"00",
                                 "1818",
                                 "1903e8",
                                 "1bffffffffffffffff",
                                 "c249010000000000000000",
                                 "3863",
                                 "f93c00",
                                 "fa47c35000",
                                 "fb3ff199999999999a",
                                 "f4",
                                 "f7",
                                 "f0",
                                 "f8ff",
                                 "c074323031332d30332d32315432303a30343a30305a",
                                 "d74401020304",
                                 "40",
                                 "4401020304",
                                 "60",
                                 "6449455446",
                                 "80",
                                 "8301820203820405",
                                 "98190102030405060708090a0b0c0d0e0f101112131415161718181819",
                                 "a0",
                                 "a201020304",
                                 "a56161614161626142616361436164614461656145",
                                 "5f42010243030405ff",
                                 "7f657374726561646d696e67ff",
                                 "9fff",
                                 "9f018202039f0405ffff",
                                 "83018202039f0405ff",
                                 "bf61610161629f0203ffff",
                                 "bf6346756ef563416d7421ff"};

TEST(CborShape, TheExamplesOfTheStandardAreWellFormedWholeAndNotTruncated) {
  for (const std::string hex : kExamples) {
    EXPECT_TRUE(holds(hex)) << hex;
    for (std::size_t length = 0; length < hex.size(); length += 2)
      EXPECT_FALSE(holds(hex.substr(0, length))) << hex << ", " << length / 2 << " bytes";
    EXPECT_FALSE(holds(hex + "00")) << hex;
  }
}

// RFC 8949, appendix F.1.
TEST(CborShape, WhatTheStandardCallsNotWellFormedIsRefused) {
  for (const char* hex : {"18",
                          "19",
                          "1a",
                          "1b",
                          "1901",
                          "1a0102",
                          "1b01020304050607",
                          "38",
                          "58",
                          "78",
                          "98",
                          "9a01ff00",
                          "b8",
                          "d8",
                          "f8",
                          "f900",
                          "fa0000",
                          "fb000000",
                          "41",
                          "61",
                          "5affffffff00",
                          "5bffffffffffffffff010203",
                          "7affffffff00",
                          "7b7fffffffffffffff010203",
                          "81",
                          "818181818181818181",
                          "8200",
                          "a1",
                          "a20102",
                          "a100",
                          "a2000000",
                          "c0",
                          "5f4100",
                          "7f6100",
                          "9f",
                          "9f0102",
                          "bf",
                          "bf01020102",
                          "819f",
                          "9f8000",
                          "9f9f9f9f9fffffffff",
                          "9f819f819f9fffffff",
                          "1c",
                          "1d",
                          "1e",
                          "3c",
                          "3e",
                          "5c",
                          "5e",
                          "7c",
                          "9c",
                          "bc",
                          "dc",
                          "fc",
                          "fe",
                          "f800",
                          "f818",
                          "f81f",
                          "5f00ff",
                          "5f21ff",
                          "5f6100ff",
                          "5f80ff",
                          "5fa0ff",
                          "5fc000ff",
                          "5fe0ff",
                          "7f4100ff",
                          "5f5f4100ffff",
                          "7f7f6100ffff",
                          "ff",
                          "81ff",
                          "8200ff",
                          "a1ff",
                          "a1ff00",
                          "a100ff",
                          "a20000ff",
                          "9f81ff",
                          "9f829f819f9fffffffff",
                          "bf00ff",
                          "bf000000ff",
                          "1f",
                          "3f",
                          "df"})
    EXPECT_FALSE(holds(hex)) << hex;
}

TEST(CborShape, WhatNestsIsRefusedFromOneLevelTooManyOn) {
  for (const std::string open : {"81", "9f", "c0", "a100", "bf00"}) {
    const std::string end = open == "9f" || open == "bf00" ? "ff" : "";
    for (const int depth : {0, 1, 31, 32, 33, 34}) {
      std::string hex;
      for (int i = 0; i < depth; ++i) hex += open;
      hex += "00";
      for (int i = 0; i < depth; ++i) hex += end;
      EXPECT_EQ(holds(hex), depth <= 32) << open << ", " << depth;
    }
  }
  EXPECT_TRUE(holds("80", 1));
  EXPECT_FALSE(holds("80", 0));
}

TEST(CborShape, AMillionOpeningsAreRefused) {
  for (const unsigned byte : {0x5Fu, 0x7Fu, 0x9Fu, 0xBFu, 0x81u, 0xA1u, 0xC0u})
    for (const std::size_t count : {30'000u, 1'000'000u})
      for (const char* head : {"", "a1", "a100", "bf", "9f", "bf6161"}) {
        Bytes bytes = from_hex(head);
        bytes.insert(bytes.end(), count, static_cast<std::uint8_t>(byte));
        EXPECT_FALSE(is_shallow_cbor(bytes, 32)) << byte << ", " << count << " behind " << head;
      }
}

TEST(CborShape, LengthsThatOverflowArePromisesThatAreNotKept) {
  for (const char* major : {"5b", "7b", "9b", "bb"})
    for (const char* length :
         {"ffffffffffffffff", "8000000000000000", "8000000000000001", "7fffffffffffffff"})
      EXPECT_FALSE(holds(std::string(major) + length + "0000")) << major << length;
}

// Random bytes with the heads of short items favoured. The other way round it need not hold: not all CBOR is JSON.
TEST(CborShape, WhatAReaderTakesIsWellFormed) {
  std::mt19937 random(1);
  const Bytes heads = from_hex("00416061808182a1bf9f5f7ffff4f5f6186118");
  int taken = 0;
  for (int i = 0; i < 200'000; ++i) {
    Bytes bytes(1 + random() % 9);
    for (std::uint8_t& byte : bytes)
      byte = random() % 4 == 0 ? static_cast<std::uint8_t>(random()) : heads[random() % heads.size()];
    if (!reader_takes(bytes)) continue;
    // Strings in strings of their kind, which the reader takes against 3.2.3.
    const bool nested_strings =
        std::count(bytes.begin(), bytes.end(), 0x5F) > 1 || std::count(bytes.begin(), bytes.end(), 0x7F) > 1;
    taken += nested_strings ? 0 : 1;
    EXPECT_TRUE(nested_strings || is_shallow_cbor(bytes, 32)) << ::testing::PrintToString(bytes);
  }
  EXPECT_GT(taken, 1000);
}

}  // namespace
}  // namespace lightwell
