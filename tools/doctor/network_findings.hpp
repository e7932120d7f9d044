// SPDX-License-Identifier: Apache-2.0
/// What networks and users do to messages between endpoints that match.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/doctor/examination.hpp"

namespace strata::doctor {

/// The node or, where it has none, the GUID of an endpoint or participant.
using NameOf = std::function<std::string(const bus::Guid&)>;

/// Messages that were sent elsewhere, or by a DDS that does not tell where, and that did not come:
/// numbers missing between those that did, and latched topics of which nothing has come at all
/// since their writer has been known.
[[nodiscard]] std::vector<Finding> find_losses(const Observed& observed, const NameOf& name_of);

/// Users of this host whose processes share memory: Fast DDS may not open another user's, falls
/// back to nothing, and says nothing. Not even endpoints are discovered, so that nothing but the
/// participants shows it.
[[nodiscard]] std::vector<Finding> find_users_apart(const Observed& observed,
                                                    const NameOf& name_of);

}  // namespace strata::doctor
