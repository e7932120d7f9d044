// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/map_fit.hpp"

#include <algorithm>
#include <map>

namespace strata::pipeline {

double LogFit::share(FitState which) const {
  if (scans.empty()) return 0.0;
  const auto count = std::count_if(scans.begin(), scans.end(),
                                   [&](const FittedScan& scan) { return scan.fit == which; });
  return static_cast<double>(count) / static_cast<double>(scans.size());
}

bool LogFit::is_explained() const {
  return scans.empty() || share(FitState::kExplained) >= kMinExplained;
}

void MapFit::add(const Observation& observation, const localization::LocalizationResult& result,
                 const localization::ParticleSet& particles) {
  if (!result.weighed) return;
  const Pose2& pose = result.pose.mean;
  window_[fit_.scans.size() % kFitWindow] =
      judge_->inlier_shares(observation.scan, pose, particles);
  const std::size_t count = std::min(fit_.scans.size() + 1, kFitWindow);
  double inlier = 0.0;
  double judged = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    inlier += window_[i].inlier;
    judged += window_[i].judged;
  }
  FittedScan fitted{observation.scan.stamp, pose, inlier / static_cast<double>(count)};
  fitted.is_ambiguous = result.is_ambiguous;
  fit_.places.clear();
  for (const localization::PlaceBelief& place : result.places) {
    fit_.places.push_back(place.map_from_robot);
  }
  if (judged < localization::kMinJudged * static_cast<double>(count)) {
    fitted.fit = FitState::kUnknown;
  } else {
    fitted.fit = inlier >= kMinInliers * judged ? FitState::kExplained : FitState::kContradicted;
  }
  fit_.scans.push_back(fitted);
}

LogFit fit_of_trajectory(const ReflectionGrid& map, std::span<const Observation> observations,
                         std::span<const log::StampedPose> trajectory) {
  std::map<Stamp, Pose2> poses;
  for (const log::StampedPose& at : trajectory) poses[at.stamp] = at.pose;
  MapFit fit(map);
  localization::LocalizationResult result;
  result.weighed = true;
  for (const Observation& observation : observations) {
    const auto found = poses.find(observation.scan.stamp);
    if (found == poses.end()) continue;
    result.pose.mean = found->second;
    fit.add(observation, result, {});
  }
  return fit.fit();
}

}  // namespace strata::pipeline
