// SPDX-License-Identifier: Apache-2.0
#include "components/convert/patch_messages.hpp"

#include <algorithm>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/map_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {
namespace {

void require(bool is_sound, const char* problem) {
  if (!is_sound) throw InputError("PatchMap", problem, "check the sender's version");
}

bool is_share(double value) { return value >= 0.0 && value <= 1.0 + 1e-6; }

/// Tables over all sub-maps must fit into memory: they lie in or about the base map.
void require_close(const patch::PatchMap& map) {
  CellRect all = map.base.rect();
  for (const patch::Submap& submap : map.submaps) all = all.united(submap.rect);
  require(all.area() / 16 <= map.base.size() + 100'000, "a sub-map lies far from the base map");
}

strata_msgs::msg::Submap submap_to_message(const patch::Submap& submap) {
  strata_msgs::msg::Submap message;
  message.id(submap.id);
  message.rect(to_message(submap.rect));
  message.contradictory(submap.contradictory.values());
  for (const patch::Configuration& configuration : submap.configurations) {
    strata_msgs::msg::Configuration entry;
    entry.reflection(to_message(configuration.reflection));
    entry.counts(to_message(configuration.counts));
    entry.prior(configuration.prior);
    message.configurations().push_back(std::move(entry));
  }
  for (const patch::SequenceInfo& sequence : submap.sequences) {
    strata_msgs::msg::ObservationSequence entry;
    entry.run(sequence.run);
    entry.begin(to_message(sequence.begin));
    entry.end(to_message(sequence.end));
    entry.scans(sequence.scans);
    entry.membership(sequence.membership);
    message.sequences().push_back(std::move(entry));
  }
  return message;
}

patch::Submap submap_from_message(const strata_msgs::msg::Submap& message, double resolution_m) {
  patch::Submap submap;
  submap.id = message.id();
  submap.rect = from_message(message.rect());
  require(!submap.rect.empty() && message.contradictory().size() == submap.rect.area(),
          "a sub-map's cells do not fill its rectangle");
  require(!message.configurations().empty(), "a sub-map has no configuration");
  submap.contradictory = Grid<std::uint8_t>(resolution_m, submap.rect);
  submap.contradictory.values() = message.contradictory();
  for (const auto& entry : message.configurations()) {
    patch::Configuration configuration;
    configuration.reflection = from_message(entry.reflection());
    configuration.counts = from_message(entry.counts());
    configuration.prior = entry.prior();
    require(configuration.reflection.rect() == submap.rect &&
                configuration.counts.rect() == submap.rect &&
                configuration.reflection.resolution_m() == resolution_m &&
                configuration.counts.resolution_m() == resolution_m,
            "a configuration lies on other cells than its sub-map");
    require(is_share(configuration.prior), "a configuration's prior is no probability");
    submap.configurations.push_back(std::move(configuration));
  }
  for (const auto& entry : message.sequences()) {
    patch::SequenceInfo sequence;
    sequence.run = entry.run();
    sequence.begin = from_message(entry.begin());
    sequence.end = from_message(entry.end());
    sequence.scans = entry.scans();
    sequence.membership = entry.membership();
    require(sequence.membership.size() == submap.configurations.size() &&
                std::all_of(sequence.membership.begin(), sequence.membership.end(), is_share),
            "a sequence's memberships are not one probability a configuration");
    submap.sequences.push_back(std::move(sequence));
  }
  return submap;
}

}  // namespace

strata_msgs::msg::PatchMap to_message(const patch::PatchMap& map, Stamp stamp,
                                      const std::string& frame) {
  strata_msgs::msg::PatchMap message;
  message.header(make_header(stamp, frame));
  message.base(to_message(map.base));
  for (const patch::Submap& submap : map.submaps) {
    message.submaps().push_back(submap_to_message(submap));
  }
  return message;
}

patch::PatchMap from_message(const strata_msgs::msg::PatchMap& message) {
  patch::PatchMap map;
  map.base = from_message(message.base());
  for (const auto& submap : message.submaps()) {
    map.submaps.push_back(submap_from_message(submap, map.base.resolution_m()));
    require(map.submaps.back().id == static_cast<int>(map.submaps.size()) - 1,
            "the ids of its sub-maps are not their places");
  }
  require_close(map);
  return map;
}

}  // namespace strata::convert
