// SPDX-License-Identifier: Apache-2.0
/// The text before the nodes in OctoMap's files, and files opened with care.
#pragma once

#include <cmath>
#include <cstddef>
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

/// A .bt or .ot file whose nodes are all there: OctoMap's readers may have `data`.
struct OctomapFile {
  bool is_binary = false;
  double resolution_m = 0.0;
  std::string data;  ///< empty: a tree without nodes
};
/// Whether a file of voxels of edge_m is one of wanted_m: the header has six digits of it.
[[nodiscard]] inline bool is_same_edge(double edge_m, double wanted_m) {
  return std::abs(edge_m - wanted_m) <= 1e-5 * wanted_m;
}
/// kind: "OcTree" or "ColorOcTree". place: its name in errors. Throws InputError for a tree of
/// another kind; DamageError or UnknownContentError for what is cut short, altered or no such file.
[[nodiscard]] OctomapFile open_octomap_file(const std::string& bytes, const std::string& place,
                                            const std::string& kind);

}  // namespace strata::volume
