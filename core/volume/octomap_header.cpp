// SPDX-License-Identifier: Apache-2.0
#include "core/volume/octomap_header.hpp"

#include <string_view>

#include "core/base/damage.hpp"
#include "core/volume/octomap_bytes.hpp"

namespace strata::volume {

OctomapFile open_octomap_file(const std::string& bytes, const std::string& place,
                              const std::string& kind) {
  const std::string remedy =
      "give a .bt or .ot file of the kind '" + kind + "', as OctoMap writes it";
  const auto damaged = [&](const std::string& what) { return DamageError(place, what, remedy); };
  std::istringstream in(bytes, std::ios::binary);
  std::string line;
  std::string id;
  std::size_t size = 0;
  OctomapFile file;
  std::getline(in, line);
  file.is_binary = line == "# Octomap OcTree binary file";
  if (!file.is_binary && line != "# Octomap OcTree file") {
    throw UnknownContentError(place, "is no OctoMap file", remedy);
  }
  while (std::getline(in, line) && line != "data") {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "id") words >> id;
    if (key == "size") words >> size;
    if (key == "res") words >> file.resolution_m;
  }
  if (!in) throw damaged("is damaged: its header has no end");
  if (id != kind) throw InputError(place, "holds a tree of the kind '" + id + "'", remedy);
  // Nothing at all may follow "data", not even the end of its line.
  const auto left = in.eof() ? 0 : bytes.size() - static_cast<std::size_t>(in.tellg());
  if (!(file.resolution_m > 0.0)) throw damaged("is damaged: it says no voxel edge");
  if (left < 2 && size == 0) return file;  // of clouds without points
  if (left < 2) throw damaged("is damaged: it ends too early");
  file.data = bytes.substr(bytes.size() - left);
  const NodeForm full = kind == "ColorOcTree" ? NodeForm::kColor : NodeForm::kFull;
  const auto nodes = octomap_nodes(file.data, file.is_binary ? NodeForm::kBinary : full);
  if (!nodes) throw damaged("is damaged: it ends too early or goes too deep");
  if (*nodes != size) {
    throw damaged("is damaged: " + std::to_string(*nodes) + " nodes of " + std::to_string(size));
  }
  return file;
}

}  // namespace strata::volume
