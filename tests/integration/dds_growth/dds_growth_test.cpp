// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <dds/dds.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "interface/dds_topics.h"
#include "tests/integration/dds_growth/next.h"  // generated from next.idl
#include "tests/support/dds.h"

namespace lightwell {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 20s;  // longer than discovery takes on a busy machine

// The next version on the same topic under the same type name, as another program would have it.
class NextVersion : public testing::Test {
 protected:
  NextVersion() : NextVersion(lightwell_next_LightFrame_desc, "LightFrame") {}
  NextVersion(dds_topic_descriptor_t descriptor, const std::string& name) {
    const std::string type = "lightwell::" + name, topic = "lightwell/" + name;
    descriptor.m_typename = type.c_str();  // is copied
    const auto id = static_cast<dds_domainid_t>(test::own_domain().domain);
    participant_ = dds_create_participant(id, nullptr, nullptr);
    topic_ = dds_create_topic(participant_, &descriptor, topic.c_str(), nullptr, nullptr);
    EXPECT_GT(topic_, 0);
    dds_qset_liveliness(qos_, DDS_LIVELINESS_AUTOMATIC, DDS_SECS(1));
    dds_qset_reliability(qos_, DDS_RELIABILITY_BEST_EFFORT, 0);
  }
  ~NextVersion() override {
    dds_delete_qos(qos_);
    dds_delete(participant_);
  }

  std::shared_ptr<DdsDomain> domain_ = DdsDomain::open(test::own_domain()).value();
  dds_qos_t* qos_ = dds_create_qos();
  dds_entity_t participant_ = 0;
  dds_entity_t topic_ = 0;
};

TEST_F(NextVersion, WriterIsUnderstoodByTodaysReader) {
  const auto reader = LightReader::create(domain_).value();
  const dds_entity_t writer = dds_create_writer(participant_, topic_, qos_, nullptr);
  ASSERT_GT(writer, 0);
  lightwell_next_Light lights[2] = {{{0, 1, 0}, {1, 2, 3}, 11, -1, 0.25f, 0.5f, 7},
                                    {{1, 0, 0}, {4, 5, 6}, 12, 0, 0.125f, 0.25f, 8}};
  float zones[3] = {7, 8, 9};
  lightwell_next_LightFrame sent{};
  std::strcpy(sent.probe, "next");
  sent.header.camera_sequence = 42;
  sent.header.delay_frames = 3;
  sent.header.clock_offset_s = 1e300;
  sent.has_parents = true;
  sent.lights = {2, 2, lights, false};
  sent.zones = {3, 3, zones, false};
  LightFrame received;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  bool taken = false;
  while (!taken && std::chrono::steady_clock::now() < deadline) {
    ++sent.header.number;
    ASSERT_EQ(dds_write(writer, &sent), DDS_RETCODE_OK);
    taken = reader->take(received, 20ms);
  }
  ASSERT_TRUE(taken) << reader->refusal();
  EXPECT_EQ(received.header.probe, "next");
  EXPECT_EQ(received.header.sequence, 42u);
  EXPECT_EQ(received.header.delay_frames, 3);
  ASSERT_EQ(received.lights.size(), 2u);
  EXPECT_EQ(received.lights[1].direction, Vec3f::UnitX());
  EXPECT_EQ(received.lights[1].illuminance[2], 6);
  EXPECT_EQ(received.lights[1].id, 12u);
  EXPECT_EQ(received.lights[1].parent, 0);
  EXPECT_EQ(received.lights[1].predicted_error, 0.125f);
  EXPECT_EQ(received.lights[1].angular_radius_rad, 0.25f);
}

TEST_F(NextVersion, ReaderUnderstandsTodaysWriterAndFindsNewMembersEmpty) {
  const auto writer = LightWriter::create(domain_, "today").value();
  const dds_entity_t reader = dds_create_reader(participant_, topic_, nullptr, nullptr);
  ASSERT_GT(reader, 0);
  LightFrame sent;
  sent.header.sequence = 42;
  sent.lights = {{.direction = Vec3f::UnitX(),
                  .illuminance = {4, 5, 6},
                  .parent = -1,
                  .id = 12,
                  .predicted_error = 0.25f,
                  .angular_radius_rad = 0.125f}};
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  void* sample = nullptr;
  dds_sample_info_t info{};
  int count = 0;
  while (count == 0 && std::chrono::steady_clock::now() < deadline) {
    ++sent.header.number;
    ASSERT_TRUE(writer->write(sent));
    count = dds_take(reader, &sample, &info, 1, 1);
    if (count == 0) std::this_thread::sleep_for(5ms);
  }
  ASSERT_EQ(count, 1);
  const auto& received = *static_cast<const lightwell_next_LightFrame*>(sample);
  EXPECT_STREQ(received.probe, "today");
  EXPECT_EQ(received.header.camera_sequence, 42u);
  EXPECT_EQ(received.header.clock_offset_s, 0);
  ASSERT_EQ(received.lights._length, 1u);
  EXPECT_EQ(received.lights._buffer[0].id, 12u);
  EXPECT_EQ(received.lights._buffer[0].predicted_error, 0.25f);
  EXPECT_EQ(received.lights._buffer[0].angular_radius_rad, 0.125f);
  EXPECT_EQ(received.lights._buffer[0].distance_m, 0);
  EXPECT_EQ(received.zones._length, 0u);
  dds_return_loan(reader, &sample, count);
}

class NextField : public NextVersion {
 protected:
  NextField() : NextVersion(lightwell_next_FieldFrame_desc, "FieldFrame") {
    dds_qset_reliability(qos_, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_durability(qos_, DDS_DURABILITY_TRANSIENT_LOCAL);
  }
};

constexpr std::uint16_t kHalfOne = 0x3c00;  // IEEE 754

TEST_F(NextField, WriterIsUnderstoodByTodaysReader) {
  const auto reader = FieldReader::create(domain_).value();
  const dds_entity_t writer = dds_create_writer(participant_, topic_, qos_, nullptr);
  ASSERT_GT(writer, 0);
  std::vector<std::uint16_t> radiance(8 * 12, kHalfOne);
  std::vector<std::uint8_t> confidence(8, 255), blocked(8, 7);
  lightwell_next_FieldProbe probes[2] = {{"left", {1, 2, 3}, 11, 0.5f, 1, {0, 0, 0, 1}},
                                         {"right", {4, 5, 6}, 12, 0.25f, 0.5f, {0, 1, 0, 0}}};
  lightwell_next_FieldLamp lamps[2] = {{21, {0, 2, 0}, 0.01f, {1, 2, 3}, 1, 0.05f},
                                       {22, {1, 2, 0}, 0.02f, {4, 5, 6}, 0.75f, 0.06f}};
  lightwell_next_FieldFrame sent{};
  std::strcpy(sent.probe, "stage");
  sent.header.clock_offset_s = 1e300;
  for (int a = 0; a < 3; ++a) {
    sent.size[a] = 2;
    sent.high[a] = 1;
  }
  sent.degree = 1;
  sent.scale = 4;
  sent.half_radiance = {96, 96, radiance.data(), false};
  sent.confidence = {8, 8, confidence.data(), false};
  sent.probes = {2, 2, probes, false};
  sent.lamps = {2, 2, lamps, false};
  sent.blocked = {8, 8, blocked.data(), false};
  FieldFrame received;
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  bool taken = false;
  while (!taken && std::chrono::steady_clock::now() < deadline) {
    ++sent.header.number;
    ASSERT_EQ(dds_write(writer, &sent), DDS_RETCODE_OK);
    taken = reader->take(received, 20ms);
  }
  ASSERT_TRUE(taken) << reader->refusal();
  EXPECT_EQ(received.header.probe, "stage");
  EXPECT_EQ(received.field.degree, 1);
  EXPECT_EQ(received.field.radiance, std::vector<float>(96, 4.0f));
  EXPECT_EQ(received.field.confidence, std::vector<float>(8, 1.0f));
  ASSERT_EQ(received.probes.size(), 2u);
  EXPECT_EQ(received.probes[1].name, "right");
  EXPECT_EQ(received.probes[1].position, Vec3d(4, 5, 6));
  EXPECT_EQ(received.probes[1].weight, 0.5f);
  ASSERT_EQ(received.lamps.size(), 2u);
  EXPECT_EQ(received.lamps[1].id, 22u);
  EXPECT_EQ(received.lamps[1].intensity[2], 6);
  EXPECT_EQ(received.lamps[1].weight, 0.75f);
}

TEST_F(NextField, ReaderUnderstandsTodaysWriterAndFindsNewMembersEmpty) {
  const auto writer = FieldWriter::create(domain_, "stage").value();
  const dds_entity_t reader = dds_create_reader(participant_, topic_, nullptr, nullptr);
  ASSERT_GT(reader, 0);
  FieldFrame sent;
  sent.field.grid = {{2, 2, 2}, Vec3d::Zero(), Vec3d::Ones()};
  sent.field.degree = 1;
  sent.field.radiance.assign(96, 1.0f);
  sent.field.confidence.assign(8, 1.0f);
  sent.probes = {{"left", Vec3d(1, 2, 3), 11, 0.5f, 1}, {"right", Vec3d(4, 5, 6), 12, 0.25f, 0.5f}};
  sent.lamps = {{21, Vec3d(0, 2, 0), 0.01f, {1, 2, 3}, 1}, {22, Vec3d(1, 2, 0), 0.02f, {4, 5, 6}, 0.75f}};
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  void* sample = nullptr;
  dds_sample_info_t info{};
  int count = 0;
  while (count == 0 && std::chrono::steady_clock::now() < deadline) {
    ++sent.header.number;
    ASSERT_TRUE(writer->write(sent));
    count = dds_take(reader, &sample, &info, 1, 1);
    if (count == 0) std::this_thread::sleep_for(5ms);
  }
  ASSERT_EQ(count, 1);
  const auto& received = *static_cast<const lightwell_next_FieldFrame*>(sample);
  EXPECT_STREQ(received.probe, "stage");
  EXPECT_EQ(received.header.clock_offset_s, 0);
  EXPECT_EQ(received.half_radiance._length, 96u);
  ASSERT_EQ(received.probes._length, 2u);
  EXPECT_STREQ(received.probes._buffer[1].probe, "right");
  EXPECT_EQ(received.probes._buffer[1].weight, 0.5f);
  EXPECT_EQ(received.probes._buffer[1].turn[3], 0);
  ASSERT_EQ(received.lamps._length, 2u);
  EXPECT_EQ(received.lamps._buffer[1].id, 22u);
  EXPECT_EQ(received.lamps._buffer[1].weight, 0.75f);
  EXPECT_EQ(received.lamps._buffer[1].radius_m, 0);
  EXPECT_EQ(received.blocked._length, 0u);
  dds_return_loan(reader, &sample, count);
}

// A writer in another process, until it is killed.
class Publishing {
 public:
  explicit Publishing(const DdsOptions& options) : pid_(::fork()) {
    if (pid_ != 0) return;
    const auto writer = LightWriter::create(DdsDomain::open(options).value(), "child").value();
    std::this_thread::sleep_for(3 * kPatience);
    ::_exit(0);
  }
  ~Publishing() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Publishing(const Publishing&) = delete;
  Publishing& operator=(const Publishing&) = delete;

 private:
  pid_t pid_;
};

// Anybody can find out what is published: the type travels with the discovery.
TEST(TypeInformation, IsOnTheWire) {
  const Publishing child(test::own_domain());
  const auto domain = DdsDomain::open(test::own_domain()).value();
  const dds_entity_t publications =
      dds_create_reader(domain->participant(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr);
  ASSERT_GT(publications, 0);
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  std::string type_name;
  bool with_type = false;
  while (type_name.empty() && std::chrono::steady_clock::now() < deadline) {
    void* sample = nullptr;
    dds_sample_info_t info{};
    if (dds_take(publications, &sample, &info, 1, 1) != 1) {
      std::this_thread::sleep_for(5ms);
      continue;
    }
    auto* endpoint = static_cast<dds_builtintopic_endpoint_t*>(sample);
    if (std::string_view(endpoint->topic_name) == "lightwell/LightFrame") {
      type_name = endpoint->type_name;
      const dds_typeinfo_t* type = nullptr;
      EXPECT_EQ(dds_builtintopic_get_endpoint_type_info(endpoint, &type), DDS_RETCODE_OK);
      with_type = type != nullptr;
    }
    EXPECT_EQ(dds_return_loan(publications, &sample, 1), DDS_RETCODE_OK);
  }
  EXPECT_EQ(type_name, "lightwell::LightFrame");
  EXPECT_TRUE(with_type);
}

}  // namespace
}  // namespace lightwell
