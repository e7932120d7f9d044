// SPDX-License-Identifier: Apache-2.0
/// A composition of one process, `p`, with one component, `/filter`.
#pragma once

#include <filesystem>
#include <fstream>

#include "tests/components/bus/domain.hpp"

namespace strata::test {

/// Writes filter.yaml into the folder and gives its path.
inline std::filesystem::path write_filter_composition(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "filter.yaml";
  std::ofstream(file) << "version: 1\ndomain: " << own_domain()
                      << "\ntransport: loopback\nprocesses: [{name: p, components: "
                         "[{type: strata::BeamFilter, name: filter}]}]\n";
  return file;
}

}  // namespace strata::test
