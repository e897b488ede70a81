// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

namespace lightwell {

// A GigE Vision frame arrives in one burst, which the socket's receive buffer has to hold.

// Bytes of payload the kernel grants when asked for this many: it caps a wish (net.core.rmem_max) without a
// word.
std::size_t granted_socket_buffer(int wish_bytes);
// With CAP_NET_RAW Aravis reads the frames past the socket, from a ring of its own: the cap does not matter.
bool has_packet_socket();
// The line that says that a frame does not fit and what to do; empty where it fits.
std::string socket_buffer_remark(std::size_t frame_bytes, std::size_t granted_bytes);

}  // namespace lightwell
