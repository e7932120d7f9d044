// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/journal_replay.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/localizer/filter.hpp"
#include "components/localizer/live_maps.hpp"
#include "components/settings/config_reader.hpp"
#include "core/base/error.hpp"

namespace strata::localizer {
namespace {

bool is_same_bits(const Pose2Gaussian& a, const Pose2Gaussian& b) {
  return std::memcmp(&a.mean, &b.mean, sizeof a.mean) == 0 &&
         std::memcmp(a.covariance.data(), b.covariance.data(),
                     sizeof(double) * static_cast<std::size_t>(a.covariance.size())) == 0;
}

using Messages = std::map<std::string, std::vector<std::uint8_t>>;

template <typename Message>
bool add_if(LiveMaps& maps, const MapMessage& message, const std::vector<std::uint8_t>& cdr) {
  if (message.type != bus::MessageType<Message>::name) return false;
  maps.add(convert::from_cdr<Message>(cdr, message.topic), message);
  return true;
}

/// What the messages of a restore point make of the maps that the localizer began with.
maps::Maps with_messages(const maps::Maps& base, const LocalizerComponentConfig& config,
                         const RestorePoint& point, const Messages& messages) {
  LiveMaps live(maps::map_models().at(config.model), config.map_topics);
  live.begin_with(base);
  for (const MapMessage& message : point.map_messages) {
    const std::vector<std::uint8_t>& cdr = messages.at(message.sha256);
    (void)(add_if<nav_msgs::msg::OccupancyGrid>(live, message, cdr) ||
           add_if<strata_msgs::msg::ReflectionGrid>(live, message, cdr) ||
           add_if<strata_msgs::msg::PatchMap>(live, message, cdr) ||
           add_if<strata_msgs::msg::NodeMap>(live, message, cdr));
  }
  return live.take();
}

/// The filter of a restore point; kept as long as settings and maps stay.
class Filter {
 public:
  Filter(const JournalReplay::FindMaps& find_maps, const Messages& messages, int threads)
      : find_maps_(find_maps), messages_(messages), threads_(threads) {}

  localization::Localizer& restored(const RestorePoint& point) {
    const std::string place = point.localizer + ", restore point";
    if (point.maps_sha256.empty() && point.map_messages.empty()) {
      throw InputError(place,
                       "is in maps that nobody can tell: they came over topics, or their folder "
                       "was replaced while it was read",
                       "have the folder replaced as a whole, or use a site");
    }
    if (!filter_ || point.settings != made_of_.settings ||
        point.maps_sha256 != made_of_.maps_sha256 || point.map_messages != made_of_.map_messages ||
        point.seed != made_of_.seed) {
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
    maps::Maps maps =
        point.maps_sha256.empty() ? no_maps(config) : read_maps(config, find_maps_(point));
    if (!point.map_messages.empty()) maps = with_messages(maps, config, point, messages_);
    model_ = make_model(config, maps);
    filter_ = make_filter(config, model_, maps, point.seed, threads_);
    made_of_ = point;
    made_of_.state.clear();
  }

  const JournalReplay::FindMaps& find_maps_;
  const Messages& messages_;
  int threads_;
  maps::MapModel model_;
  std::unique_ptr<localization::Localizer> filter_;
  RestorePoint made_of_;
};

}  // namespace

void JournalReplay::add(const MapMessage& message, std::vector<std::uint8_t> cdr) {
  messages_[message.sha256] = std::move(cdr);
}

std::vector<MapMessage> JournalReplay::wanted() const {
  std::vector<MapMessage> all;
  for (const auto& [scan, point] : points_) {
    for (const MapMessage& message : point.map_messages) {
      if (std::find(all.begin(), all.end(), message) == all.end()) all.push_back(message);
    }
  }
  return all;
}

bool JournalReplay::has_maps_of(const RestorePoint& point) const {
  return std::all_of(point.map_messages.begin(), point.map_messages.end(),
                     [&](const MapMessage& one) { return messages_.contains(one.sha256); });
}

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
                     "record /LOCALIZER/_restore_point too; a model that has learned more than "
                     "restore_point_mb has none");
  }
  Filter filter(find_maps, messages_, threads);
  std::optional<std::uint64_t> expected;  // the scan that comes next, while the filter goes on
  for (const auto& [number, entry] : scans_) {
    const auto point = points_.find(number);
    const bool goes_on = expected == number;
    if (point != points_.end() && goes_on && point->second.goes_on) {
      ++outcome.compared;
      if (filter.get()->saved_state() == point->second.state) ++outcome.same_states;
    } else if (point != points_.end() && !has_maps_of(point->second)) {
      ++outcome.without_maps;
      expected.reset();
      continue;
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
  if (outcome.restored == 0 && outcome.without_maps > 0) {
    throw InputError("journal", "its maps came over topics, and their messages were not kept",
                     "let the recorder keep the topics of the maps, too");
  }
  return outcome;
}

}  // namespace strata::localizer
