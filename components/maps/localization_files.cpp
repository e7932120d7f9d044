// SPDX-License-Identifier: Apache-2.0
#include "components/maps/localization_files.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "components/log/json_text.hpp"
#include "components/log/whole_file.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/base/config.hpp"

namespace strata::maps {
namespace {

using nlohmann::json;

/// Of a score.
constexpr double kLikelierRight = 0.5;

void write_states(const std::filesystem::path& path, const std::vector<StateRow>& rows) {
  log::WholeFile file(path);
  std::ofstream& out = file.stream();
  out.setf(std::ios::fixed);
  out.precision(9);
  out << "time,submap,configuration,probability\n";
  for (const StateRow& row : rows) {
    out << row.stamp.seconds() << ',' << row.submap << ',' << row.configuration << ','
        << row.probability << '\n';
  }
  file.commit();
}

json health_shares(const std::vector<localization::HealthState>& health) {
  json shares = json::object();
  for (const auto& [state, name] : EnumNames<localization::HealthState>::values) {
    const auto count = std::count(health.begin(), health.end(), state);
    shares[name] =
        health.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(health.size());
  }
  return shares;
}

json relocations_json(const LocalizationRecord& record) {
  json rows = json::array();
  for (const Relocation& one : record.relocations) {
    rows.push_back({{"time", one.stamp.seconds()},
                    {"after_s", (one.stamp - record.trajectory.front().stamp).seconds()},
                    {"moved_m", one.moved_m},
                    {"was_believed", one.was_believed}});
  }
  return rows;
}

json mean_of(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

void LocalizationRecord::add(Stamp stamp, const localization::LocalizationResult& result,
                             const localization::Localizer& localizer,
                             const std::optional<Pose2Gaussian>& refined_pose) {
  trajectory.push_back({stamp, result.pose.mean});
  if (refined_pose) refined.push_back({stamp, refined_pose->mean});
  health.push_back(result.health.state);
  if (result.relocated_m) {
    const bool was_believed = std::any_of(place_scores.begin(), place_scores.end(),
                                          [](double score) { return score > kLikelierRight; });
    relocations.push_back({stamp, *result.relocated_m, was_believed});
  }
  scores.push_back(result.score);
  place_scores.push_back(result.place_score);
  max_particles = std::max(max_particles, result.particles);
  unusable_scans = localizer.unusable_scans();
  ambiguous_scans += result.is_ambiguous ? 1 : 0;
  beyond_map_scans += result.is_beyond_map ? 1 : 0;
  for (const localization::SubmapBelief& belief : result.submaps) {
    for (std::size_t k = 0; k < belief.probability.size(); ++k) {
      states.push_back({stamp, belief.submap, static_cast<int>(k), belief.probability[k]});
    }
  }
}

std::size_t score_bin(double score) {
  const double place = std::clamp(score, 0.0, 1.0) * static_cast<double>(kScoreBins);
  return std::min(static_cast<std::size_t>(place), kScoreBins - 1);
}

json score_json(const std::vector<double>& scores, const std::vector<double>& place_scores) {
  std::array<std::size_t, kScoreBins> scans{};
  for (const double score : scores) ++scans[score_bin(score)];
  json bins = json::array();
  for (std::size_t bin = 0; bin < kScoreBins; ++bin) {
    const auto from = static_cast<double>(bin);
    constexpr auto kCount = static_cast<double>(kScoreBins);
    bins.push_back({from / kCount, (from + 1.0) / kCount, scans[bin], nullptr});
  }
  return {{"mean", mean_of(scores)}, {"place_mean", mean_of(place_scores)}, {"bins", bins}};
}

json localization_metrics(const LocalizationRecord& record, const std::string& model,
                          std::uint64_t seed, int particles) {
  return {
      {"model", model},
      {"seed", seed},
      {"particles", particles},
      {"scans", record.trajectory.size()},
      {"unusable_scans", record.unusable_scans},
      {"ambiguous_scans", record.ambiguous_scans},
      {"beyond_map_scans", record.beyond_map_scans},
      {"relocations", relocations_json(record)},
      {"health", health_shares(record.health)},
      {"score", score_json(record.scores, record.place_scores)},
      {"refined", {{"scans", record.refined.size()}, {"error_m", nullptr}, {"error_rad", nullptr}}},
      {"error_m", nullptr},
      {"error_rad", nullptr},
      {"failure_rate", nullptr},
      {"lost", nullptr},
      {"converged_after_s", nullptr},
      {"cost", nullptr}};
}

void write_localization_files(const std::filesystem::path& folder, const LocalizationRecord& record,
                              const json& metrics) {
  log::write_trajectory(folder / kTrajectoryFile, record.trajectory);
  log::write_trajectory(folder / kRefinedFile, record.refined);
  write_states(folder / kStatesFile, record.states);
  log::WholeFile file(folder / kMetricsFile);
  file.stream() << log::json_text(metrics);
  file.commit();
}

}  // namespace strata::maps
