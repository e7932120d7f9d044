// SPDX-License-Identifier: Apache-2.0
// In place of peer_localize.cpp in a build without the laboratory.
#include "core/base/error.hpp"
#include "tools/strata/peer_localize.hpp"

namespace strata::tools {

std::vector<pipeline::Peer> peers_of_this_build(VerbContext& /*context*/,
                                                const std::string& /*out*/) {
  throw ConfigError(
      "--peers", "this program was built without the laboratory",
      "build with STRATA_LABORATORY=ON, and run tools/install-packages --peers before");
}

}  // namespace strata::tools
