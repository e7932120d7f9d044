// SPDX-License-Identifier: Apache-2.0
#include "components/security/enclave.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "components/security/certificate.hpp"
#include "components/security/text_file.hpp"
#include "core/base/error.hpp"

namespace strata::security {

void require_enclave_name(const std::string& name) {
  constexpr std::size_t kLongest = 64;  // of a certificate's common name
  const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '/';
  });
  const bool has_parts = name.size() > 1 && name.back() != '/';
  if (is_plain && !name.empty() && name.front() == '/' && (name == "/" || has_parts) &&
      name.find("//") == std::string::npos && name.size() <= kLongest) {
    return;
  }
  throw ConfigError("enclave '" + name + "'", "is no name of an enclave",
                    "write it like /fleet/robot1: letters, digits and '_', 64 characters at most");
}

Enclave enclave_in(const std::filesystem::path& keystore, const std::string& name) {
  require_enclave_name(name);
  const std::filesystem::path folder = keystore / "enclaves";
  return {name, name == "/" ? folder : folder / name.substr(1)};
}

void verify(const Enclave& enclave) {
  const std::string authority = read_text(enclave.identity_authority());
  const Identity identity{read_text(enclave.certificate()), read_text(enclave.private_key())};
  verify_identity(identity, authority, enclave.name, enclave.certificate().string());
  const std::string signer = read_text(enclave.permissions_authority());
  for (const auto& document : {enclave.governance(), enclave.permissions()}) {
    (void)verify_signed(read_text(document), signer, document.string());
  }
}

}  // namespace strata::security
