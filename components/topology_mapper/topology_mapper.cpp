// SPDX-License-Identifier: Apache-2.0
#include "components/topology_mapper/topology_mapper.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/kept_file.hpp"
#include "components/log/stored_bytes.hpp"
#include "components/log/whole_folder.hpp"
#include "components/log/writable_place.hpp"
#include "components/topologies/topology_files.hpp"
#include "components/topologies/topology_messages.hpp"
#include "core/base/error.hpp"
#include "core/grid/counting_map.hpp"
#include "core/slam/resumed_place.hpp"
#include "core/topology/topology_map.hpp"

namespace strata::topology_mapper {
namespace {

constexpr double kSurroundings_m = 0.05;    ///< its cells
constexpr std::size_t kSurroundings = 100;  ///< scans
/// Between the last scan by a clock and the first after it was set back.
constexpr double kStep_s = 0.1;

}  // namespace

void TopologyMapper::on_configure() {
  config_ = read_parameters<TopologyMapperComponentConfig>();
  make_mapper();
  publish_ = advertise<strata_msgs::msg::Topologies>(config_.topic, "latched");
  subscribe<geometry_msgs::msg::PointStamped>(
      config_.landmark_topic, "default", [this](const auto& message) { on_landmark(message); });
  subscribe<strata_msgs::msg::ScanPose>("given_pose", "default",
                                        [this](const auto& message) { given_ = message; });
  subscribe_sensors(config_.input, config_.sensor_qos);
  if (lockstep() || config_.store.file.empty()) return;
  log::require_own_file(config_.store.file, log::kDatabase, "store.file");
  require_way(config_.store.file);
  if (context().dry_run) return log::require_file_place(config_.store.file);
  open_store();
}

void TopologyMapper::make_mapper() {
  mapper_ = std::make_unique<topology::TopologyMapper>(
      config_.mapping, context().seed, context().threads,
      lockstep() ? topology::PathKeepConfig{} : config_.keep);
}

void TopologyMapper::open_store() {
  const bool is_whole = restored(config_.store.file, [&] {
    MapperStore store(config_.store.file);  // closed again when it is damaged
    restored_ = store.restore(*mapper_);
    store_ = std::move(store);
  });
  if (!is_whole) {
    make_mapper();
    store_.emplace(config_.store.file);
  }
  if (restored_) last_scan_ = restored_->stamp;
}

void TopologyMapper::on_activate() {
  if (!mapper_->visits().empty()) publish();
}

bool TopologyMapper::resume(const Observation& first) {
  const runtime::KeptMoment kept{restored_->stamp, restored_->odom_from_robot.has_value()};
  waits_for_odometry_ = config_.input.use_odometry &&
                        runtime::needs_odometry(kept, first, config_.store.dead_reckoning);
  if (waits_for_odometry_) return false;
  const double since_s = (first.scan.stamp - restored_->stamp).seconds();
  if (since_s <= 0.0) {
    tell(InputError(config_.store.file,
                    "its newest scan is " + std::to_string(-since_s) + " s ahead of the clock",
                    "see whether the clock is right; the way is gone on with, and as many seconds "
                    "are added to its stamps"));
    go_on_after(restored_->stamp, first.scan.stamp);
  }
  if (!has_gone_on(kept, first)) restored_->odom_from_robot.reset();
  mapper_->resume_from(*restored_);
  restored_.reset();
  return true;
}

/// Visits are in order of time, and a scan is known by its stamp: the way has a time of its own.
void TopologyMapper::go_on_after(Stamp newest, Stamp first) {
  ahead_ = newest + Duration::from_seconds(kStep_s) - first;
}

/// What the newest scans saw tells whether odometry began anew a moment ago.
bool TopologyMapper::has_gone_on(const runtime::KeptMoment& kept, const Observation& first) {
  if (!runtime::is_dead_reckoned(kept, first, config_.store.dead_reckoning)) return false;
  const ReflectionGrid seen = newest_surroundings();
  if (seen.size() == 0) return true;
  const slam::ResumedPlace place = slam::resumed_place(
      {restored_->stamp, restored_->odom_from_robot, restored_->map_from_robot}, first, true, seen);
  if (!place.fits()) {
    tell(InputError(
        full_name(),
        "the first scan does not look as those before it do where the robot is taken "
        "to be",
        "where it was carried meanwhile, remove '" + config_.store.file + "' to begin anew"));
  }
  return place.is_dead_reckoned;
}

ReflectionGrid TopologyMapper::newest_surroundings() const {
  CountingMap counts(kSurroundings_m);
  const std::vector<PosedScan>& scans = mapper_->scans();
  const std::size_t first = scans.size() - std::min(scans.size(), kSurroundings);
  for (std::size_t i = first; i < scans.size(); ++i) counts.add(scans[i]);
  return counts.reflection();
}

void TopologyMapper::mark(Stamp stamp) {
  if (mapper_->mark(stamp) && store_) store_->mark(stamp);
}

void TopologyMapper::on_landmark(const geometry_msgs::msg::PointStamped& message) {
  const Stamp stamp = convert::from_message(message.header().stamp());
  if (stamp.ns != 0) {
    mark(stamp + ahead_);
  } else if (last_scan_) {
    mark(*last_scan_);
  }
}

void TopologyMapper::on_observation(const Observation& scanned) {
  Observation observation = scanned;
  const std::optional<Pose2> given = convert::take_given(given_, observation);
  if (!last_scan_) {
    for (const double time_s : config_.landmark_times_s) {
      mark(observation.scan.stamp + Duration::from_seconds(time_s));
    }
  }
  if (restored_ && !resume(observation)) return;
  if (std::exchange(is_set_back_, false) && mapper_->newest()) {
    go_on_after(mapper_->newest()->stamp, observation.scan.stamp);
  }
  observation.scan.stamp = observation.scan.stamp + ahead_;
  last_scan_ = observation.scan.stamp;
  const std::size_t scans = mapper_->scans().size();
  std::vector<topology::MadeVisit> visits = mapper_->add(observation, given ? &*given : nullptr);
  if (store_ && mapper_->scans().size() > scans) store_->add(mapper_->scans().back());
  if (store_ && mapper_->newest()) store_->came_to(*mapper_->newest());
  update(std::move(visits));
}

std::string TopologyMapper::on_clock_set_back() {
  is_set_back_ = true;
  return "the way is gone on with, and what the clock has lost is added to its stamps";
}

void TopologyMapper::update(std::vector<topology::MadeVisit> visits) {
  bool grown = false;
  for (topology::MadeVisit& visit : visits) {
    const auto begin = std::chrono::steady_clock::now();
    grown = mapper_->update(std::move(visit)) || grown;
    update_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    max_update_s_ = std::max(max_update_s_, update_s_);
  }
  if (grown) publish();
}

void TopologyMapper::publish() {
  std::vector<Stamp> stamps;
  for (const topology::MadeVisit& visit : mapper_->visits()) stamps.push_back(visit.visit.stamp);
  publish_(convert::to_message(
      mapper_->filter().summaries(static_cast<std::size_t>(config_.published_topologies)), stamps,
      config_.map_frame));
}

void TopologyMapper::on_finish(const std::filesystem::path& out_dir) {
  update(mapper_->finish());
  write(out_dir / config_.out_subfolder, context().progress);
}

void TopologyMapper::on_tick() {
  const std::chrono::duration<double> since = std::chrono::steady_clock::now() - flushed_;
  if (!store_ || since.count() < config_.store.save_period_s) return;
  flushed_ = std::chrono::steady_clock::now();
  store_->flush();
}

void TopologyMapper::on_deactivate() {
  if (store_) guarded([&] { store_->flush(); });  // the map may have room elsewhere
  if (lockstep() || config_.save.empty()) return;
  update(mapper_->finish());
  log::WholeFolder folder(config_.save);
  write(folder.aside(), nullptr);  // the process ends, which cancels what has a progress
  folder.commit();
}

void TopologyMapper::write(const std::filesystem::path& folder, Progress* progress) {
  const topology::TopologyMap map = topology::make_topology_map(*mapper_, progress);
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw OutputError(folder.string(), "cannot be made: " + error.message(),
                      "check the folder and its permissions");
  }
  topologies::write_topology_files(folder, map, topologies::topologies_json(map));
}

void TopologyMapper::on_diagnose(runtime::Health& health) const {
  diagnose_input(health);
  if (!mapper_) return;
  if (waits_for_odometry_) health.warn("waits for odometry, to go on from its store");
  if (mapper_->is_full()) {
    health.warn(
        "the map is complete: its scans use keep.memory_mb, and no more are taken; raise "
        "it, or begin anew with another store");
  }
  const topology::TopologyCounts counts = mapper_->counts();
  const std::vector<topology::Hypothesis>& posterior = mapper_->posterior();
  health.add("visits of landmarks", std::uint64_t{mapper_->visits().size()});
  health.add("topologies", std::uint64_t{posterior.size()});
  if (!posterior.empty()) {
    health.add("probability of the likeliest", posterior.front().probability);
    health.add("landmarks of the likeliest",
               static_cast<std::uint64_t>(topology::landmark_count(posterior.front().labels)));
  }
  health.add("scans tracked", std::uint64_t{mapper_->tracked_scans()});
  health.add("scans kept", std::uint64_t{mapper_->scans().size()});
  if (ahead_.ns != 0) health.add("seconds added to stamps", ahead_.seconds());
  health.add("scans left out", std::uint64_t{mapper_->skipped_scans()});
  health.add("landmarks out of order", std::uint64_t{counts.late_visits});
  health.add("landmarks with broken odometry", std::uint64_t{counts.broken_visits});
  health.add("landmarks without points around", std::uint64_t{counts.empty_clouds});
  health.add("local clouds that did not fit", std::uint64_t{counts.failed_matches});
  health.add("topologies tried", std::uint64_t{counts.optimized});
  health.add("topologies that did not converge", std::uint64_t{counts.not_converged});
  health.add("landmarks nearly at one place", std::uint64_t{counts.near_landmarks});
  health.add("update_time_s", update_s_);
  if (store_)
    health.add_later("store_bytes", [this] { return log::stored_bytes(config_.store.file); });
  health.add("longest_update_time_s", max_update_s_);
}

void TopologyMapper::on_cleanup() {
  store_.reset();
  restored_.reset();
  waits_for_odometry_ = false;
  is_set_back_ = false;
  ahead_ = {};
  mapper_.reset();
  given_.reset();
  last_scan_.reset();
  update_s_ = 0.0;
  max_update_s_ = 0.0;
}

}  // namespace strata::topology_mapper
