// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/csv_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lightwell {
namespace {

using testing::HasSubstr;

std::string refusal_of(std::string_view text) {
  const auto table = CsvTable::parse(text, "cards.csv");
  EXPECT_FALSE(table) << text;
  if (table) return "";
  EXPECT_EQ(table.error().kind, ErrorKind::bad_input);
  EXPECT_EQ(table.error().message.find('\n'), std::string::npos) << table.error().message;
  EXPECT_THAT(table.error().message, HasSubstr("cards.csv: "));
  return table.error().message;
}

// RFC 4180, section 2, rules 5 to 7.
TEST(CsvTable, QuotedFieldsHoldCommasLineEndsAndQuotes) {
  const auto table = CsvTable::parse(
      "name , code\n\"grey, 18 %\" , \"7\"\n\"two\r\nlines\",8\n\"a \"\"b\"\"\",9\n\"\",1\n", "x");
  ASSERT_TRUE(table) << table.error().message;
  ASSERT_EQ(table->rows(), 4U);
  EXPECT_EQ(table->text(0, "name"), "grey, 18 %");
  EXPECT_EQ(table->number(0, "code", 0, 9, "").value(), 7);
  EXPECT_EQ(table->text(1, "name"), "two\r\nlines");
  EXPECT_EQ(table->text(2, "name"), "a \"b\"");
  EXPECT_EQ(table->text(3, "name"), "");
  EXPECT_EQ(table->line(2), 5);  // counted through the field of two lines
}

TEST(CsvTable, LinesEndAsOnAnySystem) {
  for (const char* text :
       {"a,b\n1,2\n3,4", "a,b\r\n1,2\r\n3,4\r\n", "a,b\r1,2\r3,4\r", "\xef\xbb\xbf# c\n\na,b\n1,2\n \n3,4"}) {
    const auto table = CsvTable::parse(text, "x");
    ASSERT_TRUE(table) << table.error().message;
    ASSERT_EQ(table->rows(), 2U) << text;
    EXPECT_EQ(table->number(1, "b", 0, 9, "").value(), 4) << text;
  }
}

TEST(CsvTable, WhatIsNoCsvIsSaid) {
  EXPECT_THAT(refusal_of("a,b\n1,\"2\n3,4\n"), HasSubstr("line 2: a quoted field does not end"));
  EXPECT_THAT(refusal_of("a,b\n1,\"2\"3\n"), HasSubstr("line 2: text after a quoted field"));
  EXPECT_THAT(refusal_of("luminance_cd_m2;code\n0,5;7\n"),
              HasSubstr("line 1: columns are separated by semicolons"));
  EXPECT_THAT(refusal_of("# note\nluminance_cd_m2\tcode\n5\t7\n"),
              HasSubstr("line 2: columns are separated by tabs"));
  EXPECT_THAT(refusal_of("code,luminance_cd_m2, code\n1,2,3\n"),
              HasSubstr("line 1: column code stands there twice"));
  EXPECT_THAT(refusal_of(std::string_view("\xff\xfe"
                                          "a\0,\0b\0\n\0",
                                          10)),
              HasSubstr("UTF-16"));
  EXPECT_THAT(refusal_of("a,b\n1,2,3\n"), HasSubstr("line 2: 3 fields: allowed 2"));
  EXPECT_THAT(refusal_of("# only a note\n"), HasSubstr("is empty"));
}

TEST(CsvTable, NumbersOfNoUseAreRefusedWithTheRange) {
  const auto table = CsvTable::parse("l\n1e-320\n1e-10\n0\n1e-9\n1e12\n2e12\n1e400\n", "x");
  ASSERT_TRUE(table) << table.error().message;
  const bool good[] = {false, false, true, true, true, false, false};
  for (std::size_t row = 0; row < table->rows(); ++row) {
    const auto value = table->luminance(row, "l");
    EXPECT_EQ(value.ok(), good[row]) << table->text(row, "l");
    if (!value) {
      EXPECT_THAT(value.error().message, HasSubstr("allowed 0, or a number from 1e-9 to 1e12"));
    }
  }
  EXPECT_FALSE(table->number(0, "l", 0, 1, "a number from 0 to 1"));
}

TEST(CsvTable, ANumberHasOneSign) {
  const auto table = CsvTable::parse("l\n+5\n-5\n+-5\n++5\n-+5\n+\n", "x");
  ASSERT_TRUE(table) << table.error().message;
  const bool good[] = {true, true, false, false, false, false};
  for (std::size_t row = 0; row < table->rows(); ++row)
    EXPECT_EQ(table->number(row, "l", -9, 9, "a number from -9 to 9").ok(), good[row])
        << table->text(row, "l");
}

}  // namespace
}  // namespace lightwell
