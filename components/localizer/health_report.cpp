// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/health_report.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "components/convert/geometry_messages.hpp"

namespace strata::localizer {

using localization::HealthState;

namespace {

std::string truth(bool value) { return value ? "true" : "false"; }

/// The circle of this radius holds 95% of a Gaussian that spreads in all directions as in its
/// widest: the square root of the chi-squared quantile for two degrees of freedom.
double deviation_range_m(const Eigen::Matrix3d& covariance) {
  constexpr double kQuantile = 2.4477468306808161;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(covariance.topLeftCorner<2, 2>(),
                                                              Eigen::EigenvaluesOnly);
  return kQuantile * std::sqrt(std::max(0.0, solver.eigenvalues().y()));
}

}  // namespace

HealthReport make_health_report(const std::string& model,
                                const localization::LocalizationResult& result,
                                std::chrono::duration<double> update_time) {
  HealthReport report;
  report.model = model;
  report.health = result.health;
  report.health.position_stddev_m = std::sqrt(result.pose.covariance.topLeftCorner<2, 2>().trace());
  report.deviation_range_m = deviation_range_m(result.pose.covariance);
  report.score = result.score;
  report.heading_stddev_rad = std::sqrt(result.pose.covariance(2, 2));
  report.effective_sample_size = result.effective_sample_size;
  report.particles = result.particles;
  report.converged = result.converged;
  report.is_ambiguous = result.is_ambiguous;
  report.places = result.places.size();
  report.is_beyond_map = result.is_beyond_map;
  report.is_recovering = result.is_recovering;
  report.update_time = update_time;
  return report;
}

strata_msgs::msg::LocalizationHealth to_message(const HealthReport& report, Stamp stamp,
                                                const std::string& frame) {
  strata_msgs::msg::LocalizationHealth message;
  message.header(convert::make_header(stamp, frame));
  message.model(report.model);
  message.localized(report.is_localized());
  message.lost(report.is_lost());
  message.particles(static_cast<std::uint32_t>(report.particles));
  message.effective_sample_size(report.effective_sample_size);
  message.position_std(report.health.position_stddev_m);
  message.heading_std(report.heading_stddev_rad);
  message.log_likelihood_per_beam(std::log(report.health.likelihood_per_beam));
  message.update_time(report.update_time.count());
  return message;
}

namespace {

const char* ambiguity_of(std::size_t places) {
  if (places == 0) return "ambiguous: no place has been found yet";
  if (places == 1) return "ambiguous: the place that is left is not confirmed yet";
  return "ambiguous: several places are possible";
}

}  // namespace

void describe(const HealthReport& report, runtime::Health& health) {
  if (report.is_lost()) {
    health.fail("lost");
  } else if (report.is_ambiguous) {
    health.warn(ambiguity_of(report.places));
  } else if (!report.converged) {
    health.warn("not localized yet");
  } else if (report.is_probably_wrong()) {
    health.warn("the pose is probably wrong: the scans speak against it");
  } else if (report.is_recovering) {
    health.warn("the pose is doubted: the robot is looked for elsewhere too");
  } else if (report.is_beyond_map) {
    health.warn("beyond the map: the scans alone tell how the robot moves");
  } else if (report.health.state == HealthState::kMapOutdated) {
    health.warn("the map is outdated here");
  }
  health.add("model", report.model);
  health.add("particles", std::uint64_t{report.particles});
  health.add("ambiguous", truth(report.is_ambiguous));
  health.add("places", std::uint64_t{report.places});
  health.add("recovering", truth(report.is_recovering));
  health.add("beyond_map", truth(report.is_beyond_map));
  health.add("position_std_m", report.health.position_stddev_m);
  health.add("heading_std_rad", report.heading_stddev_rad);
  health.add("update_time_s", report.update_time.count());
  health.add("verdict", enum_name(report.health.state));
  health.add("score", report.score);
  health.add("localizationScore", report.score);
  health.add("deviationRange", report.deviation_range_m);
  health.add("localized", truth(report.is_localized()));
  health.add("probably_wrong", truth(report.is_probably_wrong()));
  health.add("explained_share", report.health.inlier_share_fast);
  health.add("judged_share", report.health.judged_share_fast);
}

void describe_unknown_place(runtime::Health& health) {
  health.add("localizationScore", 0.0);
  health.add("localized", truth(false));
}

}  // namespace strata::localizer
