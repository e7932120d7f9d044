// SPDX-License-Identifier: Apache-2.0
#include "core/volume/octomap_bytes.hpp"

#include <array>
#include <bit>
#include <cstdint>

namespace strata::volume {
namespace {

constexpr std::size_t kDepth = 16;
constexpr unsigned kInner = 3;  // of a child's two bits in a .bt; 0: there is none

/// The children of a node: which there are, and below which of them the bytes go on.
struct Children {
  unsigned all = 0;
  unsigned read_next = 0;
};

std::size_t bytes_of_node(NodeForm form) {
  switch (form) {
    case NodeForm::kBinary:
      return 2;
    case NodeForm::kFull:
      return 5;
    case NodeForm::kColor:
      return 8;
  }
  return 0;
}

/// node: of either form that ends in a byte of children.
Children children_of_full(std::string_view node) {
  const unsigned bits = static_cast<std::uint8_t>(node.back());
  return {bits, bits};
}

Children children_of_binary(std::string_view node) {
  Children children;
  for (unsigned child = 0; child < 8; ++child) {
    const unsigned byte = static_cast<std::uint8_t>(node[child / 4]);
    const unsigned code = (byte >> (2 * (child % 4))) & 3U;
    if (code != 0) children.all |= 1U << child;
    if (code == kInner) children.read_next |= 1U << child;
  }
  return children;
}

std::size_t count(unsigned bits) { return static_cast<std::size_t>(std::popcount(bits)); }

}  // namespace

std::optional<std::size_t> octomap_nodes(std::string_view data, NodeForm form) {
  const std::size_t node_bytes = bytes_of_node(form);
  std::size_t nodes = 1;
  // How many nodes of each level on the way down are still to be read.
  std::array<std::size_t, kDepth + 1> left{1};
  for (std::size_t depth = 0;;) {
    if (left[depth] == 0) {
      if (depth == 0) return nodes;
      --depth;
      continue;
    }
    --left[depth];
    if (data.size() < node_bytes) return std::nullopt;
    const std::string_view node = data.substr(0, node_bytes);
    const Children children =
        form == NodeForm::kBinary ? children_of_binary(node) : children_of_full(node);
    data.remove_prefix(node_bytes);
    nodes += count(children.all);
    if (children.all != 0 && depth == kDepth) return std::nullopt;
    if (children.read_next != 0) left[++depth] = count(children.read_next);
  }
}

}  // namespace strata::volume
