// SPDX-FileCopyrightText: 2026 The Lightwell Authors
// SPDX-License-Identifier: Apache-2.0
#include "interface/dds_domain.h"

#include <arpa/inet.h>
#include <dds/dds.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>

namespace lightwell {
namespace {

// Cyclone DDS has one domain object an id and process; so do we.
struct Registry {
  std::mutex mutex;
  std::map<int, std::weak_ptr<DdsDomain>> open;
};
Registry& registry() {
  static Registry instance;
  return instance;
}

bool is_ipv4(const std::string& text) {
  in_addr address{};
  return ::inet_pton(AF_INET, text.c_str(), &address) == 1;
}

// Whether an interface of this machine has the address; 127.0.0.0/8 all belongs to lo but only 127.0.0.1 is listed,
// and DDS goes by the list.
bool is_listed(const std::string& ipv4) {
  in_addr wanted{};
  if (::inet_pton(AF_INET, ipv4.c_str(), &wanted) != 1) return false;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return true;  // unknown: the participant will tell
  bool found = false;
  for (const ifaddrs* entry = list; entry != nullptr && !found; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    sockaddr_in address{};
    std::memcpy(&address, entry->ifa_addr, sizeof address);
    found = address.sin_addr.s_addr == wanted.s_addr;
  }
  ::freeifaddrs(list);
  return found;
}

// The interface is one of this machine, and Linux allows neither '"' nor '<' from a sane tool, but names are free:
// escape.
std::string xml_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '"')
      out += "&quot;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

std::string configuration(const DdsOptions& options) {
  if (const char* users = std::getenv("CYCLONEDDS_URI"); users != nullptr && *users != '\0') return users;
  const char* attribute = is_ipv4(options.interface) ? "address" : "name";
  // multicast="true": Linux does not flag lo as multicast capable, though it is.
  // WhcHigh: a large map on its way to a slow reader must not look like congestion (the default is 500 kB).
  return "<CycloneDDS><Domain Id=\"any\"><General><Interfaces><NetworkInterface " + std::string(attribute) +
         "=\"" + xml_escaped(options.interface) +
         "\" multicast=\"true\"/></Interfaces><AllowMulticast>true</AllowMulticast></General>"
         "<Internal><Watermarks><WhcHigh>64MB</WhcHigh></Watermarks></Internal></Domain></CycloneDDS>";
}

}  // namespace

Status check_dds_options(const DdsOptions& options) {
  if (options.domain < 0 || options.domain > kMaxDdsDomain)
    return Error{ErrorKind::usage, "DDS domain " + std::to_string(options.domain) + " is not within 0 to " +
                                       std::to_string(kMaxDdsDomain)};
  if (!is_ipv4(options.interface) && ::if_nametoindex(options.interface.c_str()) == 0)
    return Error{ErrorKind::usage, "DDS interface '" + options.interface +
                                       "' does not exist on this machine (`ip link` lists those that do)"};
  if (is_ipv4(options.interface) && !is_listed(options.interface))
    return Error{ErrorKind::usage, "DDS interface '" + options.interface +
                                       "' is no address of this machine (`ip address` lists those that are)"};
  return {};
}

Result<std::shared_ptr<DdsDomain>> DdsDomain::open(const DdsOptions& options) {
  if (const Status checked = check_dds_options(options); !checked) return checked.error();
  const std::scoped_lock lock(registry().mutex);
  std::weak_ptr<DdsDomain>& slot = registry().open[options.domain];
  if (auto existing = slot.lock()) {
    if (existing->options_.interface == options.interface) return existing;
    return Error{ErrorKind::usage, "DDS domain " + std::to_string(options.domain) +
                                       " is already open on interface '" + existing->options_.interface +
                                       "'"};
  }
  std::shared_ptr<DdsDomain> made(new DdsDomain(options));
  const auto id = static_cast<dds_domainid_t>(options.domain);
  const auto failed = [&](const char* what, dds_return_t code) {
    return Error{ErrorKind::failed, "DDS domain " + std::to_string(options.domain) + " on interface '" +
                                        options.interface + "': " + what + ": " + dds_strretcode(-code)};
  };
  made->domain_ = dds_create_domain(id, configuration(options).c_str());
  if (made->domain_ < 0) return failed("cannot start", made->domain_);
  made->participant_ = dds_create_participant(id, nullptr, nullptr);
  if (made->participant_ < 0) return failed("cannot join", made->participant_);
  slot = made;
  return made;
}

DdsDomain::~DdsDomain() {
  if (participant_ > 0) dds_delete(participant_);
  if (domain_ > 0) dds_delete(domain_);
}

}  // namespace lightwell
