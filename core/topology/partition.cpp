// SPDX-License-Identifier: Apache-2.0
#include "core/topology/partition.hpp"

#include <algorithm>
#include <map>

namespace strata::topology {

Labels canonical(const Labels& labels) {
  std::map<int, int> renamed;
  Labels result;
  result.reserve(labels.size());
  for (const int label : labels) {
    const int next = static_cast<int>(renamed.size());
    result.push_back(renamed.emplace(label, next).first->second);
  }
  return result;
}

bool is_canonical(const Labels& labels) {
  int next = 0;
  for (const int label : labels) {
    if (label < 0 || label > next) return false;
    if (label == next) ++next;
  }
  return true;
}

int landmark_count(const Labels& labels) {
  return labels.empty() ? 0 : *std::max_element(labels.begin(), labels.end()) + 1;
}

std::vector<std::size_t> first_visits(const Labels& labels) {
  std::vector<std::size_t> firsts;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == static_cast<int>(firsts.size())) firsts.push_back(i);
  }
  return firsts;
}

}  // namespace strata::topology
