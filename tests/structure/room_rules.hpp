// SPDX-License-Identifier: Apache-2.0
/// "Who may include whom" of docs/architecture.md, as data and as checks.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tests/structure/source_tree.hpp"

namespace strata::test {

/// The room of a file or folder: "core/grid" of "core/grid/grid.hpp", "idl" of generated headers;
/// empty for what is not ours (a library's header).
[[nodiscard]] std::string room_of(const std::string& path);

/// Whether a file of room `from` may include a header of room `to`: its own, those the page allows,
/// and what these may include.
[[nodiscard]] bool may_include(const std::string& from, const std::string& to);

/// What is wrong with the includes of a file, one line each: arrows that point the wrong way; DDS,
/// YAML, printing, clocks and files in core and memory (memory/store may use files); Ceres, OctoMap
/// and Highway in the headers of core; random numbers and clocks that are not ours.
[[nodiscard]] std::vector<std::string> faults_of(const Source& source);

/// Targets of `rooms` that link a room which their folder may not include, one line each.
[[nodiscard]] std::vector<std::string> link_faults(const std::vector<RoomTarget>& rooms);

/// Includes of rooms that the target of the including file does not link, itself or through others.
[[nodiscard]] std::vector<std::string> unlinked_includes(const std::vector<Source>& sources,
                                                         const std::vector<RoomTarget>& rooms);

}  // namespace strata::test
