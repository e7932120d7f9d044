// SPDX-License-Identifier: Apache-2.0
/// One enclave of a keystore: the six files by which a participant proves who it is.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace strata::security {

/// Where SROS2 keeps them.
struct Enclave {
  std::string name;  ///< "/fleet/robot1", also the name in its certificate
  std::filesystem::path folder;

  [[nodiscard]] std::filesystem::path certificate() const { return folder / "cert.pem"; }
  [[nodiscard]] std::filesystem::path private_key() const { return folder / "key.pem"; }
  [[nodiscard]] std::filesystem::path identity_authority() const {
    return folder / "identity_ca.cert.pem";
  }
  [[nodiscard]] std::filesystem::path permissions_authority() const {
    return folder / "permissions_ca.cert.pem";
  }
  [[nodiscard]] std::filesystem::path governance() const { return folder / "governance.p7s"; }
  [[nodiscard]] std::filesystem::path permissions() const { return folder / "permissions.p7s"; }
  /// Certificates that are no longer good; need not be there.
  [[nodiscard]] std::filesystem::path revoked() const { return folder / "crl.pem"; }
};

/// Throws ConfigError unless it is "/" or reads like "/fleet/robot1": letters, digits and '_'
/// between slashes, as ROS 2 has it, 64 characters at most.
void require_enclave_name(const std::string& name);

/// The enclave's place in this keystore, whether anything is there or not.
[[nodiscard]] Enclave enclave_in(const std::filesystem::path& keystore, const std::string& name);

/// Reads all of it. Throws InputError, at the file, for what is missing, damaged, expired, signed
/// by another authority or made out to another name.
void verify(const Enclave& enclave);

}  // namespace strata::security
