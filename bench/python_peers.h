// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/real_maps.h"
#include "lighting/light_set.h"

namespace lightwell::bench {

// A light set that another's program made of a map.
struct PeerSet {
  std::size_t map = 0;  // index
  int count = 0;
  double ms = 0;  // as the program says, without its start and its reading
  LightSet set;
};
struct PythonPeer {
  std::string name;
  std::vector<PeerSet> sets;
};

// Runs every peer script of the folder (bench/peers/README.md says how they are called) over the maps, with
// `python3` as the shell finds it. A script whose package is missing is left out, aloud; so is all where the
// folder is empty.
std::vector<PythonPeer> python_peers(const std::filesystem::path& folder, const std::vector<NamedMap>& maps,
                                     const std::vector<int>& counts);

}  // namespace lightwell::bench
