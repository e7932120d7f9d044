// SPDX-License-Identifier: Apache-2.0
#include "components/bus/environment.hpp"

#include <charconv>
#include <cstdlib>

#include "components/bus/node.hpp"
#include "core/base/error.hpp"
#include "core/base/split.hpp"

namespace strata::bus {
namespace {

constexpr const char* kEnclaveOverride = "ROS_SECURITY_ENCLAVE_OVERRIDE";

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : "";
}

int domain_of(const std::string& text) {
  int domain = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (error != std::errc() || end != text.data() + text.size() || domain < 0 || domain > 232) {
    throw ConfigError("ROS_DOMAIN_ID", "is '" + text + "'", "set it to a number from 0 to 232");
  }
  return domain;
}

SecurityOptions security_options() {
  SecurityOptions options;
  const std::string enabled = variable("ROS_SECURITY_ENABLE");
  if (!enabled.empty() && enabled != "true" && enabled != "false") {
    throw ConfigError("ROS_SECURITY_ENABLE", "is '" + enabled + "'", "set it to true or false");
  }
  options.enabled = enabled == "true";
  if (!options.enabled) return options;
  const std::string strategy = variable("ROS_SECURITY_STRATEGY");
  if (!strategy.empty() && strategy != "Enforce" && strategy != "Permissive") {
    throw ConfigError("ROS_SECURITY_STRATEGY", "is '" + strategy + "'",
                      "set it to Enforce or Permissive");
  }
  options.enforced = strategy == "Enforce";
  options.keystore = variable("ROS_SECURITY_KEYSTORE");
  if (options.keystore.empty()) {
    throw ConfigError("ROS_SECURITY_KEYSTORE", "is not set though ROS_SECURITY_ENABLE is true",
                      "set it to a folder that `strata keystore create` made");
  }
  return options;
}

/// The release by ROS_DISTRO; empty where nothing is said. Throws ConfigError at the variable.
std::string release_of_environment() {
  const std::string release = variable("ROS_DISTRO");
  if (release.empty()) return release;
  try {
    (void)gid_bytes_of(release);
  } catch (const ConfigError& error) {
    throw ConfigError("ROS_DISTRO", error.problem(), error.remedy());
  }
  return release;
}

/// Whether that release knows ROS_AUTOMATIC_DISCOVERY_RANGE: it came with Iron, as the short Gid.
bool has_discovery_range(const std::string& ros_distro) { return gid_bytes_of(ros_distro) == 16; }

/// How far to look, and whom to ask besides (rcl's init.c).
void read_discovery(ParticipantOptions& options) {
  if (!variable("ROS_DISCOVERY_SERVER").empty()) options.transport = Transport::kDiscoveryServer;
  if (variable("ROS_LOCALHOST_ONLY") == "1") {
    options.transport =
        has_discovery_range(options.ros_distro) ? Transport::kLocalhost : Transport::kLoopback;
    return;
  }
  const std::string range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE");
  if (range.empty() || range == "SUBNET" || range == "LOCALHOST") {
    options.static_peers = split(variable("ROS_STATIC_PEERS"), ';');
    if (range == "LOCALHOST") options.transport = Transport::kLocalhost;
  } else if (range == "OFF") {
    options.is_alone = true;
  } else if (range != "SYSTEM_DEFAULT") {
    throw ConfigError("ROS_AUTOMATIC_DISCOVERY_RANGE", "is '" + range + "'",
                      "set it to SUBNET, LOCALHOST, OFF or SYSTEM_DEFAULT");
  }
}

}  // namespace

ParticipantOptions options_from_environment(const std::string& ros_distro) {
  ParticipantOptions options;
  if (const std::string domain = variable("ROS_DOMAIN_ID"); !domain.empty()) {
    options.domain = domain_of(domain);
  }
  const std::string release = ros_distro.empty() ? release_of_environment() : ros_distro;
  if (!release.empty()) options.ros_distro = release;
  read_discovery(options);
  options.security = security_options();
  if (environment_names_enclave()) options.enclave = variable(kEnclaveOverride);
  return options;
}

bool environment_names_enclave() { return !variable(kEnclaveOverride).empty(); }

}  // namespace strata::bus
