// SPDX-License-Identifier: Apache-2.0
#include "core/topology/dirichlet_process.hpp"

#include <cmath>

namespace strata::topology {

std::vector<double> label_prior(const Labels& labels, double concentration) {
  const double total = static_cast<double>(labels.size()) + concentration;
  std::vector<double> prior(static_cast<std::size_t>(landmark_count(labels)) + 1, 0.0);
  for (const int label : labels) prior[static_cast<std::size_t>(label)] += 1.0 / total;
  prior.back() = concentration / total;
  return prior;
}

double log_partition_prior(const Labels& labels, double concentration) {
  std::vector<double> visits;
  double log_prior = 0.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto label = static_cast<std::size_t>(labels[i]);
    const bool is_new = label == visits.size();
    if (is_new) visits.push_back(0.0);
    const double mass = is_new ? concentration : visits[label];
    log_prior += std::log(mass / (static_cast<double>(i) + concentration));
    visits[label] += 1.0;
  }
  return log_prior;
}

}  // namespace strata::topology
