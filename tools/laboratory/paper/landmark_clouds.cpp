// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/landmark_clouds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/topology/partition.hpp"

namespace strata::paper {
namespace {

using topology::Hypothesis;
using topology::MadeVisit;

constexpr double kSameSurface_m = 0.2;
constexpr double kOverlap = 0.5;
constexpr double kTile = 130.0;
constexpr double kGap = 8.0;
constexpr int kColumns = 10;
/// Half of what a tile shows: the radius of the points of a local cloud.
constexpr double kReach_m = topology::LocalCloudConfig{}.point_radius_m;
constexpr std::array kColors{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};

/// Visits by label.
std::vector<std::vector<std::size_t>> by_landmark(const Hypothesis& hypothesis) {
  std::vector<std::vector<std::size_t>> visits(
      static_cast<std::size_t>(topology::landmark_count(hypothesis.labels)));
  for (std::size_t i = 0; i < hypothesis.labels.size(); ++i) {
    visits[static_cast<std::size_t>(hypothesis.labels[i])].push_back(i);
  }
  return visits;
}

}  // namespace

double overlap(const topology::LocalCloud& a, const topology::LocalCloud& b,
               const Pose2& a_from_b) {
  if (a.empty() || b.empty()) return 0.0;
  if (b.size() > a.size()) return overlap(b, a, inverse(a_from_b));
  const topology::NearestPoint surface(a.points_m, kSameSurface_m);
  const auto near =
      std::count_if(b.points_m.begin(), b.points_m.end(), [&](const Eigen::Vector2d& point_m) {
        return surface.find(a_from_b * point_m, kSameSurface_m) != topology::NearestPoint::kNone;
      });
  return static_cast<double>(near) / static_cast<double>(b.size());
}

CloudAgreement cloud_agreement(std::span<const MadeVisit> visits, const Hypothesis& hypothesis) {
  CloudAgreement counts;
  const auto cloud = [&](std::size_t i) -> const topology::LocalCloud& {
    return visits[i].visit.cloud;
  };
  const auto landmarks = by_landmark(hypothesis);
  counts.landmarks = landmarks.size();
  for (const std::vector<std::size_t>& own : landmarks) {
    counts.with_cloud +=
        std::none_of(own.begin(), own.end(), [&](std::size_t i) { return cloud(i).empty(); }) ? 1
                                                                                              : 0;
    for (std::size_t b = 1; b < own.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        const Pose2 a_from_b = inverse(hypothesis.poses[own[a]]) * hypothesis.poses[own[b]];
        ++counts.pairs;
        counts.overlapping += overlap(cloud(own[a]), cloud(own[b]), a_from_b) >= kOverlap ? 1 : 0;
      }
    }
  }
  for (std::size_t b = 1; b < landmarks.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      ++counts.others;
      const double laid = overlap(cloud(landmarks[a].front()), cloud(landmarks[b].front()), {});
      counts.others_overlapping += laid >= kOverlap ? 1 : 0;
    }
  }
  return counts;
}

SvgDrawing draw_clouds(std::span<const MadeVisit> visits, const Hypothesis& hypothesis) {
  const auto landmarks = by_landmark(hypothesis);
  const auto count = static_cast<int>(landmarks.size());
  const int columns = std::min(kColumns, std::max(1, count));
  const int rows = (count + columns - 1) / columns;
  SvgDrawing drawing(columns * (kTile + kGap) + kGap, rows * (kTile + kGap) + kGap);
  const double scale = 0.5 * kTile / kReach_m;
  for (int l = 0; l < count; ++l) {
    const double x = kGap + (l % columns) * (kTile + kGap);
    const int row = l / columns;
    const double y = kGap + row * (kTile + kGap);
    const std::vector<std::size_t>& own = landmarks[static_cast<std::size_t>(l)];
    const Pose2 first_from_map = inverse(hypothesis.poses[own.front()]);
    for (std::size_t v = 0; v < own.size(); ++v) {
      const Pose2 first_from_visit = first_from_map * hypothesis.poses[own[v]];
      for (const Eigen::Vector2d& point_m : visits[own[v]].visit.cloud.points_m) {
        const Eigen::Vector2d at = first_from_visit * point_m;
        if (std::max(std::abs(at.x()), std::abs(at.y())) > kReach_m) continue;
        drawing.rect(x + scale * (kReach_m + at.x()) - 0.6, y + scale * (kReach_m - at.y()) - 0.6,
                     1.2, 1.2, kColors[v % kColors.size()]);
      }
    }
    drawing.frame(x, y, kTile, kTile, "#999");
    drawing.text(x + 3.0, y + 12.0, 11.0, std::to_string(l));
  }
  return drawing;
}

}  // namespace strata::paper
