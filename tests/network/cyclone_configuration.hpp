// SPDX-License-Identifier: Apache-2.0
/// How Cyclone DDS is told which networks to use.
#pragma once

#include <string>
#include <vector>

namespace strata::test {

/// How Cyclone DDS finds others there.
enum class CycloneNetwork {
  kLoopback,  ///< lo, which must multicast
  kUnicast,   ///< as rmw_cyclonedds does for the range LOCALHOST: no multicast, asks localhost
  kDevices,   ///< eth0, or the devices that are named
};

/// The variable of the environment that says so; devices: for kDevices.
inline std::string cyclone_configuration(CycloneNetwork where,
                                         const std::vector<std::string>& devices) {
  std::string general;
  std::string discovery;
  if (where == CycloneNetwork::kUnicast) {
    general = "<AllowMulticast>false</AllowMulticast>";
    discovery =
        "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
        "<Peers><Peer address=\"localhost\"/></Peers>";
  } else {
    for (const std::string& device :
         where == CycloneNetwork::kLoopback ? std::vector<std::string>{"lo"} : devices) {
      general += "<NetworkInterface name=\"" + device + "\"" +
                 (device == "lo" ? " multicast=\"true\"" : "") + "/>";
    }
    general = "<Interfaces>" + general + "</Interfaces>";
  }
  return "CYCLONEDDS_URI=<CycloneDDS><Domain><General>" + general +
         "</General><Discovery><ParticipantIndex>auto</ParticipantIndex>" + discovery +
         "</Discovery></Domain></CycloneDDS>";
}

}  // namespace strata::test
