// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace lightwell::simulator {

// Makes one more address of the loopback network known to this process. Linux answers on all of 127.0.0.0/8,
// but lists 127.0.0.1 alone, and Aravis's fake camera listens only on listed addresses. From now on
// getifaddrs also lists ipv4_host_order, where it is a loopback address that is not listed yet; nothing
// outside the process changes. Once, before threads.
void list_loopback_address(std::uint32_t ipv4_host_order);

}  // namespace lightwell::simulator
