// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dds/dds.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <functional>
#include <memory>
#include <thread>

#include "interface/dds_domain.h"
#include "interface/dds_wire.h"
#include "interface/probe_messages.h"

namespace lightwell::test {

// Even light of a radiance, on a grid about the stage's middle, with a lamp that is the same everywhere.
inline LightField stage_field(float radiance, float lamp_lux = 0, Vec3d to_lamp = Vec3d(0.3, 0.9, 0.1),
                              std::array<int, 3> size = {3, 2, 3}, int degree = 2) {
  LightField field;
  field.grid = {size, Vec3d(-1, 0, -1), Vec3d(1, 2, 1)};
  field.degree = degree;
  field.radiance.assign(field.grid.points() * 3 * static_cast<std::size_t>(field.harmonics()), 0.0f);
  field.confidence.assign(field.grid.points(), 1.0f);
  std::vector<double> y(static_cast<std::size_t>(field.harmonics()));
  harmonics(to_lamp.normalized(), degree, y.data());
  for (int k = 0; k < size[2]; ++k)
    for (int h = 0; h < field.harmonics(); ++h)
      for (int c = 0; c < 3; ++c)
        std::fill_n(field.plane(k, h, c), field.slab_points(),
                    (h == 0 ? 3.5449077f * radiance : 0.0f) +
                        lamp_lux * static_cast<float>(y[static_cast<std::size_t>(h)]));
  return field;
}

// `lightwell field live` as far as a renderer can tell; it also sends what no field may be.
class FakeField {
 public:
  using Spoil = std::function<void(lightwell_FieldFrame&)>;

  explicit FakeField(const DdsOptions& options) : domain_(DdsDomain::open(options).value()) {
    topic_ = dds_create_topic(domain_->participant(), &Wire<FieldFrame>::descriptor(),
                              Wire<FieldFrame>::kTopic, nullptr, nullptr);
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 1);
    dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, DDS_SECS(2));
    writer_ = dds_create_writer(domain_->participant(), topic_, qos, nullptr);
    dds_delete_qos(qos);
    EXPECT_GT(writer_, 0);
  }
  ~FakeField() {
    dds_delete(writer_);
    dds_delete(topic_);
  }
  FakeField(const FakeField&) = delete;
  FakeField& operator=(const FakeField&) = delete;

  void send(const LightField& field, const Spoil& spoil = nullptr) {
    message_.field = field;
    message_.header.number = ++number_;
    lightwell_FieldFrame wire{};
    EXPECT_EQ(to_wire(message_, wire, buffer_), "");
    std::strcpy(wire.probe, "fake");
    if (spoil) spoil(wire);
    dds_write(writer_, &wire);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }

 private:
  std::shared_ptr<DdsDomain> domain_;
  dds_entity_t topic_ = 0, writer_ = 0;
  FieldFrame message_;
  Wire<FieldFrame>::Buffer buffer_;
  std::uint64_t number_ = 0;
};

}  // namespace lightwell::test
