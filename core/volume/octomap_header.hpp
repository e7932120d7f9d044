// SPDX-License-Identifier: Apache-2.0
/// The text before the nodes in OctoMap's files.
#pragma once

#include <sstream>
#include <string>
#include <utility>

namespace strata::volume {

/// As OctoMap writes it; its own functions talk to the terminal. Tree: one of octomap's.
template <typename Tree>
std::string octomap_header(const char* first_line, const Tree& tree) {
  std::ostringstream out;
  out << first_line
      << "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\nid "
      << tree.getTreeType() << "\nsize " << tree.size() << "\nres " << tree.getResolution()
      << "\ndata\n";
  return std::move(out).str();
}

}  // namespace strata::volume
