// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "daemon/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "interface/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace lightwell {
namespace {

using testing::HasSubstr;

class ConfigurationFile : public testing::Test {
 protected:
  Result<LoadedConfiguration> load(const std::string& text, const Overrides& overrides = {}) {
    const auto file = folder_.path() / "lightwell.toml";
    EXPECT_TRUE(write_file_atomically(file, text));
    return load_configuration(file, overrides);
  }
  test::TemporaryFolder folder_;
};

TEST_F(ConfigurationFile, EmptyFileIsTheDefaults) {
  EXPECT_EQ(load("")->configuration, Configuration{});
  EXPECT_EQ(load_configuration("", {})->configuration, Configuration{});
}

TEST_F(ConfigurationFile, PrintedConfigurationReadsBackTheSame) {
  auto loaded =
      load("[lights]\ncount = 17\nfilter = \"none\"\n[probe]\nname = 'a \"b\" \\'\n[source]\nspeed = 2\n");
  ASSERT_TRUE(loaded);
  const auto again = load(print_configuration(*loaded));
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->configuration, loaded->configuration);
  EXPECT_EQ(again->configuration.lights.count, 17);
  EXPECT_EQ(again->configuration.probe.name, "a \"b\" \\");
}

TEST_F(ConfigurationFile, PrintShowsWhereAValueComesFrom) {
  const auto loaded = load("[lights]\ncount = 17\n", {{"http.listen", "127.0.0.1:0"}});
  ASSERT_TRUE(loaded);
  const std::string text = print_configuration(*loaded);
  EXPECT_THAT(text, HasSubstr("lightwell.toml:2; lights a frame"));
  EXPECT_THAT(text, HasSubstr("listen = \"127.0.0.1:0\"  # command line"));
  EXPECT_THAT(text, HasSubstr("clusters = 72  # default"));
}

TEST_F(ConfigurationFile, TheFitHasALimitAndABound) {
  const auto loaded = load("[fit]\nlights = 8\nmax_error = 0.03\n");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->configuration.fit.lights, 8);
  EXPECT_EQ(loaded->configuration.fit.max_error, 0.03);
  EXPECT_THAT(print_configuration(*loaded), HasSubstr("max_error = 0.03"));
  for (const char* text : {"[fit]\nlights = 17\n", "[fit]\nlights = -1\n", "[fit]\nmax_error = 2\n"})
    EXPECT_FALSE(load(text)) << text;
}

TEST_F(ConfigurationFile, CommandLineWinsOverTheFile) {
  const auto loaded =
      load("[source]\naddress = \"aravis:10.0.0.1\"\n", {{"source.address", "simulated:day"}});
  EXPECT_EQ(loaded->configuration.source.address, "simulated:day");
}

TEST_F(ConfigurationFile, UnknownKeyNamesFileLineAndTheNearestKey) {
  const auto loaded = load("[lights]\n\ncuont = 3\n");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(loaded.error().message, HasSubstr("lightwell.toml:3"));
  EXPECT_THAT(loaded.error().message, HasSubstr("lights.cuont"));
  EXPECT_THAT(loaded.error().message, HasSubstr("lights.count"));
}

TEST_F(ConfigurationFile, ValueOutOfRangeNamesValueAndRange) {
  for (const char* text : {"[lights]\ncount = -1\n", "[lights]\ncount = 100001\n", "[lights]\ncount = 3.5\n",
                           "[lights]\ncount = \"3\"\n", "[lights]\ncount = [3]\n"}) {
    const auto loaded = load(text);
    ASSERT_FALSE(loaded) << text;
    EXPECT_THAT(loaded.error().message, HasSubstr("lights.count"));
    EXPECT_THAT(loaded.error().message, HasSubstr("0 to 100000"));
  }
  EXPECT_FALSE(load("[source]\nrate_hz = nan\n"));
  EXPECT_FALSE(load("[lights]\nsampler = \"nothing\"\n"));
  const auto many = load("[lights]\nsampler = \"best\"\ncount = 513\n");
  ASSERT_FALSE(many);
  EXPECT_THAT(many.error().message, HasSubstr("0 to 512"));
  EXPECT_TRUE(load("[lights]\nsampler = \"havran\"\ncount = 513\n"));
}

TEST_F(ConfigurationFile, CommandLineOutOfRangeIsUsage) {
  const auto loaded = load("", {{"dds.domain", "500"}});
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().kind, ErrorKind::usage);
}

TEST_F(ConfigurationFile, MalformedTextNamesTheLine) {
  const auto loaded = load("[lights]\ncount = = 3\n");
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(loaded.error().message, HasSubstr("lightwell.toml:2"));
}

TEST_F(ConfigurationFile, FilterEdgesMustBeInOrder) {
  EXPECT_FALSE(load("[lights]\npass_hz = 9\nstop_hz = 7\n"));
  EXPECT_FALSE(load("[lights]\npass_hz = 9\n"));
  EXPECT_TRUE(load("[lights]\npass_hz = 7\nstop_hz = 9\n"));
}

TEST_F(ConfigurationFile, MissingFileAndKeyOutsideASectionAreBadInput) {
  EXPECT_EQ(load_configuration("/nonexistent/lightwell.toml", {}).error().kind, ErrorKind::bad_input);
  EXPECT_EQ(load("count = 3\n").error().kind, ErrorKind::bad_input);
}

}  // namespace
}  // namespace lightwell
