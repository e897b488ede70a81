// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "interface/freed_packet.h"
#include "interface/opentrackio_packet.h"
#include "interface/tracking_receiver.h"

namespace lightwell {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put_24(Bytes& bytes, double value) {
  const auto whole = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(value)));
  for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(whole >> shift & 255));
}

void set_checksum(Bytes& bytes) {
  unsigned sum = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) sum += bytes[i];
  bytes.back() = static_cast<std::uint8_t>(0x40 - sum);
}

Bytes freed(double pan, double tilt, double roll, const Vec3d& mm, double zoom = 0) {
  Bytes bytes = {0xD1, 7};
  for (const double angle : {pan, tilt, roll}) put_24(bytes, angle * 32768);
  for (int i = 0; i < 3; ++i) put_24(bytes, mm[i] * 64);
  put_24(bytes, zoom);
  put_24(bytes, 1000);
  bytes.insert(bytes.end(), {0, 0, 0});
  set_checksum(bytes);
  return bytes;
}

// Where a tracked camera's axis and its top point to in the world.
Vec3d forward(const TrackedCamera& tracked) {
  return pose_from_tracked(tracked).world_from_probe * -Vec3d::UnitZ();
}
Vec3d up(const TrackedCamera& tracked) {
  return pose_from_tracked(tracked).world_from_probe * Vec3d::UnitY();
}
Vec3d eye(const TrackedCamera& tracked) {
  return pose_from_tracked(tracked).position_m;
}
void expect_vector(const Vec3d& actual, const Vec3d& expected) {
  EXPECT_LE((actual - expected).norm(), 1e-9) << actual.transpose() << " is not " << expected.transpose();
}

TEST(Freed, AxesAndSignsAreTheManuals) {
  const auto at = [](double pan, double tilt, double roll) {
    const auto packet = parse_freed(freed(pan, tilt, roll, {1000, 2000, 1500}));
    EXPECT_TRUE(packet.ok()) << packet.error().message;
    return packet->camera;
  };
  const double half = std::sqrt(0.5);
  // Stage x, y, z is x, z, −y of the scene; zero looks along +Y of the stage.
  expect_vector(eye(at(0, 0, 0)), {1, 1.5, -2});
  expect_vector(forward(at(0, 0, 0)), {0, 0, -1});
  expect_vector(up(at(0, 0, 0)), {0, 1, 0});
  expect_vector(forward(at(90, 0, 0)), {1, 0, 0});           // pan to the right
  expect_vector(forward(at(0, 45, 0)), {0, half, -half});    // tilt up
  expect_vector(up(at(0, 0, 90)), {1, 0, 0});                // clockwise from behind
  expect_vector(forward(at(-90, 45, 0)), {-half, half, 0});  // tilt about the panned axis
  expect_vector(up(at(180, 0, 90)), {-1, 0, 0});
}

TEST(Freed, ADamagedPacketIsRefused) {
  const Bytes good = freed(10, -20, 1, {1, 2, 3});
  ASSERT_TRUE(parse_freed(good).ok());
  const auto refused = [](Bytes bytes, const char* why) {
    const auto packet = parse_freed(bytes);
    ASSERT_FALSE(packet.ok()) << why;
    EXPECT_EQ(packet.error().kind, ErrorKind::bad_input);
    EXPECT_NE(packet.error().message.find(why), std::string::npos) << packet.error().message;
  };
  refused({}, "0 bytes");
  refused(Bytes(good.begin(), good.end() - 1), "28 bytes");
  Bytes longer = good;
  longer.push_back(0);
  refused(longer, "30 bytes");
  for (std::size_t i = 1; i < good.size(); ++i) {
    Bytes wrong = good;
    wrong[i] ^= 1;
    refused(wrong, "checksum");
  }
  Bytes other = good;
  other[0] = 0xD2;
  set_checksum(other);
  refused(other, "message type");
  refused(freed(181, 0, 0, Vec3d::Zero()), "181");
  EXPECT_TRUE(parse_freed(freed(-180, 90, 180, Vec3d::Constant(-131072))).ok()) << "the ends of the ranges";
}

constexpr const char* kSample =
    R"({"static":{"camera":{"activeSensorPhysicalDimensions":{"width":36.0,"height":24.0}}},)"
    R"("lens":{"pinholeFocalLength":24.0},"transforms":[{"id":"Stage","translation":{"x":10,"y":0,"z":0},)"
    R"("rotation":{"pan":90,"tilt":0,"roll":0}},{"id":"Camera","translation":{"x":0,"y":2,"z":1.5},)"
    R"("rotation":{"pan":0,"tilt":45,"roll":0}}]})";

Bytes datagram(const std::string& payload, std::uint32_t offset = 0, bool last = true,
               std::uint8_t encoding = 1) {
  Bytes bytes = {'O', 'T', 'r', 'k', 0, encoding, 0, 1};
  for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<std::uint8_t>(offset >> shift & 255));
  const std::size_t length = payload.size() | (last ? 0x8000u : 0u);
  bytes.push_back(static_cast<std::uint8_t>(length >> 8));
  bytes.push_back(static_cast<std::uint8_t>(length & 255));
  Bytes all = bytes;
  all.insert(all.end(), payload.begin(), payload.end());
  const std::uint16_t sum = fletcher16(all);
  bytes.push_back(static_cast<std::uint8_t>(sum >> 8));
  bytes.push_back(static_cast<std::uint8_t>(sum & 255));
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

void expect_sample(const Result<std::optional<TrackedCamera>>& taken) {
  ASSERT_TRUE(taken.ok()) << taken.error().message;
  ASSERT_TRUE(taken->has_value());
  const TrackedCamera& camera = **taken;
  // Panned by 90° to the left about +Z, stage +Y is −X: (10 − 2, 0, 1.5) on the stage.
  expect_vector(eye(camera), {8, 1.5, 0});
  const double half = std::sqrt(0.5);
  expect_vector(forward(camera), {-half, half, 0});
  EXPECT_EQ(camera.focal_length_mm, 24.0);
  EXPECT_EQ(camera.sensor_height_mm, 24.0);
}

TEST(OpenTrackIo, TransformsAreComposedInOrderAndTheLensGivesTheField) {
  OpenTrackIoReader reader;
  expect_sample(reader.take(datagram(kSample)));
  const std::string bare = kSample;
  expect_sample(reader.take(Bytes(bare.begin(), bare.end())));
}

TEST(OpenTrackIo, FletcherSumsModulo256) {
  // By hand: "OTrk" is 79, 84, 114, 107: sums 79, 163, 21, 128 and 79, 242, 7, 135.
  const Bytes text = {'O', 'T', 'r', 'k'};
  EXPECT_EQ(fletcher16(text), 0x8780);
}

TEST(OpenTrackIo, SegmentsMakeASampleOnlyWhereAllCome) {
  const std::string sample = kSample;
  const Bytes first = datagram(sample.substr(0, 100), 0, false);
  const Bytes second = datagram(sample.substr(100, 50), 100, false);
  const Bytes third = datagram(sample.substr(150), 150, true);
  OpenTrackIoReader reader;
  EXPECT_FALSE(reader.take(first)->has_value());
  EXPECT_FALSE(reader.take(second)->has_value());
  expect_sample(reader.take(third));
  EXPECT_FALSE(reader.take(first)->has_value());
  EXPECT_FALSE(reader.take(third).ok()) << "the second is missing";
  EXPECT_FALSE(reader.take(second).ok());
  EXPECT_FALSE(reader.take(first)->has_value());
  expect_sample(reader.take(datagram(sample)));
}

TEST(OpenTrackIo, TheSensorIsRememberedFromTheSampleThatToldIt) {
  OpenTrackIoReader reader;
  const std::string later =
      R"({"lens":{"pinholeFocalLength":12},"transforms":[{"translation":{"x":0,"y":0,"z":0}}]})";
  EXPECT_FALSE((*reader.take(datagram(later)))->sensor_height_mm);
  ASSERT_TRUE(reader.take(datagram(kSample)).ok());
  EXPECT_EQ((*reader.take(datagram(later)))->sensor_height_mm, 24.0);
}

TEST(OpenTrackIo, AMalformedDatagramIsRefusedAndTheNextIsRead) {
  OpenTrackIoReader reader;
  const Bytes good = datagram(kSample);
  std::vector<Bytes> wrong;
  for (std::size_t length = 0; length < good.size(); length += 13)
    wrong.emplace_back(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length));
  for (const std::size_t at : {0u, 4u, 5u, 14u, 15u, 40u}) {
    wrong.push_back(good);
    wrong.back()[at] ^= 0x11;
  }
  wrong.push_back(datagram(kSample, 0, true, 2));
  wrong.push_back(datagram(kSample, 0, true, 3));
  for (const char* text :
       {"",
        "{",
        "[]",
        "7",
        "null",
        R"({"transforms":[]})",
        R"({"transforms":[7]})",
        R"({"transforms":{}})",
        R"({"transforms":[{"translation":{"x":NaN,"y":0,"z":0}}]})",
        R"({"transforms":[{"translation":{"x":1e999,"y":0,"z":0}}]})",
        R"({"transforms":[{"translation":{"x":1e7,"y":0,"z":0}}]})",
        R"({"transforms":[{"translation":{"x":"1","y":0,"z":0}}]})",
        R"({"transforms":[{"translation":{"x":1,"y":0}}]})",
        R"({"transforms":[{"rotation":{"pan":1e30,"tilt":0,"roll":0}}]})",
        R"({"transforms":[{"scale":{"x":1e300,"y":0,"z":0}}]})",
        R"({"lens":{"pinholeFocalLength":0},"transforms":[{}]})",
        R"({"sourceNumber":0,"transforms":[{}]})",
        R"({"timing":{"sampleTimestamp":{"seconds":-1,"nanoseconds":0}},"transforms":[{}]})",
        R"({"timing":{"sampleTimestamp":7},"transforms":[{}]})",
        R"({"sourceNumber":201,"transforms":[{}]})",
        R"({"lens":{"pinholeFocalLength":-5},"transforms":[{}]})",
        R"({"lens":[],"transforms":[{}]})"})
    wrong.push_back(datagram(text));
  for (const Bytes& bytes : wrong) {
    const auto taken = reader.take(bytes);
    EXPECT_FALSE(taken.ok()) << std::string(bytes.begin(), bytes.end());
    if (taken.ok()) continue;
    EXPECT_EQ(taken.error().kind, ErrorKind::bad_input);
  }
  expect_sample(reader.take(good));
  EXPECT_FALSE(reader.take(datagram(R"({"lens":{}})"))->has_value()) << "no pose, and nothing wrong";
}

std::string cbor(const char* sample) {
  std::string bytes;
  nlohmann::json::to_cbor(nlohmann::json::parse(sample), bytes);
  return bytes;
}

TEST(OpenTrackIo, CborSaysWhatJsonSays) {
  const std::string sample = cbor(kSample);
  OpenTrackIoReader reader;
  expect_sample(reader.take(datagram(sample, 0, true, 2)));
  EXPECT_FALSE(reader.take(datagram(sample.substr(0, 70), 0, false, 2))->has_value());
  expect_sample(reader.take(datagram(sample.substr(70), 70, true, 2)));
  // By hand (RFC 8949): a map of no given length with an array of one map, translation {x: half 1.5, y: −2,
  // z: float 0.25}.
  const std::string by_hand = "\xBF\x6Atransforms\x81\xA1\x6Btranslation\xA3\x61x\xF9\x3E" +
                              std::string("\x00", 1) + "\x61y\x21\x61z\xFA\x3E\x80" + std::string(2, '\0') +
                              "\xFF";
  const auto taken = reader.take(datagram(by_hand, 0, true, 2));
  ASSERT_TRUE(taken.ok()) << taken.error().message;
  EXPECT_EQ((*taken)->position_m, Vec3d(1.5, -2, 0.25));
}

TEST(OpenTrackIo, MalformedCborIsRefusedAndTheNextIsRead) {
  const std::string good = cbor(kSample);
  std::vector<std::string> wrong;
  for (std::size_t length = 0; length < good.size(); length += 7) wrong.push_back(good.substr(0, length));
  wrong.push_back(good + good);
  wrong.push_back(good + "x");
  wrong.push_back(kSample);
  wrong.push_back("\xFF");
  wrong.push_back("\xD9\xD9\xF7" + good);                         // a tag, which OpenTrackIO has none of
  wrong.push_back("\x1C");                                        // reserved
  wrong.push_back(std::string("\x5B") + std::string(8, '\x7F'));  // bytes, 2^63 of them
  wrong.push_back(std::string("\x9B") + std::string(8, '\xFF'));  // an array of 2^64 − 1
  wrong.push_back(std::string("\xBB") + std::string(8, '\xFF'));  // a map of as many
  wrong.push_back(std::string(30000, '\x81'));                    // arrays in arrays
  wrong.push_back(std::string(30000, '\xBF'));
  wrong.push_back(std::string(40, '\x81') + "\x01");
  wrong.push_back(cbor("[]"));
  wrong.push_back(cbor("7"));
  wrong.push_back(std::string("\xA1\x01\x02"));  // a key that is no text
  // pinholeFocalLength NaN, infinite, bytes.
  for (const std::string& value :
       {std::string("\xF9\x7E\x00", 3), std::string("\xF9\x7C\x00", 3), std::string("\x41\x35")})
    wrong.push_back("\xA1\x64lens\xA1\x72pinholeFocalLength" + value);
  OpenTrackIoReader reader;
  for (const std::string& payload : wrong) {
    const auto taken = reader.take(datagram(payload, 0, true, 2));
    EXPECT_FALSE(taken.ok()) << payload.substr(0, 60);
    if (taken.ok()) continue;
    EXPECT_EQ(taken.error().kind, ErrorKind::bad_input);
    EXPECT_LT(taken.error().message.size(), 200u);
  }
  EXPECT_FALSE(reader.take(datagram(good.substr(0, 70), 0, false, 2))->has_value());
  const auto mixed = reader.take(datagram(good.substr(70), 70, true, 1));
  ASSERT_FALSE(mixed.ok());
  EXPECT_NE(mixed.error().message.find("two encodings"), std::string::npos) << mixed.error().message;
  expect_sample(reader.take(datagram(good, 0, true, 2)));
}

// As root, key and value; the largest datagram, and as much as segments may hold.
TEST(OpenTrackIo, CborNestedWithoutEndIsRefusedAndTheNextIsRead) {
  const std::string good = cbor(kSample);
  OpenTrackIoReader reader;
  for (const unsigned byte : {0x5Fu, 0x7Fu, 0x9Fu, 0xBFu, 0x81u, 0xA1u, 0xC0u})
    for (const std::size_t count : {30'000u, 1'000'000u})
      for (const std::string head : {"", "\xA1", "\xA1\x64lens"}) {
        const std::string payload = head + std::string(count, static_cast<char>(byte));
        constexpr std::uint32_t kSegment = 32'000;
        for (std::uint32_t at = 0; at < payload.size(); at += kSegment) {
          const bool last = at + kSegment >= payload.size();
          const auto taken = reader.take(datagram(payload.substr(at, kSegment), at, last, 2));
          ASSERT_EQ(taken.ok(), !last) << byte << ", " << count << " of them, byte " << at;
        }
        expect_sample(reader.take(datagram(good, 0, true, 2)));
      }
}

TEST(Tracking, OptionsNameProtocolAndAddress) {
  const auto freed_options = parse_tracking("freed:127.0.0.1:6301");
  ASSERT_TRUE(freed_options.ok());
  EXPECT_EQ(freed_options->protocol, TrackingProtocol::freed);
  EXPECT_EQ(freed_options->address.port, 6301);
  EXPECT_TRUE(parse_tracking("opentrackio:239.135.1.5:55555").ok());
  for (const char* wrong :
       {"", "freed", "freed:", "freed:1.2.3.4", "vrpn:1.2.3.4:5", "opentrackio:1.2.3.4:99999"}) {
    const auto parsed = parse_tracking(wrong);
    ASSERT_FALSE(parsed.ok()) << wrong;
    EXPECT_EQ(parsed.error().kind, ErrorKind::usage);
  }
}

TEST(Tracking, APoseGoesThroughBothProtocols) {
  for (const Vec3d& turn : {Vec3d(0, 0, 0), Vec3d(30, -20, 10), Vec3d(-170, 80, 175), Vec3d(179, -89, -90)}) {
    TrackedCamera camera;
    camera.position_m = {12.25, -3.5, 1.71875};
    camera.stage_from_camera = rotation_from_pan_tilt_roll(turn.x(), turn.y(), turn.z());
    const auto freed_packet = parse_freed(freed_message({3, camera, 7, 9}));
    ASSERT_TRUE(freed_packet.ok()) << freed_packet.error().message;
    EXPECT_EQ(freed_packet->camera_id, 3);
    EXPECT_EQ(freed_packet->zoom, 7u);
    EXPECT_EQ(freed_packet->focus, 9u);
    EXPECT_LE((freed_packet->camera.position_m - camera.position_m).norm(), 1e-12);
    // Three angles to half a step of 1/32768°.
    EXPECT_LE((freed_packet->camera.stage_from_camera - camera.stage_from_camera).norm(), 2e-6);
    camera.sampled_ns = 1'700'000'000'123'456'789;
    OpenTrackIoReader reader;
    const auto sample = reader.take(opentrackio_datagram(camera, 65535));
    ASSERT_TRUE(sample.ok()) << sample.error().message;
    ASSERT_TRUE(sample->has_value());
    EXPECT_EQ((*sample)->position_m, camera.position_m);
    EXPECT_LE(((*sample)->stage_from_camera - camera.stage_from_camera).norm(), 1e-12);
    EXPECT_EQ((*sample)->sampled_ns, camera.sampled_ns);
    const ProbePose pose = pose_from_tracked(camera);
    const TrackedCamera again = tracked_from_pose(pose);
    EXPECT_LE((again.position_m - camera.position_m).norm(), 1e-12);
    EXPECT_LE((again.stage_from_camera - camera.stage_from_camera).norm(), 1e-12);
  }
}

TEST(Tracking, StraightUpThePanIsTheWholeTurn) {
  const PanTiltRoll turn = pan_tilt_roll_from(rotation_from_pan_tilt_roll(20, 90, 0));
  EXPECT_NEAR(turn.pan_deg, 20, 1e-9);
  EXPECT_NEAR(turn.tilt_deg, 90, 1e-6);
  EXPECT_EQ(turn.roll_deg, 0);
}

TEST(Tracking, AReceivedPacketIsStampedWhenItArrivedNotWhenItIsRead) {
  TrackingOptions options;
  options.address = {"127.0.0.1", 0};
  auto receiver = TrackingReceiver::open(options);
  ASSERT_TRUE(receiver.ok()) << receiver.error().message;
  EXPECT_FALSE(receiver->next().has_value());
  const int sender = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(receiver->port());
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const Bytes bytes = opentrackio_datagram({}, 1);
  const auto now_ns = [] { return std::chrono::steady_clock::now().time_since_epoch().count(); };
  const auto send = [&] {
    ::sendto(sender, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to);
  };
  // The first socket that asks for stamps has the kernel begin with them a moment later, in a worker thread
  // (net_enable_timestamp): what comes before is stamped when it is read.
  bool stamps = false;
  for (const auto begin = now_ns(); !stamps && now_ns() - begin < 10'000'000'000;) {
    send();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const auto read = now_ns();
    const auto early = receiver->next(std::chrono::seconds(5));
    stamps = early && early->arrived_mono_ns < read - 10'000'000;
  }
  ASSERT_TRUE(stamps) << "every packet was stamped when it was read";
  const auto before = now_ns();
  send();
  const auto sent = now_ns();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const auto arrival = receiver->next(std::chrono::seconds(5));
  ::close(sender);
  ASSERT_TRUE(arrival.has_value());
  EXPECT_EQ(arrival->sender, "127.0.0.1");
  ASSERT_TRUE(arrival->camera.ok());
  constexpr std::int64_t kClocks_ns = 50'000'000;  // read one after the other, on a busy machine
  EXPECT_GE(arrival->arrived_mono_ns, before - kClocks_ns);
  EXPECT_LE(arrival->arrived_mono_ns, sent + kClocks_ns);
}

}  // namespace
}  // namespace lightwell
