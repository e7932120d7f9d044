// SPDX-License-Identifier: Apache-2.0
/// A site and its versions, for people and as JSON.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "components/site/site.hpp"
#include "components/site/zones.hpp"

namespace strata::tools {

/// As `strata site list --json` tells one: what version.json says, with its state, who approved it,
/// and mapId, mapVersion and mapHash as VDA 5050 names them.
[[nodiscard]] nlohmann::json json_of(const site::VersionStatus& status);
/// "3 (7f3a9c0b21de)".
[[nodiscard]] std::string name_of(const site::VersionStatus& status);

void print_versions(const site::Site& site);
[[nodiscard]] nlohmann::json json_of_versions(const site::Site& site);

/// What is active, what it would go back to, what waits, and whether the active maps are whole.
[[nodiscard]] nlohmann::json json_of_site(const site::Site& site);
void print_site(const site::Site& site);

/// The last `count` lines of the diary.
void print_diary(const site::Site& site, std::size_t count);

/// "keepout at a cost of 50 %, 2.00 m2".
[[nodiscard]] std::string words_of(const site::Zone& zone);
[[nodiscard]] nlohmann::json json_of(const site::Zone& zone);

}  // namespace strata::tools
