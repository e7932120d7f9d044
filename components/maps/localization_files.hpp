// SPDX-License-Identifier: Apache-2.0
/// What a localization run leaves behind: trajectory.tum, refined.tum, states.csv and metrics.json.
/// The direct path and the localizer component both write through here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/trajectory_file.hpp"
#include "core/localization/localizer.hpp"

namespace strata::maps {

inline constexpr const char* kRefinedFile = "refined.tum";
inline constexpr const char* kStatesFile = "states.csv";
inline constexpr const char* kMetricsFile = "metrics.json";

/// One row of states.csv.
struct StateRow {
  Stamp stamp;
  int submap = 0;
  int configuration = 0;
  double probability = 0.0;
};

/// The search beside a doubted pose took over with a scan (LocalizationResult::relocated_m).
struct Relocation {
  Stamp stamp;
  double moved_m = 0.0;
  bool was_believed = false;  ///< some scan before spoke for the pose, more than against it
};

/// Scan by scan what the localizer said.
struct LocalizationRecord {
  std::vector<log::StampedPose> trajectory;       ///< mean of the particles, one a scan
  std::vector<log::StampedPose> refined;          ///< of those scans whose pose was refined
  std::vector<StateRow> states;                   ///< as LocalizationResult::submaps, one a row
  std::vector<localization::HealthState> health;  ///< one a scan
  std::vector<double> scores;                     ///< LocalizationResult::score, one a scan
  std::vector<double> place_scores;               ///< ... place_score
  std::vector<Relocation> relocations;
  std::size_t max_particles = 0;
  std::size_t unusable_scans = 0;    ///< so far
  std::size_t ambiguous_scans = 0;   ///< of which several places were still possible
  std::size_t beyond_map_scans = 0;  ///< LocalizationResult::is_beyond_map

  /// Takes up the result of localizer.update for a scan of that stamp, and the pose that was made
  /// of it, if one was.
  void add(Stamp stamp, const localization::LocalizationResult& result,
           const localization::Localizer& localizer,
           const std::optional<Pose2Gaussian>& refined = std::nullopt);
};

/// So many bins of equal width has a score from 0 to 1.
inline constexpr std::size_t kScoreBins = 10;

/// The bin of a score; 1 is in the last one.
[[nodiscard]] std::size_t score_bin(double score);

/// The means of both (null without any) and of the scores, as `bins`, [from, to, scans, null] for
/// each bin. The last is what whoever knows a truth fills in: the share of them further than 0.5 m
/// from it.
[[nodiscard]] nlohmann::json score_json(const std::vector<double>& scores,
                                        const std::vector<double>& place_scores);

/// metrics.json without a truth: the error fields, and cost, are null.
[[nodiscard]] nlohmann::json localization_metrics(const LocalizationRecord& record,
                                                  const std::string& model, std::uint64_t seed,
                                                  int particles);

/// Writes the four files into an existing folder, each whole or not at all. Throws OutputError.
void write_localization_files(const std::filesystem::path& folder, const LocalizationRecord& record,
                              const nlohmann::json& metrics);

}  // namespace strata::maps
