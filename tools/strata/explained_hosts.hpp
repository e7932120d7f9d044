// SPDX-License-Identifier: Apache-2.0
/// A composition made but not run: its components configured, in this process, and seen by nobody.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "components/bus/participant.hpp"
#include "components/runtime/host.hpp"

namespace strata::tools {

struct ExplainedHosts {
  std::shared_ptr<bus::Participant> participant;      ///< of all of them
  std::vector<std::unique_ptr<runtime::Host>> hosts;  ///< one a process, in order
  std::vector<std::filesystem::path> libraries;       ///< loaded for it
};

/// Throws what reading parameters and making components throws. No file is written.
[[nodiscard]] ExplainedHosts explained_hosts(const runtime::Composition& composition);

}  // namespace strata::tools
