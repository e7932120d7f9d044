// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/topology.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>

#include "components/log/spooled_input.hpp"
#include "core/base/error.hpp"
#include "core/topology/topology_mapper.hpp"

namespace strata::pipeline {
namespace {

void follow_landmarks(const std::vector<Observation>& observations,
                      const std::vector<std::optional<Pose2>>& given,
                      topology::TopologyMapper& mapper, Progress* progress, TopologyMap& result) {
  const auto take = [&](std::vector<topology::MadeVisit> visits) {
    for (topology::MadeVisit& visit : visits) {
      const auto begin = std::chrono::steady_clock::now();
      if (!mapper.update(std::move(visit))) continue;
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - begin;
      result.update_ms.push_back(took.count());
    }
  };
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (observations[i].run != observations.front().run) break;
    take(mapper.add(observations[i], i < given.size() && given[i] ? &*given[i] : nullptr));
    report_progress(progress, "follow landmarks", i + 1, observations.size());
  }
  take(mapper.finish());
}

/// Places that a chain of pairs within near_m links have the same number. O(places^2).
std::vector<std::size_t> chains(const std::vector<std::optional<Pose2>>& places, double near_m) {
  std::vector<std::size_t> chain(places.size());
  std::iota(chain.begin(), chain.end(), std::size_t{0});
  for (std::size_t b = 1; b < places.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (!places[a] || !places[b] || chain[a] == chain[b]) continue;
      if (translation_distance(*places[a], *places[b]) > near_m) continue;
      std::replace(chain.begin(), chain.end(), std::size_t{chain[b]}, std::size_t{chain[a]});
    }
  }
  return chain;
}

void count_pairs(const std::vector<std::optional<Pose2>>& places, const topology::Labels& labels,
                 double near_m, double precision_m, TopologyAgreement& counts) {
  const std::vector<std::size_t> chain = chains(places, near_m + precision_m);
  for (std::size_t b = 1; b < places.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      if (!places[a] || !places[b]) continue;
      const double apart_m = translation_distance(*places[a], *places[b]);
      const std::size_t merged = labels[a] == labels[b] ? 1 : 0;
      if (apart_m <= near_m - precision_m) {
        ++counts.near;
        counts.near_merged += merged;
      } else if (apart_m <= near_m + precision_m) {
        ++counts.unclear;
        counts.unclear_merged += merged;
      } else if (apart_m < 2.0 * near_m) {
        ++counts.between;
        counts.between_merged += merged;
        counts.between_chained += chain[a] == chain[b] ? 1 : 0;
      } else {
        ++counts.far;
        counts.far_merged += merged;
      }
    }
  }
}

}  // namespace

TopologyMap map_topology(const std::vector<Observation>& observations,
                         const std::vector<std::optional<Pose2>>& given,
                         std::optional<std::span<const double>> landmark_times_s,
                         const topology::TopologyMapperConfig& config, std::uint64_t seed,
                         int threads, Progress* progress) {
  topology::TopologyMapperConfig used = config;
  if (landmark_times_s) used.landmarks.source = topology::LandmarkSource::kGiven;
  topology::TopologyMapper mapper(used, seed, threads);
  if (landmark_times_s && !observations.empty()) {
    const Stamp begin = observations.front().scan.stamp;
    for (const double time_s : *landmark_times_s) {
      mapper.mark(begin + Duration::from_seconds(time_s));
    }
  }
  TopologyMap result;
  follow_landmarks(observations, given, mapper, progress, result);
  if (mapper.visits().size() < 2) {
    throw InputError("the log",
                     "has " +
                         std::string(mapper.visits().empty() ? "no landmark" : "one landmark") +
                         ", and a topology has two at least",
                     "give --landmarks, or lower landmarks.detector.min_prominence");
  }
  static_cast<topology::TopologyMap&>(result) = topology::make_topology_map(mapper, progress);
  return result;
}

TopologyAgreement agreement(const TopologyMap& result, const topology::Hypothesis& hypothesis,
                            const std::vector<Observation>& observations,
                            const std::vector<std::optional<Pose2>>& truths, double near_m,
                            double precision_m) {
  std::map<Stamp, Pose2> true_poses;
  for (std::size_t i = 0; i < std::min(observations.size(), truths.size()); ++i) {
    if (truths[i]) true_poses[observations[i].scan.stamp] = *truths[i];
  }
  TopologyAgreement agreement;
  std::vector<std::optional<Pose2>> places;
  for (const topology::MadeVisit& visit : result.visits) {
    const auto pose = true_poses.find(visit.visit.stamp);
    places.emplace_back();
    if (pose != true_poses.end()) places.back() = pose->second * visit.robot_from_visit;
  }
  count_pairs(places, hypothesis.labels, near_m, precision_m, agreement);
  return agreement;
}

std::vector<double> read_landmark_times(const std::string& path) {
  log::require_reachable(path);
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw InputError(path, "is a folder, not a file", "name the file with the times of landmarks");
  }
  std::ifstream in(log::readable_path(path));
  if (!in) throw InputError(path, "cannot be read", "check the name and its permissions");
  std::vector<double> times_s;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line.resize(std::min(line.size(), line.find('#')));
    std::istringstream words(line);
    double time_s = 0.0;
    std::string rest;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    if (!(words >> time_s) || !std::isfinite(time_s) || words >> rest) {
      throw InputError(path + ":" + std::to_string(number), "is no time",
                       "write one time a line, in seconds from the first scan");
    }
    times_s.push_back(time_s);
  }
  if (times_s.size() < 2) {
    throw InputError(path,
                     "holds " + std::string(times_s.empty() ? "no time" : "one time") +
                         ", and a topology has two landmarks at least",
                     "write one time a line, in seconds from the first scan");
  }
  return times_s;
}

}  // namespace strata::pipeline
