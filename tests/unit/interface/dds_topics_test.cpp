// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/dds_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <thread>

#include "tests/support/dds.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;
using test::own_domain;

// Longer than anything here takes on a busy machine; no test waits this long unless it fails.
constexpr auto kPatience = 20s;

template <class Condition>
bool eventually(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

std::shared_ptr<DdsDomain> domain() {
  return DdsDomain::open(own_domain()).value();
}

LightFrame example_lights(std::uint64_t number, std::size_t count = 3) {
  LightFrame frame;
  frame.header.number = number;
  frame.header.sequence = 1000 + number;
  frame.header.capture_mono_ns = static_cast<std::int64_t>(number) * 16'666'667;
  frame.header.capture_utc_ns = 1'700'000'000'000'000'000;
  frame.header.publish_mono_ns = frame.header.capture_mono_ns + 4'000'000;
  frame.header.timecode = "01:02:03:04";
  frame.header.calibration_id = "abcdef0123456789";
  frame.header.measured_part = 0.5f;
  frame.header.total_illuminance = {100000, 90000, 80000};
  frame.header.delay_frames = 4;
  frame.has_parents = true;
  frame.ambient = {1, 2, 3};
  for (std::size_t i = 0; i < count; ++i) {
    const auto angle = static_cast<float>(i);
    frame.lights.push_back({.direction = Vec3f(std::sin(angle) * 0.6f, 0.8f, std::cos(angle) * 0.6f),
                            .illuminance = {10 + angle, 20, 30},
                            .parent = static_cast<std::int32_t>(i) - 1,
                            .id = static_cast<std::uint32_t>(7 * i),
                            .predicted_error = i == 0 ? 0 : 0.3f / angle,
                            .angular_radius_rad = 0.1f / (1 + angle)});
  }
  return frame;
}

void expect_same(const LightFrame& a, const LightFrame& b) {
  EXPECT_EQ(a.header.number, b.header.number);
  EXPECT_EQ(a.header.sequence, b.header.sequence);
  EXPECT_EQ(a.header.capture_mono_ns, b.header.capture_mono_ns);
  EXPECT_EQ(a.header.capture_utc_ns, b.header.capture_utc_ns);
  EXPECT_EQ(a.header.publish_mono_ns, b.header.publish_mono_ns);
  EXPECT_EQ(a.header.timecode, b.header.timecode);
  EXPECT_EQ(a.header.calibration_id, b.header.calibration_id);
  EXPECT_EQ(a.header.coverage, b.header.coverage);
  EXPECT_EQ(a.header.measured_part, b.header.measured_part);
  EXPECT_TRUE((a.header.total_illuminance == b.header.total_illuminance).all());
  EXPECT_EQ(a.header.delay_frames, b.header.delay_frames);
  EXPECT_EQ(a.has_parents, b.has_parents);
  EXPECT_TRUE((a.ambient == b.ambient).all());
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    EXPECT_EQ(a.lights[i].direction, b.lights[i].direction);
    EXPECT_TRUE((a.lights[i].illuminance == b.lights[i].illuminance).all());
    EXPECT_EQ(a.lights[i].parent, b.lights[i].parent);
    EXPECT_EQ(a.lights[i].id, b.lights[i].id);
    EXPECT_EQ(a.lights[i].predicted_error, b.lights[i].predicted_error);
    EXPECT_EQ(a.lights[i].angular_radius_rad, b.lights[i].angular_radius_rad);
  }
}

TEST(DdsTopics, LightsArriveAsTheyWereSent) {
  const auto writer = LightWriter::create(domain(), "probe").value();
  const auto reader = LightReader::create(domain()).value();
  ASSERT_TRUE(eventually([&] { return writer->readers() == 1 && reader->writers() == 1; }));
  LightFrame received;
  for (const std::size_t count : {0u, 1u, 3u, 300u, 16384u}) {
    const LightFrame sent = example_lights(count + 1, count);
    ASSERT_TRUE(writer->write(sent));
    ASSERT_TRUE(reader->take(received, kPatience)) << count << " lights";
    expect_same(sent, received);
    EXPECT_EQ(received.header.probe, "probe");
  }
  EXPECT_EQ(reader->refused(), 0u) << reader->refusal();
}

EnvironmentFrame example_environment(std::uint64_t number, int channels) {
  EnvironmentFrame frame;
  frame.header = example_lights(number).header;
  frame.map = PolarMap::make({.rings = 9, .sectors = 35, .theta_max_rad = 1.5}, channels);
  // Eight decades, with black bins between.
  for (std::size_t i = 0; i < frame.map.radiance.size(); ++i)
    frame.map.radiance[i] =
        i % 5 == 0 ? 0.0f : 1.7e9f * std::pow(10.0f, -8.0f * static_cast<float>(i % 100) / 99);
  frame.map.coverage = frame.header.measured_part;
  return frame;
}

TEST(DdsTopics, EnvironmentKeepsElevenBitsOverEightDecades) {
  const auto writer = EnvironmentWriter::create(domain(), "probe").value();
  const auto reader = EnvironmentReader::create(domain()).value();
  EnvironmentFrame received;
  for (const int channels : {1, 3}) {
    const EnvironmentFrame sent = example_environment(static_cast<std::uint64_t>(channels), channels);
    ASSERT_TRUE(writer->write(sent));
    ASSERT_TRUE(reader->take(received, kPatience));
    ASSERT_EQ(received.map.channels, channels);
    EXPECT_EQ(received.map.grid.rings, 9);
    EXPECT_EQ(received.map.grid.sectors, 35);
    EXPECT_FLOAT_EQ(static_cast<float>(received.map.grid.theta_max_rad), 1.5f);
    EXPECT_EQ(received.map.coverage, 0.5f);
    ASSERT_EQ(received.map.radiance.size(), sent.map.radiance.size());
    // Rounding to the nearest of 11 significant bits errs by 2^-12 to 2^-11 at most.
    for (std::size_t i = 0; i < sent.map.radiance.size(); ++i)
      EXPECT_NEAR(received.map.radiance[i], sent.map.radiance[i], sent.map.radiance[i] * std::exp2(-11.0f));
  }
}

FieldFrame example_field(std::uint64_t number, int side) {
  FieldFrame frame;
  frame.header.number = number;
  frame.field.grid = {{side, side + 1, side}, {-1, 0, -2}, {1, 2, 2.5}};
  frame.field.radiance.resize(frame.field.grid.points() * 75);
  for (std::size_t i = 0; i < frame.field.radiance.size(); ++i)
    frame.field.radiance[i] = 1e5f * std::sin(static_cast<float>(i));
  frame.field.confidence.assign(frame.field.grid.points(), 0.2f);
  frame.probes = {{"left", {-1, 1, 0}, 12, 0.25f, 1}, {"right", {1, 1, 0}, 7, 3.5f, 0}};
  frame.lamps = {{5, {0, 3, 0}, 0.02f, {100, 90, 80}, 0.5f}};
  return frame;
}

TEST(DdsTopics, FieldArrivesWithinHalfFloats) {
  const auto writer = FieldWriter::create(domain(), "stage").value();
  const FieldFrame sent = example_field(3, 16);
  ASSERT_TRUE(writer->write(sent));
  const auto reader = FieldReader::create(domain()).value();  // a late one
  FieldFrame received;
  ASSERT_TRUE(reader->take(received, kPatience)) << reader->refusal();
  EXPECT_EQ(received.header.probe, "stage");
  EXPECT_EQ(received.field.grid.size, sent.field.grid.size);
  EXPECT_EQ(received.field.grid.high, sent.field.grid.high);
  EXPECT_EQ(received.field.degree, 4);
  ASSERT_EQ(received.field.radiance.size(), sent.field.radiance.size());
  // Half an ulp of 11 bits, of the largest value where others are far below it.
  for (std::size_t i = 0; i < sent.field.radiance.size(); ++i)
    ASSERT_NEAR(received.field.radiance[i], sent.field.radiance[i], 1e5 * 0x1p-11);
  EXPECT_NEAR(received.field.confidence[7], 0.2, 0.5 / 255);
  ASSERT_EQ(received.probes.size(), 2u);
  EXPECT_EQ(received.probes[1].name, "right");
  EXPECT_EQ(received.probes[1].age_s, 3.5f);
  ASSERT_EQ(received.lamps.size(), 1u);
  EXPECT_EQ(received.lamps[0].position, Vec3d(0, 3, 0));
  EXPECT_EQ(received.lamps[0].weight, 0.5f);
}

TEST(DdsTopics, ReaderOfEveryProbeGetsTheNewestOfEachOnce) {
  const auto first = EnvironmentWriter::create(domain(), "first").value();
  const auto second = EnvironmentWriter::create(domain(), "second").value();
  for (std::uint64_t number = 1; number <= 3; ++number) {
    ASSERT_TRUE(first->write(example_environment(number, 1)));
    ASSERT_TRUE(second->write(example_environment(10 + number, 3)));
  }
  const auto reader = EnvironmentReader::create(domain(), {.every_probe = true}).value();
  std::map<std::string, std::uint64_t> numbers;
  EnvironmentFrame received;
  while (numbers.size() < 2) {
    ASSERT_TRUE(reader->take(received, kPatience));
    numbers[received.header.probe] = received.header.number;
  }
  EXPECT_EQ(numbers["first"], 3u);
  EXPECT_EQ(numbers["second"], 13u);
  EXPECT_FALSE(reader->take(received, 50ms));
  ASSERT_TRUE(first->write(example_environment(3, 1)));  // the same again
  EXPECT_FALSE(reader->take(received, 50ms));
}

TEST(DdsTopics, BlackEnvironmentStaysBlack) {
  const auto writer = EnvironmentWriter::create(domain(), "probe").value();
  const auto reader = EnvironmentReader::create(domain()).value();
  EnvironmentFrame frame = example_environment(1, 1);
  std::fill(frame.map.radiance.begin(), frame.map.radiance.end(), 0.0f);
  ASSERT_TRUE(writer->write(frame));
  EnvironmentFrame received;
  ASSERT_TRUE(reader->take(received, kPatience)) << reader->refusal();
  EXPECT_THAT(received.map.radiance, testing::Each(0.0f));
}

TEST(DdsTopics, LateJoinerGetsStatusAndEnvironmentAtOnce) {
  const auto status_writer = StatusWriter::create(domain(), "probe").value();
  const auto environment_writer = EnvironmentWriter::create(domain(), "probe").value();
  ProbeStatus status;
  status.source = "aravis:127.0.0.1";
  status.alarm = "the camera is gone";
  status.lost = 3;
  status.recording = true;
  ASSERT_TRUE(status_writer->write(status));
  ASSERT_TRUE(environment_writer->write(example_environment(7, 1)));

  const auto status_reader = StatusReader::create(domain()).value();
  const auto environment_reader = EnvironmentReader::create(domain()).value();
  ProbeStatus received;
  ASSERT_TRUE(status_reader->take(received, kPatience));
  EXPECT_EQ(received.source, status.source);
  EXPECT_EQ(received.alarm, status.alarm);
  EXPECT_EQ(received.lost, 3u);
  EXPECT_TRUE(received.recording);
  EnvironmentFrame environment;
  ASSERT_TRUE(environment_reader->take(environment, kPatience));
  EXPECT_EQ(environment.header.number, 7u);
}

TEST(DdsTopics, TextTooLongForTheWireIsCutAtACharacter) {
  const auto writer = StatusWriter::create(domain(), "probe").value();
  const auto reader = StatusReader::create(domain()).value();
  ProbeStatus status;
  status.source_state = std::string(30, 'x') + "\u00e9";  // the bound is 31 bytes, é has two
  ASSERT_TRUE(writer->write(status));
  ProbeStatus received;
  ASSERT_TRUE(reader->take(received, kPatience));
  EXPECT_EQ(received.source_state, std::string(30, 'x'));
}

TEST(DdsTopics, ReaderGetsTheNewestAndNothingTwice) {
  const auto writer = LightWriter::create(domain(), "probe").value();
  const auto reader = LightReader::create(domain()).value();
  LightFrame received;
  EXPECT_FALSE(reader->take(received, 0ms));
  EXPECT_FALSE(reader->age().has_value());
  for (std::uint64_t number = 1; number <= 5; ++number) ASSERT_TRUE(writer->write(example_lights(number)));
  ASSERT_TRUE(reader->take(received, kPatience));
  EXPECT_EQ(received.header.number, 5u);
  EXPECT_TRUE(reader->age().has_value());
  ASSERT_TRUE(writer->write(example_lights(5)));  // as a publisher does for late joiners
  EXPECT_FALSE(reader->take(received, 50ms));
  ASSERT_TRUE(writer->write(example_lights(1)));  // a daemon that was restarted counts from 1
  EXPECT_TRUE(reader->take(received, kPatience));
}

TEST(DdsTopics, ReaderThatNeverTakesCostsNothing) {
  const auto writer = LightWriter::create(domain(), "probe").value();
  const auto idle = LightReader::create(domain()).value();
  const auto reader = LightReader::create(domain()).value();
  for (std::uint64_t number = 1; number <= 20'000; ++number)
    ASSERT_TRUE(writer->write(example_lights(number)));
  LightFrame received;
  ASSERT_TRUE(reader->take(received, kPatience));
  EXPECT_EQ(received.header.number, 20'000u);
  ASSERT_TRUE(idle->take(received, kPatience));
  EXPECT_EQ(received.header.number, 20'000u);
}

TEST(DdsTopics, ReaderStaysWithTheFirstProbeUntilItIsGone) {
  auto first = LightWriter::create(domain(), "first").value();
  const auto second = LightWriter::create(domain(), "second").value();
  const auto any = LightReader::create(domain()).value();
  const auto chosen = LightReader::create(domain(), {.probe = "second"}).value();
  LightFrame received;
  ASSERT_TRUE(first->write(example_lights(1)));
  ASSERT_TRUE(any->take(received, kPatience));
  EXPECT_EQ(any->probe(), "first");
  EXPECT_FALSE(chosen->take(received, 0ms));
  ASSERT_TRUE(second->write(example_lights(2)));
  EXPECT_FALSE(any->take(received, 50ms));
  ASSERT_TRUE(chosen->take(received, kPatience));
  EXPECT_EQ(received.header.number, 2u);
  first.reset();
  ASSERT_TRUE(eventually([&] { return any->writers() == 1; }));
  EXPECT_FALSE(any->take(received, 0ms));
  ASSERT_TRUE(second->write(example_lights(3)));
  ASSERT_TRUE(any->take(received, kPatience));
  EXPECT_EQ(any->probe(), "second");
}

TEST(DdsTopics, OfTwoWritersOfOneNameOneIsReadUntilItIsGone) {
  for (const bool every : {false, true}) {
    auto first = EnvironmentWriter::create(domain(), "twice").value();
    const auto second = EnvironmentWriter::create(domain(), "twice").value();
    const auto reader = EnvironmentReader::create(domain(), {.every_probe = every}).value();
    EnvironmentFrame received;
    ASSERT_TRUE(first->write(example_environment(1, 1)));
    ASSERT_TRUE(reader->take(received, kPatience));
    EXPECT_TRUE(reader->contested().empty());
    ASSERT_TRUE(second->write(example_environment(50, 1)));
    EXPECT_FALSE(reader->take(received, 50ms));
    ASSERT_TRUE(first->write(example_environment(2, 1)));
    ASSERT_TRUE(reader->take(received, kPatience));
    EXPECT_EQ(received.header.number, 2u);
    EXPECT_TRUE(reader->contested().contains("twice"));
    first.reset();
    ASSERT_TRUE(eventually([&] { return reader->writers() == 1; }));
    ASSERT_TRUE(second->write(example_environment(51, 1)));
    ASSERT_TRUE(reader->take(received, kPatience));
    EXPECT_EQ(received.header.number, 51u);
  }
}

TEST(DdsTopics, WriterThatEndsIsGone) {
  auto writer = LightWriter::create(domain(), "probe").value();
  const auto reader = LightReader::create(domain()).value();
  ASSERT_TRUE(eventually([&] { return reader->writers() == 1; }));
  writer.reset();
  EXPECT_TRUE(eventually([&] { return reader->writers() == 0; }));
}

TEST(DdsTopics, TooManyLightsAndMapsThatDoNotFitAreRefusedByTheWriter) {
  const auto lights = LightWriter::create(domain(), "probe").value();
  EXPECT_EQ(lights->write(example_lights(1, 131073)).error().kind, ErrorKind::bad_input);
  const auto environment = EnvironmentWriter::create(domain(), "probe").value();
  EnvironmentFrame frame = example_environment(1, 1);
  frame.map.radiance.pop_back();
  EXPECT_EQ(environment->write(frame).error().kind, ErrorKind::bad_input);
}

TEST(DdsTopics, ProbeNamesAreChecked) {
  for (const std::string& name :
       {std::string(), std::string(64, 'x'), std::string("a\nb"), std::string("\xc3\xa9")})
    EXPECT_EQ(LightWriter::create(domain(), name).error().kind, ErrorKind::usage) << name;
}

TEST(DdsDomain, WrongOptionsAreNamed) {
  const auto message = [](const DdsOptions& options) {
    const auto result = DdsDomain::open(options);
    EXPECT_EQ(result.error().kind, ErrorKind::usage);
    return result.error().message;
  };
  EXPECT_THAT(message({.domain = kMaxDdsDomain + 1, .interface = "lo"}), testing::HasSubstr("233"));
  EXPECT_THAT(message({.domain = -1, .interface = "lo"}), testing::HasSubstr("-1"));
  EXPECT_THAT(message({.domain = 0, .interface = "nosuch0"}), testing::HasSubstr("nosuch0"));
  // TEST-NET-2 (RFC 5737): no machine has it.
  EXPECT_THAT(message({.domain = 0, .interface = "198.51.100.7"}), testing::HasSubstr("198.51.100.7"));
  const auto open = domain();
  DdsOptions other = own_domain();
  other.interface = "127.0.0.1";
  EXPECT_THAT(message(other), testing::HasSubstr("already open"));
}

TEST(DdsDomain, TheLastOfTheRangeOpens) {
  const auto last = DdsDomain::open({.domain = kMaxDdsDomain, .interface = "lo"});
  EXPECT_TRUE(last) << last.error().message;
}

TEST(DdsDomain, IsSharedInsideAProcessAndClosesWithItsLastUser) {
  auto first = domain();
  EXPECT_EQ(first, domain());
  first.reset();
  DdsOptions by_address = own_domain();
  by_address.interface = "127.0.0.1";
  EXPECT_TRUE(DdsDomain::open(by_address).ok());
}

// Another process, forked while this one has no DDS threads: it plays a role until it is killed, or ends by
// itself long after every parent has.
class Child {
 public:
  explicit Child(void (*role)(const DdsOptions&)) {
    const DdsOptions parents = own_domain();
    pid_ = ::fork();
    if (pid_ != 0) return;
    role(parents);
    ::_exit(0);
  }
  ~Child() {
    signal(SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  void signal(int number) const { ::kill(pid_, number); }

 private:
  pid_t pid_ = 0;
};

void write_lights(const DdsOptions& options) {
  const auto writer = LightWriter::create(DdsDomain::open(options).value(), "child").value();
  std::uint64_t number = 0;
  eventually([&] { return !writer->write(example_lights(++number, 300)); });
}

void read_everything(const DdsOptions& options) {
  const auto lights = LightReader::create(DdsDomain::open(options).value()).value();
  const auto environment = EnvironmentReader::create(DdsDomain::open(options).value()).value();
  LightFrame frame;
  EnvironmentFrame map;
  eventually([&] {
    lights->take(frame, 10ms);
    environment->take(map, 0ms);
    return false;
  });
}

TEST(DdsProcesses, LightsCrossAndAKilledWriterIsNoticed) {
  const Child child(write_lights);
  const auto reader = LightReader::create(domain()).value();
  LightFrame received;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(reader->take(received, kPatience)) << reader->refusal();
    expect_same(received, example_lights(received.header.number, 300));
  }
  EXPECT_EQ(reader->writers(), 1);
  child.signal(SIGKILL);
  EXPECT_TRUE(eventually([&] { return reader->writers() == 0; }));
}

// A stopped process acknowledges nothing and empties no socket buffer.
TEST(DdsProcesses, StoppedReaderHoldsUpNeitherWriterNorOtherReaders) {
  const Child child(read_everything);
  const auto lights = LightWriter::create(domain(), "probe").value();
  const auto environment = EnvironmentWriter::create(domain(), "probe").value();
  ASSERT_TRUE(eventually([&] { return lights->readers() == 1 && environment->readers() == 1; }));
  child.signal(SIGSTOP);
  const auto reader = LightReader::create(domain()).value();
  const auto environment_reader = EnvironmentReader::create(domain()).value();
  LightFrame received;
  EnvironmentFrame map;
  for (std::uint64_t number = 1; number <= 500; ++number) {
    ASSERT_TRUE(lights->write(example_lights(number, 300)));
    ASSERT_TRUE(environment->write(example_environment(number, 3)));
    ASSERT_TRUE(reader->take(received, kPatience));
    EXPECT_EQ(received.header.number, number);
    ASSERT_TRUE(environment_reader->take(map, kPatience));
    EXPECT_EQ(map.header.number, number);
  }
  child.signal(SIGCONT);
}

}  // namespace
}  // namespace lightwell
