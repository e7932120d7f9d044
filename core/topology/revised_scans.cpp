// SPDX-License-Identifier: Apache-2.0
#include "core/topology/revised_scans.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/topology/expansion.hpp"
#include "core/topology/prediction.hpp"

namespace strata::topology {
namespace {

/// Visits that are expanded again for one revision: a landmark may have been visited a hundred
/// times.
constexpr std::size_t kMostExpanded = 10;

/// Visits before `visit` that are of its landmark.
std::vector<std::size_t> earlier_visits(const Labels& labels, std::size_t visit) {
  std::vector<std::size_t> visits;
  for (std::size_t i = 0; i < visit; ++i) {
    if (labels[i] == labels[visit]) visits.push_back(i);
  }
  return visits;
}

const ScanFactor* factor_of(const Hypothesis& hypothesis, std::size_t visit) {
  const auto found = std::find_if(hypothesis.scans.begin(), hypothesis.scans.end(),
                                  [&](const ScanFactor& scan) { return scan.to == visit; });
  return found == hypothesis.scans.end() ? nullptr : &*found;
}

/// The topology of the first `count` visits, from poses that it need not have had then; nothing
/// when that does not converge.
std::optional<Hypothesis> prefix_of(const Labels& labels, std::size_t count,
                                    const std::vector<ScanFactor>& scans,
                                    const std::vector<Pose2>& poses, const VisitLog& log,
                                    const TopologyConfig& config) {
  const auto end = static_cast<std::ptrdiff_t>(count);
  Hypothesis prefix;
  prefix.labels.assign(labels.begin(), labels.begin() + end);
  prefix.scans = scans;
  prefix.poses.assign(poses.begin(), poses.begin() + end);
  if (count == 1) {
    prefix.gaussian = std::make_shared<const LocationGaussian>();
    return prefix;
  }
  Evidence evidence =
      evaluate(prefix.labels, log.measurements(count), scans, prefix.poses, config.location);
  if (!evidence.converged) return std::nullopt;
  prefix.log_evidence = evidence.log_evidence;
  prefix.poses = std::move(evidence.poses);
  prefix.gaussian = std::move(evidence.gaussian);
  return prefix;
}

/// The scan of the visit after the prefix, under this label.
std::optional<ScanFactor> scan_after(const Hypothesis& prefix, int label,
                                     std::span<const Eigen::Matrix3d> newest_covariances,
                                     VisitLog& log, const TopologyConfig& config) {
  const std::size_t visit = prefix.labels.size();
  const Measurements measured = log.measurements(visit + 1);
  Prediction prediction(prefix.poses, *prefix.gaussian, measured.odometry.back());
  TopologyConfig all = config;
  all.negligible = std::numeric_limits<double>::infinity();  // it is followed, likely or not
  const Children children = expand(prefix, prediction, newest_covariances, log, all);
  const auto child = std::find_if(children.children.begin(), children.children.end(),
                                  [&](const Child& one) { return one.label == label; });
  if (child == children.children.end()) return std::nullopt;
  const std::vector<Overlap> overlaps =
      find_overlaps(prefix, children, prediction.newest(), log, config.match);
  return candidate_evidence(prefix, *child, overlaps, prediction, config,
                            measured.log_new_density.back())
      .scan;
}

}  // namespace

std::vector<ScanFactor> revised_scans(const Particle& from, const Labels& labels, VisitLog& log,
                                      const TopologyConfig& config) {
  const Hypothesis& before = from.hypothesis;
  std::vector<ScanFactor> scans;
  std::size_t expanded = 0;
  for (std::size_t visit = 1; visit < labels.size(); ++visit) {
    const ScanFactor* own = factor_of(before, visit);
    const bool is_new = earlier_visits(labels, visit) != earlier_visits(before.labels, visit);
    std::optional<Hypothesis> prefix;
    if (is_new && expanded < kMostExpanded && !log.visit(visit).cloud.empty()) {
      prefix = prefix_of(labels, visit, scans, before.poses, log, config);
      ++expanded;
    }
    if (!prefix) {
      if (own != nullptr) scans.push_back(*own);
      continue;
    }
    const auto covariances = std::span(from.newest_covariances).first(visit);
    if (const auto scan = scan_after(*prefix, labels[visit], covariances, log, config)) {
      scans.push_back(*scan);
    }
  }
  return scans;
}

}  // namespace strata::topology
