// SPDX-License-Identifier: Apache-2.0
/// The two documents of DDS security 1.1 (9.4.1): what a domain protects, and what one may do.
#pragma once

#include <string>
#include <vector>

namespace strata::security {

/// Topics by their names on the wire ("rt/scan", "rq/robot1/localizer/get_stateRequest"), in which
/// * stands for any text and ? for any character.
struct Permissions {
  std::vector<std::string> publish;
  std::vector<std::string> subscribe;
};

/// Everything, which is what an enclave may do at first, as with SROS2.
[[nodiscard]] Permissions all_permissions();

/// SROS2's governance: nobody without a certificate joins, discovery and data are encrypted,
/// messages signed, reading and writing controlled; for domains 0 to 230, which is as far as the
/// standard's schema goes.
[[nodiscard]] std::string governance_document();

/// What the participant with this certificate name may do, on the same domains, from yesterday on
/// for `valid_days`; all else is denied. ROS 2's ros_discovery_info is always allowed. Throws
/// ConfigError for a topic with characters that no topic has.
[[nodiscard]] std::string permissions_document(const std::string& common_name,
                                               const Permissions& permissions, int valid_days);

}  // namespace strata::security
