// SPDX-License-Identifier: Apache-2.0
#include "components/timescale_memory/timescale_memory.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "components/convert/scan_messages.hpp"
#include "components/log/damaged_file.hpp"
#include "components/log/kept_file.hpp"
#include "components/log/stored_bytes.hpp"
#include "components/log/writable_place.hpp"
#include "components/maps/changes_json.hpp"
#include "components/maps/maps_folder.hpp"
#include "components/maps/node_map_message.hpp"
#include "components/site/learn_limits.hpp"
#include "core/base/damage.hpp"
#include "core/base/error.hpp"
#include "core/grid/blind_beams.hpp"
#include "memory/nodes/changed_places.hpp"

namespace strata::timescale_memory {
namespace {

/// Nodes on disk that one published map reads and decodes, nearest first: a large building comes
/// in parts instead of keeping the robot waiting.
constexpr std::size_t kMaxReadAtOnce = 50;
/// After publishing for t, nothing is published for so many t: at most a twentieth of a core.
constexpr int kRestsAWork = 19;

/// So long after a start nothing is saved while the store may be of another frame.
constexpr std::chrono::seconds kLongestDoubt(20);
/// As many damaged nodes are told of one by one: a store may have thousands.
constexpr std::uint64_t kMaxToldNodes = 5;

/// "robot1", "/robot1" and "/robot1/" are the same.
std::string topic_of(const std::string& robot) {
  const std::size_t begin = robot.find_first_not_of('/');
  if (begin == std::string::npos) return "/labeled_scan";
  const std::size_t end = robot.find_last_not_of('/');
  return "/" + robot.substr(begin, end + 1 - begin) + "/labeled_scan";
}

void require_level(const TimescaleMemoryConfig& config, const char* key, const std::string& name) {
  const auto& levels = config.timescale.levels;
  const bool is_there = std::any_of(levels.begin(), levels.end(),
                                    [&](const auto& level) { return level.name == name; });
  if (is_there || name.empty()) return;
  throw ConfigError(key, "names the level '" + name + "', which the memory does not have",
                    "name one of timescale.levels");
}

}  // namespace

void TimescaleMemory::on_configure() {
  config_ = read_parameters<TimescaleMemoryConfig>();
  require_level(config_, "changes_before", config_.changes_before);
  require_level(config_, "changes_now", config_.changes_now);
  keep_live(config_, {"publish_period_s", "changes_period_s"});
  if (!config_.zones.empty()) {
    never_learned_ = site::learn_limits(site::zones_at(config_.zones), kZoneCell_m).never;
  }
  const bool is_kept = !lockstep() && !config_.store.empty();
  if (is_kept) log::require_own_file(config_.store, log::kDatabase, "store");
  if (is_kept && context().dry_run) log::require_file_place(config_.store);
  if (is_kept && !context().dry_run) {
    open_store();
  } else {
    memory_.emplace(config_.timescale, context().seed);
  }
  publish_map_ = advertise<strata_msgs::msg::NodeMap>("node_map", "latched");
  publish_changes_ = advertise<std_msgs::msg::String>("changed_places", "latched");
  for (const auto& level : config_.timescale.levels) {
    publish_level_.push_back(
        advertise<sensor_msgs::msg::LaserScan>("expected_scan/" + level.name, "default"));
  }
  if (lockstep() || config_.robots.empty()) {
    subscribe<strata_msgs::msg::LabeledScan>(lockstep() ? "mapped_scan" : "labeled_scan",
                                             "lossless",
                                             [this](const auto& message) { on_scan(message); });
    return;
  }
  for (std::size_t robot = 0; robot < config_.robots.size(); ++robot) {
    subscribe<strata_msgs::msg::LabeledScan>(
        topic_of(config_.robots[robot]), "lossless",
        [this, robot](const auto& message) { on_scan(message, static_cast<int>(robot)); });
  }
}

void TimescaleMemory::open_store() {
  const auto open = [&] {
    MemoryFile file(config_.store, config_.save_period_s,
                    static_cast<std::size_t>(config_.resident_nodes));
    memory_.emplace(file.resume(config_.timescale, context().seed));
    file_ = std::move(file);
  };
  if (!restored(config_.store, open)) open();
  frame_.reset();
  const std::size_t nodes = memory_->nodes().size();
  if (nodes > 0) frame_.emplace(memory::StoredPlaces(nodes));
}

void TimescaleMemory::check_frame(const PosedScan& scan) {
  const FrameLook look = frame_->places.agreement(*memory_, config_.decoding, scan);
  switch (frame_->watch.add(scan.map_from_laser().translation(), look)) {
    case FrameWatch::Verdict::kOpen:
      return;
    case FrameWatch::Verdict::kSame:
      frame_.reset();
      return;
    case FrameWatch::Verdict::kOther:
      begin_anew();
  }
}

void TimescaleMemory::begin_anew() {
  // What was learned since the start is of the other frame, and the scans go on coming.
  file_.reset();
  memory_.reset();
  decoded_.reset();
  frame_.reset();
  guarded([this] {  // where it cannot be set aside, it stays, and is gone on in RAM only
    warn(log::other_frame(config_.store, log::set_aside(config_.store)));
    open_store();
  });
  if (!memory_) memory_.emplace(config_.timescale, context().seed);
}

bool TimescaleMemory::may_save() const {
  return !frame_ || !frame_->watch.is_in_doubt() ||
         std::chrono::steady_clock::now() - frame_->since > kLongestDoubt;
}

void TimescaleMemory::on_diagnose(runtime::Health& health) const {
  if (!memory_) return;
  health.add("nodes", std::uint64_t{memory_->nodes().size()});
  health.add("nodes in RAM", std::uint64_t{memory_->resident()});
  health.add("nodes damaged", damaged_nodes_);
  health.add("observations", memory_->observations());
  if (file_) health.add_later("store_bytes", [this] { return log::stored_bytes(config_.store); });
}

void TimescaleMemory::on_tick() {
  if (file_ && may_save()) file_->save(*memory_, false);
}

void TimescaleMemory::on_deactivate() {
  if (file_) file_->save(*memory_, true);
}

bool TimescaleMemory::is_time_to_publish(Stamp stamp) {
  if (lockstep() || config_.publish_period_s <= 0.0) return false;
  if (std::chrono::steady_clock::now() < rest_until_) return false;
  // Stamps may run backwards, as when a bag starts again.
  const bool is_due = !last_published_ ||
                      std::abs((stamp - *last_published_).seconds()) >= config_.publish_period_s;
  if (is_due) last_published_ = stamp;
  return is_due;
}

void TimescaleMemory::on_scan(const strata_msgs::msg::LabeledScan& message, int robot) {
  PosedScan scan = convert::from_message(message);
  if (!lockstep()) poses_[robot].require(scan.map_from_robot, resolve("labeled_scan"));
  // Robots that share a memory count their runs each for itself: only the clock is common.
  if (!config_.robots.empty()) scan.run = 0;
  (void)blind_beams(scan, never_learned_);
  if (frame_) check_frame(scan);
  try {
    memory_->observe(scan, nullptr, robot);
  } catch (const DamageError& error) {  // the next scan makes another node there
    pass_over(error);
  }
  if (!is_time_to_publish(scan.scan.stamp)) return;
  const auto begin = std::chrono::steady_clock::now();
  publish_map(scan.scan.stamp, kMaxReadAtOnce);
  publish_expected(scan, message.scan().header().frame_id());
  publish_changes(scan.scan.stamp);
  const auto end = std::chrono::steady_clock::now();
  rest_until_ = end + kRestsAWork * (end - begin);
}

void TimescaleMemory::pass_over(const DamageError& error) {
  if (++damaged_nodes_ > kMaxToldNodes) return;
  warn(DamageError(error.place(), error.problem() + "; it is passed over, and learned anew",
                   "put the store back from a backup while the component is stopped"));
}

void TimescaleMemory::publish_map(Stamp stamp, std::size_t max_read) {
  std::vector<memory::DamagedNode> damaged;
  decoded_ = memory_->decode(config_.decoding, decoded_.get(), 0.0, max_read, &damaged);
  for (const memory::DamagedNode& found : damaged) {
    memory_->pass_over(found.node);
    pass_over(found.error);
  }
  publish_map_(maps::to_message(*memory_, *decoded_, stamp, config_.map_frame));
}

void TimescaleMemory::publish_changes(Stamp stamp) {
  if (config_.changes_period_s <= 0.0) return;
  if (last_changes_ && std::abs((stamp - *last_changes_).seconds()) < config_.changes_period_s) {
    return;
  }
  last_changes_ = stamp;
  const std::vector<std::string>& levels = decoded_->level_names();
  const std::string& before =
      config_.changes_before.empty() ? levels.back() : config_.changes_before;
  const std::string& now = config_.changes_now.empty() ? levels.front() : config_.changes_now;
  const auto places =
      memory::changed_places(*decoded_, decoded_->level_index(before), decoded_->level_index(now));
  std_msgs::msg::String message;
  message.data(nlohmann::ordered_json{{"stamp", stamp.seconds()},
                                      {"frame", config_.map_frame},
                                      {"before", before},
                                      {"now", now},
                                      {"places", maps::to_json(places)}}
                   .dump());
  publish_changes_(message);
}

void TimescaleMemory::publish_expected(const PosedScan& scan, const std::string& frame) {
  std::vector<double> bearings_rad;
  for (std::size_t i = 0; i < scan.scan.size(); ++i) {
    bearings_rad.push_back(scan.scan.bearing_rad(i));
  }
  Scan expected = scan.scan;
  for (std::size_t level = 0; level < publish_level_.size(); ++level) {
    decoded_->expected_ranges_m(static_cast<int>(level), scan.map_from_laser(), bearings_rad,
                                expected.ranges_m);
    publish_level_[level](convert::to_message(expected, frame));
  }
}

void TimescaleMemory::on_finish(const std::filesystem::path& out_dir) {
  memory_->close_day();
  publish_map(Stamp(), std::numeric_limits<std::size_t>::max());
  maps::write_timescale(out_dir, *memory_);
}

void TimescaleMemory::on_cleanup() {
  memory_.reset();
  decoded_.reset();
  frame_.reset();
  poses_.clear();
  never_learned_ = Grid<std::uint8_t>(kZoneCell_m, CellRect{}, 0);
  damaged_nodes_ = 0;
  last_published_.reset();
  last_changes_.reset();
  rest_until_ = {};
  file_.reset();
  publish_level_.clear();
}

}  // namespace strata::timescale_memory
