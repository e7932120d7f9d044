// SPDX-License-Identifier: Apache-2.0
/// The files of the project as text, for tests of its structure.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace strata::test {

/// One C++ source file.
struct Source {
  std::string path;  ///< from the root, "core/base/error.hpp"
  std::string text;
  /// What its #include lines name: `<vector>` or `core/base/error.hpp` (quotes removed, brackets
  /// kept), in order.
  std::vector<std::string> includes;
};

/// One strata_room(...) of a CMakeLists.txt.
struct RoomTarget {
  std::string folder;              ///< "core/grid"
  std::string name;                ///< "core_grid"
  std::vector<std::string> links;  ///< the names after LINKS
};

[[nodiscard]] std::filesystem::path source_root();
[[nodiscard]] std::string read_text(const std::filesystem::path& path);
/// What the #include lines of a text name.
[[nodiscard]] std::vector<std::string> includes_of(const std::string& text);
/// Every .hpp and .cpp, or file of other extensions, below the given folders of the root; folders
/// that are missing are empty.
[[nodiscard]] std::vector<Source> read_sources(const std::vector<std::string>& folders,
                                               const std::vector<std::string>& extensions = {
                                                   ".hpp", ".cpp"});
/// Every strata_room(...) in a CMake text.
[[nodiscard]] std::vector<RoomTarget> rooms_of(const std::string& folder, const std::string& text);
/// Every strata_room(...) of the project's rooms.
[[nodiscard]] std::vector<RoomTarget> read_rooms();

}  // namespace strata::test
