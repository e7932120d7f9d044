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

void for_each_partition(std::size_t n, const std::function<void(const Labels&)>& visit) {
  Labels labels(n, 0);
  std::vector<int> highest(n, 0);  // among labels[0..i]
  for (;;) {
    visit(labels);
    std::size_t i = n;
    while (i > 1 && labels[i - 1] > highest[i - 2]) --i;
    if (i <= 1) return;
    --i;
    ++labels[i];
    highest[i] = std::max(highest[i - 1], labels[i]);
    for (std::size_t k = i + 1; k < n; ++k) {
      labels[k] = 0;
      highest[k] = highest[i];
    }
  }
}

std::uint64_t bell_number(std::size_t n) {
  // Bell's triangle: each row begins with the last of the row before.
  std::vector<std::uint64_t> row{1};
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<std::uint64_t> next{row.back()};
    for (const std::uint64_t value : row) next.push_back(next.back() + value);
    row = std::move(next);
  }
  return row.front();
}

}  // namespace strata::topology
