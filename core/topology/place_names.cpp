// SPDX-License-Identifier: Apache-2.0
#include "core/topology/place_names.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace strata::topology {
namespace {

constexpr int kNoName = 0;

/// A landmark and a name that some of its visits were given.
struct Claim {
  int visits = 0;
  int name = 0;
  int label = 0;
};

}  // namespace

const std::vector<int>& PlaceNames::update(const Labels& labels) {
  std::map<std::pair<int, int>, int> counts;  // visits by landmark and name
  for (std::size_t i = 0; i < first_names_.size(); ++i) ++counts[{labels[i], first_names_[i]}];
  std::vector<Claim> claims;
  for (const auto& [of, visits] : counts) claims.push_back({visits, of.second, of.first});
  std::sort(claims.begin(), claims.end(), [](const Claim& a, const Claim& b) {
    return std::tuple(-a.visits, a.name, a.label) < std::tuple(-b.visits, b.name, b.label);
  });
  names_.assign(static_cast<std::size_t>(landmark_count(labels)), kNoName);
  std::set<int> given;
  for (const Claim& claim : claims) {
    int& name = names_[static_cast<std::size_t>(claim.label)];
    if (name == kNoName && given.insert(claim.name).second) name = claim.name;
  }
  for (int& name : names_) {
    if (name == kNoName) name = next_++;
  }
  for (std::size_t i = first_names_.size(); i < labels.size(); ++i) {
    first_names_.push_back(names_[static_cast<std::size_t>(labels[i])]);
  }
  return names_;
}

}  // namespace strata::topology
