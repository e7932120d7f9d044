// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/journal_replay.hpp"

#include <cstring>
#include <memory>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/localizer/filter.hpp"
#include "components/settings/config_reader.hpp"
#include "core/base/error.hpp"

namespace strata::localizer {
namespace {

bool is_same_bits(const Pose2Gaussian& a, const Pose2Gaussian& b) {
  return std::memcmp(&a.mean, &b.mean, sizeof a.mean) == 0 &&
         std::memcmp(a.covariance.data(), b.covariance.data(),
                     sizeof(double) * static_cast<std::size_t>(a.covariance.size())) == 0;
}

/// The filter of a restore point; kept as long as settings and maps stay.
class Filter {
 public:
  Filter(const JournalReplay::FindMaps& find_maps, int threads)
      : find_maps_(find_maps), threads_(threads) {}

  localization::Localizer& restored(const RestorePoint& point) {
    const std::string place = point.localizer + ", restore point";
    if (point.maps_sha256.empty()) {
      throw InputError(place, "is in maps that came over topics, of which no file is kept",
                       "localize in a MAPS folder to have incidents that can be replayed");
    }
    if (!filter_ || point.settings != settings_ || point.maps_sha256 != maps_sha256_ ||
        point.seed != seed_) {
      make(point, place);
    }
    filter_->restore(point.state, place);
    return *filter_;
  }
  [[nodiscard]] localization::Localizer* get() { return filter_.get(); }

 private:
  void make(const RestorePoint& point, const std::string& place) {
    const auto config = settings::read_config<LocalizerComponentConfig>(
        settings::parse_yaml(point.settings, place), place);
    const maps::Maps maps = read_maps(config, find_maps_(point));
    model_ = make_model(config, maps);
    filter_ = make_filter(config, model_, maps, point.seed, threads_);
    settings_ = point.settings;
    maps_sha256_ = point.maps_sha256;
    seed_ = point.seed;
  }

  const JournalReplay::FindMaps& find_maps_;
  int threads_;
  maps::MapModel model_;
  std::unique_ptr<localization::Localizer> filter_;
  std::string settings_;
  std::string maps_sha256_;
  std::uint64_t seed_ = 0;
};

}  // namespace

void JournalReplay::add(RestorePoint point) { points_[point.next_scan] = std::move(point); }

void JournalReplay::add(const strata_msgs::msg::LabeledScan& message) {
  PosedScan scan = convert::from_message(message);
  Entry entry;
  entry.observation.run = message.pose().run();
  entry.observation.scan = std::move(scan.scan);
  entry.observation.odom_from_robot = convert::from_message(message.pose().odom_from_robot());
  entry.observation.has_odometry = message.pose().has_odometry();
  entry.map_from_robot = convert::from_message(message.pose().map_from_robot());
  scans_[message.pose().index()] = std::move(entry);
}

JournalReplay::Outcome JournalReplay::run(const FindMaps& find_maps, int threads,
                                          const OnScan& on_scan) const {
  Outcome outcome;
  outcome.scans = scans_.size();
  if (points_.empty()) {
    throw InputError("journal",
                     "has no restore point: " + std::to_string(scans_.size()) +
                         " scans and nothing to begin them with",
                     "record /LOCALIZER/_restore_point too, with a model that does not go on "
                     "learning");
  }
  Filter filter(find_maps, threads);
  std::optional<std::uint64_t> expected;  // the scan that comes next, while the filter goes on
  for (const auto& [number, entry] : scans_) {
    const auto point = points_.find(number);
    const bool goes_on = expected == number;
    if (point != points_.end() && goes_on && point->second.goes_on) {
      ++outcome.compared;
      if (filter.get()->saved_state() == point->second.state) ++outcome.same_states;
    } else if (point != points_.end()) {
      filter.restored(point->second);
      ++outcome.restored;
    } else if (!goes_on) {
      expected.reset();
      continue;
    }
    ReplayedScan scan{entry.observation.scan.stamp, entry.map_from_robot, {}, false};
    scan.replayed = filter.get()->update(entry.observation).pose;
    scan.is_same = is_same_bits(scan.replayed, scan.recorded);
    ++outcome.replayed;
    outcome.same += scan.is_same ? 1 : 0;
    if (!scan.is_same && !outcome.first_difference) outcome.first_difference = scan.stamp;
    if (on_scan) on_scan(scan, *filter.get());
    expected = number + 1;
  }
  return outcome;
}

}  // namespace strata::localizer
