// SPDX-License-Identifier: Apache-2.0
/// The variables by which a user of ROS 2 says where to look for others.
#pragma once

#include <string>

#include "components/bus/participant.hpp"

namespace strata::bus {

/// What a participant of ROS 2 would do in this environment:
///
/// - ROS_DOMAIN_ID: the domain;
/// - ROS_AUTOMATIC_DISCOVERY_RANGE: SUBNET or SYSTEM_DEFAULT (default transport), LOCALHOST
///   (localhost), OFF (nobody but this process);
/// - ROS_STATIC_PEERS: hosts to ask besides, with ';' between them, where the range is SUBNET or
///   LOCALHOST;
/// - ROS_LOCALHOST_ONLY=1: localhost without static peers, whatever the range says; where the
///   release is Humble or older, which know no range, loopback;
/// - ROS_DISCOVERY_SERVER: transport discovery_server;
/// - ROS_DISTRO: the release;
/// - ROS_SECURITY_ENABLE=true: with security, from the folder ROS_SECURITY_KEYSTORE;
///   ROS_SECURITY_STRATEGY=Enforce: or not at all (default Permissive);
/// - ROS_SECURITY_ENCLAVE_OVERRIDE: as that enclave of the keystore.
///
/// FASTRTPS_DEFAULT_PROFILES_FILE is read by Fast DDS itself; what we set comes on top of it.
/// ros_distro: the release, where it is known from elsewhere; empty: what ROS_DISTRO says.
/// Throws ConfigError, at the variable's name, for a value that is none.
[[nodiscard]] ParticipantOptions options_from_environment(const std::string& ros_distro = {});
/// Whether ROS_SECURITY_ENCLAVE_OVERRIDE says something; it wins over a composition's `enclave`.
[[nodiscard]] bool environment_names_enclave();

}  // namespace strata::bus
