// SPDX-License-Identifier: Apache-2.0
#include "tests/interop/cyclone/process.hpp"

#include "tests/components/bus/domain.hpp"

namespace strata::test {
namespace {

constexpr const char* kGeneral =
    "<General><Interfaces><NetworkInterface name=\"lo\"/>"
    "</Interfaces><AllowMulticast>false</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>"
    "</General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>30</MaxAutoParticipantIndex><SPDPInterval>100ms</SPDPInterval>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>";

/// With the plugins that Debian builds.
std::string security_section(const std::filesystem::path& enclave) {
  if (enclave.empty()) return "";
  const auto file = [&](const std::string& element, const char* name) {
    return "<" + element + ">file:" + (enclave / name).string() + "</" + element + ">";
  };
  const auto library = [](const std::string& path, const std::string& suffix) {
    return "<Library path=\"" + path + "\" initFunction=\"init_" + suffix +
           "\" finalizeFunction=\"finalize_" + suffix + "\"/>";
  };
  return "<Security><Authentication>" + library("dds_security_auth", "authentication") +
         file("IdentityCertificate", "cert.pem") + file("IdentityCA", "identity_ca.cert.pem") +
         file("PrivateKey", "key.pem") + "</Authentication><Cryptographic>" +
         library("dds_security_crypto", "crypto") + "</Cryptographic><AccessControl>" +
         library("dds_security_ac", "access_control") + file("Governance", "governance.p7s") +
         file("PermissionsCA", "permissions_ca.cert.pem") + file("Permissions", "permissions.p7s") +
         "</AccessControl></Security>";
}

std::vector<std::string> command_of(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {STRATA_CYCLONE_PEER, std::to_string(own_domain())};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

}  // namespace

CycloneProcess::CycloneProcess(const std::vector<std::string>& arguments,
                               const std::filesystem::path& enclave)
    : ChildProcess(command_of(arguments),
                   {std::string("CYCLONEDDS_URI=<CycloneDDS><Domain>") + kGeneral +
                    security_section(enclave) + "</Domain></CycloneDDS>"}) {}

CycloneProcess::~CycloneProcess() {
  close_input();
  wait();
}

}  // namespace strata::test
