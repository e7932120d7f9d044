// SPDX-License-Identifier: Apache-2.0
/// A folder of enclaves in the layout of SROS2, so that `ros2 security` and ROS 2 nodes work with
/// it and theirs with us:
///
///     public/   ca.cert.pem, identity_ca.cert.pem and permissions_ca.cert.pem, which point to it
///     private/  ca.key.pem and the same two names; not for robots
///     enclaves/ governance.p7s and .xml, and a folder for each enclave (enclave.hpp)
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/security/certificate.hpp"
#include "components/security/documents.hpp"
#include "components/security/enclave.hpp"

namespace strata::security {

class Keystore {
 public:
  /// A new one with an authority of its own. Appears whole or not at all. Throws OutputError where
  /// something is already.
  static Keystore create(const std::filesystem::path& folder);
  /// One that is there. Throws InputError for a folder that is no keystore.
  explicit Keystore(std::filesystem::path folder);

  /// A new enclave that may do everything until it is given permissions. One that could not be
  /// finished does not count and may be added again. Throws ConfigError for a name that is none and
  /// OutputError for one that is taken.
  void add(const std::string& enclave) const;
  /// Allows an enclave these topics and nothing else. Throws InputError when it is not there.
  void set_permissions(const std::string& enclave, const Permissions& permissions) const;
  /// The names of those there, sorted.
  [[nodiscard]] std::vector<std::string> enclaves() const;

 private:
  [[nodiscard]] Identity identity_authority() const;
  [[nodiscard]] Identity permissions_authority() const;

  std::filesystem::path folder_;
};

}  // namespace strata::security
