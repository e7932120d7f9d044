// SPDX-License-Identifier: Apache-2.0
#include "components/bus/security.hpp"

#include <filesystem>
#include <string>

#include "components/security/enclave.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

std::string url_of(const std::filesystem::path& file) {
  return "file://" + std::filesystem::absolute(file).string();
}

}  // namespace

bool secure(const ParticipantOptions& options, dds::DomainParticipantQos& qos) {
  const SecurityOptions& security = options.security;
  if (!security.enabled) return false;
  const security::Enclave enclave = security::enclave_in(security.keystore, options.enclave);
  if (!std::filesystem::exists(enclave.certificate())) {
    if (!security.enforced) return false;
    throw InputError("enclave " + options.enclave, "is not in the keystore " + security.keystore,
                     "add it with `strata keystore add " + security.keystore +
                         " ENCLAVE` and name it: enclave: in the composition or "
                         "ROS_SECURITY_ENCLAVE_OVERRIDE");
  }
  verify(enclave);
  auto& properties = qos.properties().properties();
  const auto set = [&](const std::string& name, const std::string& value) {
    properties.emplace_back(name, value);
  };
  const std::string authentication = "dds.sec.auth.builtin.PKI-DH.";
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  set(authentication + "identity_ca", url_of(enclave.identity_authority()));
  set(authentication + "identity_certificate", url_of(enclave.certificate()));
  set(authentication + "private_key", url_of(enclave.private_key()));
  if (std::filesystem::exists(enclave.revoked())) {
    set(authentication + "identity_crl", url_of(enclave.revoked()));
  }
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  set(access + "permissions_ca", url_of(enclave.permissions_authority()));
  set(access + "governance", url_of(enclave.governance()));
  set(access + "permissions", url_of(enclave.permissions()));
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
  return true;
}

}  // namespace strata::bus
