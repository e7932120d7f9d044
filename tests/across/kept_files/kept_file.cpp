// SPDX-License-Identifier: Apache-2.0
#include "tests/across/kept_files/kept_file.hpp"

#include <fstream>

#include "components/beam_filter/register.hpp"
#include "components/localizer/place_store.hpp"
#include "components/localizer/register.hpp"
#include "components/log/state_store.hpp"
#include "components/scan_matcher/register.hpp"
#include "components/timescale_memory/register.hpp"
#include "components/topology_mapper/mapper_store.hpp"
#include "components/topology_mapper/register.hpp"
#include "components/volume_mapper/register.hpp"
#include "core/beam_filter/online_filter.hpp"
#include "core/slam/slam.hpp"
#include "core/volume/volume_map.hpp"
#include "memory/store/store.hpp"
#include "tests/components/topology_mapper/niche_room.hpp"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kScans = 30;

std::vector<Observation> drive() {
  std::vector<Observation> observations;
  for (const Moment& moment : there_and_back()) {
    if (observations.size() == kScans) break;
    Observation observation;
    observation.scan = scan_at(moment);
    observation.odom_from_robot = moment.pose;
    observation.has_odometry = true;
    observations.push_back(std::move(observation));
  }
  return observations;
}

void write_slam(const fs::path& file) {
  slam::Slam slam{slam::SlamConfig{}};
  for (const Observation& observation : drive()) (void)slam.add(observation);
  log::write_state_file(file, slam.save_state());
}

void write_filter(const fs::path& file) {
  beam_filter::OnlineFilter filter;
  for (const Observation& observation : drive()) {
    (void)filter.add({0, observation.scan, observation.odom_from_robot, {}});
  }
  log::write_state_file(file, filter.save_state());
}

void write_place(const fs::path& file) {
  localizer::PlaceStoreConfig config;
  config.file = file.string();
  localizer::PlaceStore store(config, Eigen::Matrix3d::Zero());
  store.keep(drive().back(), {Pose2{1.0, 2.0, 0.5}, Eigen::Matrix3d::Identity()});
  store.flush();
}

void write_memory(const fs::path& file) {
  memory::TimescaleMemory memory({}, 1);
  for (const Observation& observation : drive()) {
    (void)memory.observe({0, observation.scan, observation.odom_from_robot, {}});
  }
  memory::Store(file).save_timescale(memory);
}

void write_way(const fs::path& file) {
  topology::TopologyMapper mapper({});
  topology_mapper::MapperStore store(file);
  for (const Observation& observation : drive()) {
    const std::size_t before = mapper.scans().size();
    (void)mapper.add(observation);
    if (mapper.scans().size() > before) store.add(mapper.scans().back());
  }
  store.came_to(*mapper.newest());
  store.flush();
}

void write_volume(const fs::path& file) {
  volume::VolumeMap map(volume::VolumeConfig{});
  volume::Cloud cloud;
  for (int i = 0; i < 400; ++i) {
    cloud.points_m.emplace_back(2.0F, 0.1F * static_cast<float>(i % 20),
                                0.1F * static_cast<float>(i) / 20.0F);
  }
  WorkerPool pool(1);
  (void)map.insert(cloud, {}, pool);
  std::ofstream(file, std::ios::binary) << map.full_file();
}

}  // namespace

std::string KeptFile::entry(const fs::path& file, const std::string& more) const {
  std::string named = parameter;
  named.replace(named.find('%'), 1, "'" + file.string() + "'");
  return "{type: strata::" + component + ", name: keeper, parameters: {" + named +
         (more.empty() ? "" : ", " + more) + "}}";
}

const std::vector<KeptFile>& kept_files() {
  static const std::vector<KeptFile> files{
      {"ScanMatcher", "slam.state", write_slam, "store: {file: %}",
       "slam: {beam_filter: {resolution_m: 0.1}}"},
      {"BeamFilter", "filter.state", write_filter, "store: {file: %}",
       "filter: {resolution_m: 0.1}"},
      {"Localizer", "place.yaml", write_place, "start: {store: {file: %}}", ""},
      {"TimescaleMemory", "memory.db", write_memory, "store: %", "timescale: {max_range_m: 6.0}"},
      {"TopologyMapper", "way.db", write_way, "store: {file: %}", ""},
      {"VolumeMapper", "map.ot", write_volume, "store: %", "map: {resolution_m: 0.5}"}};
  return files;
}

runtime::Registry keepers() {
  runtime::Registry registry;
  scan_matcher::register_component(registry);
  beam_filter::register_component(registry);
  localizer::register_component(registry);
  timescale_memory::register_component(registry);
  topology_mapper::register_component(registry);
  volume_mapper::register_component(registry);
  return registry;
}

}  // namespace strata::test
