// SPDX-License-Identifier: Apache-2.0
/// The maps that visits are told relative to (memory/store/coded_visit.hpp).
#pragma once

#include <map>
#include <optional>
#include <string>

#include "components/fleet/connection.hpp"
#include "components/site/site.hpp"
#include "core/grid/reflection_grid.hpp"

namespace strata::fleet {

/// What a robot tells its visits relative to.
struct Coding {
  std::string hash;  ///< of the version
  ReflectionGrid map;
  double tolerance_cells = 1.0;
};

/// A site's active version. Nothing where there is none, or tolerance_cells is 0: every beam goes
/// as it was measured. O(bytes of the version). Throws InputError where the version cannot be read
/// or its hash does not hold.
[[nodiscard]] std::optional<Coding> active_coding(const site::Site& site, double tolerance_cells);

/// The maps of versions by their hashes, each read once: from a local site where that has it whole,
/// else from the server.
class VersionMaps {
 public:
  /// local: may be null. Both outlive this.
  VersionMaps(Connection& connection, std::string site, const site::Site* local);
  /// place: of who asks, for errors. Throws InputError where nobody has that version, and as
  /// fetch().
  [[nodiscard]] const ReflectionGrid& of(const std::string& hash, const std::string& place);

 private:
  [[nodiscard]] ReflectionGrid read(const std::string& hash, const std::string& place);

  Connection& connection_;
  std::string site_;
  const site::Site* local_;
  std::map<std::string, ReflectionGrid> maps_;
};

}  // namespace strata::fleet
