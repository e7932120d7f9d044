// SPDX-License-Identifier: Apache-2.0
#include "components/bus/graph_message.hpp"

#include <algorithm>

#include "strata_idl/rmw_dds_common.h"
#include "strata_idl/rmw_dds_common_24.h"

#include "components/convert/cdr.hpp"

namespace strata::bus {
namespace {

template <typename Gid>
Gid to_gid(const Guid& guid) {
  Gid gid;
  gid.data().fill(0);
  std::copy(guid.begin(), guid.end(), gid.data().begin());
  return gid;
}

template <typename Gid>
Guid from_gid(const Gid& gid) {
  Guid guid{};
  std::copy_n(gid.data().begin(), guid.size(), guid.begin());
  return guid;
}

template <typename Gid>
std::vector<Gid> to_gids(const std::vector<Guid>& guids) {
  std::vector<Gid> result;
  for (const Guid& guid : guids) result.push_back(to_gid<Gid>(guid));
  return result;
}

template <typename Gid>
std::vector<Guid> from_gids(const std::vector<Gid>& gids) {
  std::vector<Guid> result;
  for (const Gid& gid : gids) result.push_back(from_gid(gid));
  return result;
}

/// Info, Node, Gid: the three generated classes of one layout.
template <typename Info, typename Entities, typename Gid>
std::vector<std::uint8_t> encode(const Guid& participant, const std::vector<NodeInfo>& nodes) {
  Info info;
  info.gid(to_gid<Gid>(participant));
  for (const NodeInfo& node : nodes) {
    Entities entities;
    entities.node_namespace(node.node_namespace);
    entities.node_name(node.name);
    entities.reader_gid_seq(to_gids<Gid>(node.readers));
    entities.writer_gid_seq(to_gids<Gid>(node.writers));
    info.node_entities_info_seq().push_back(std::move(entities));
  }
  return convert::to_cdr(info);
}

template <typename Info>
std::pair<Guid, std::vector<NodeInfo>> decode(const std::vector<std::uint8_t>& bytes) {
  const Info info = convert::from_cdr<Info>(bytes, "ros_discovery_info");
  std::vector<NodeInfo> nodes;
  for (const auto& entities : info.node_entities_info_seq()) {
    nodes.push_back({entities.node_namespace(), entities.node_name(),
                     from_gids(entities.reader_gid_seq()), from_gids(entities.writer_gid_seq())});
  }
  return {from_gid(info.gid()), std::move(nodes)};
}

namespace with_16 = rmw_dds_common::msg;
namespace with_24 = rmw_dds_common_24::msg;

}  // namespace

std::vector<std::uint8_t> graph_to_cdr(const Guid& participant, const std::vector<NodeInfo>& nodes,
                                       std::size_t gid_bytes) {
  return gid_bytes == 24
             ? encode<with_24::ParticipantEntitiesInfo, with_24::NodeEntitiesInfo, with_24::Gid>(
                   participant, nodes)
             : encode<with_16::ParticipantEntitiesInfo, with_16::NodeEntitiesInfo, with_16::Gid>(
                   participant, nodes);
}

std::optional<std::pair<Guid, std::vector<NodeInfo>>> graph_from_cdr(
    const std::vector<std::uint8_t>& bytes) {
  if (bytes.size() < 4 || bytes[0] != 0 || bytes[1] > 1) return std::nullopt;
  try {
    if (convert::sequences_fit<with_16::ParticipantEntitiesInfo>(bytes)) {
      return decode<with_16::ParticipantEntitiesInfo>(bytes);
    }
    if (convert::sequences_fit<with_24::ParticipantEntitiesInfo>(bytes)) {
      return decode<with_24::ParticipantEntitiesInfo>(bytes);
    }
  } catch (const InputError&) {  // NOLINT(bugprone-empty-catch): another's damage is not ours
  }
  return std::nullopt;
}

}  // namespace strata::bus
