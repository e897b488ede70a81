// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Flash that behaves as the chip's does, and whose power can be cut at any operation: a word that was being written keeps
// some bits of each value, a region that was being erased holds anything. After the cut nothing is done any more.

#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "firmware/core/flash.h"

namespace lightwell::test {

class FakeFlash {
 public:
  explicit FakeFlash(std::uint32_t region_size, unsigned seed = 1) : random_(seed) {
    for (auto& region : regions) region.assign(region_size, FLASH_ERASED);
    driver.context = this;
    driver.erase = [](void* self, std::uint32_t region) {
      return static_cast<FakeFlash*>(self)->erase(region);
    };
    driver.write = [](void* self, std::uint32_t region, std::uint32_t offset, const std::uint8_t* bytes,
                      std::uint32_t size) {
      return static_cast<FakeFlash*>(self)->write(region, offset, bytes, size);
    };
    driver.read = [](void* self, std::uint32_t region, std::uint32_t offset, std::uint8_t* bytes,
                     std::uint32_t size) {
      const auto& from = static_cast<FakeFlash*>(self)->regions.at(region);
      if (offset + size > from.size())
        ++static_cast<FakeFlash*>(self)->misuses;
      else
        std::memcpy(bytes, from.data() + offset, size);
    };
  }
  FakeFlash(const FakeFlash&) = delete;
  FakeFlash& operator=(const FakeFlash&) = delete;

  // The power fails within operation number n from now (0: the next one).
  void cut_power_at(std::uint64_t n) {
    cut_at_ = operations + n;
    dead_ = false;
  }
  void restore_power() {
    cut_at_ = UINT64_MAX;
    dead_ = false;
  }
  bool dead() const { return dead_; }

  std::array<std::vector<std::uint8_t>, FLASH_REGIONS> regions;
  flash driver{};
  std::uint64_t operations = 0;
  int misuses = 0;  // out of a region, unaligned, or a word written twice

 private:
  bool cut() {
    if (dead_) return true;
    dead_ = operations++ == cut_at_;
    return dead_;
  }

  bool erase(std::uint32_t region) {
    const bool was_dead = dead_;
    if (cut()) {
      if (!was_dead)
        for (auto& byte : regions.at(region))
          if (random_() % 2 == 0) byte = static_cast<std::uint8_t>(byte | random_());
      return false;
    }
    std::fill(regions.at(region).begin(), regions.at(region).end(), std::uint8_t{FLASH_ERASED});
    return true;
  }

  bool write(std::uint32_t region, std::uint32_t offset, const std::uint8_t* bytes, std::uint32_t size) {
    auto& to = regions.at(region);
    if (offset % 4 != 0 || size % 4 != 0 || offset + size > to.size()) {
      ++misuses;
      return false;
    }
    for (std::uint32_t word = 0; word < size; word += 4) {
      const bool was_dead = dead_;
      const bool torn = cut();
      if (torn && was_dead) return false;
      for (std::uint32_t i = word; i < word + 4; ++i) {
        auto& cell = to[offset + i];
        if (cell != FLASH_ERASED && bytes[i] != cell) ++misuses;
        cell =
            static_cast<std::uint8_t>(cell & (bytes[i] | (torn ? static_cast<std::uint8_t>(random_()) : 0)));
      }
      if (torn) return false;
    }
    return true;
  }

  std::mt19937 random_;
  std::uint64_t cut_at_ = UINT64_MAX;
  bool dead_ = false;
};

}  // namespace lightwell::test
