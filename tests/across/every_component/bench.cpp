// SPDX-License-Identifier: Apache-2.0
#include "tests/across/every_component/bench.hpp"

#include <fstream>

#include "components/log/map_file.hpp"
#include "tests/across/every_component/good_messages.hpp"
#include "tools/all_components/all_components.hpp"

namespace strata::test {
namespace {

std::filesystem::path written_map(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "room.yaml";
  if (!std::filesystem::exists(file)) log::write_map(file, room_map());
  return file;
}

}  // namespace

std::vector<std::string> component_types() {
  std::vector<std::string> types;
  const runtime::Registry registry = tools::all_components();
  for (const auto& [type, factory] : registry.factories()) types.push_back(type);
  return types;
}

std::string parameters_of(const std::string& type, const std::filesystem::path& folder) {
  if (type == "strata::MapServer") return "{map: '" + written_map(folder).string() + "'}";
  if (type == "strata::MapSaver") {
    return "{folder: '" + folder.string() + "', save_map_timeout_s: 0.0}";
  }
  if (type == "strata::Recorder") {
    return "{out: '" + (folder / "bag").string() +
           "', number_if_exists: true, topics: ['/recorded:sensor_msgs/msg/LaserScan']}";
  }
  if (type == "strata::IncidentRecorder") {
    return "{out: '" + (folder / "incidents").string() +
           "', topics: [/diagnostics], after_s: 0.1, rest_s: 0.0}";
  }
  if (type == "strata::FleetMember") {
    return "{server: 'postgresql://hall.r1@/none?host=" + folder.string() +
           "', site: hall, maps: ['" + (folder / "maps").string() + "'], retry: {first_s: 0.01}}";
  }
  if (type == "strata::Player") {
    return "{log: '" + written_log(folder).string() + "', loop: true, rate: 100.0}";
  }
  if (type == "strata::LiveView") return "{port: 0}";
  if (type == "strata::Localizer") return "{start: {pose: [0.0, 0.0, 0.0]}, model: occupancy}";
  if (type == "strata::ScanMatcher") {
    return "{maps: {folder: '" + (folder / "maps").string() + "', publish_every_s: 0.01}}";
  }
  if (type == "strata::PatchLearner") return "{online: {enabled: true, publish_every_s: 0.0}}";
  if (type == "strata::TimescaleMemory") return "{publish_period_s: 0.1}";
  return "{}";
}

Bench::Bench(const std::string& type, std::shared_ptr<bus::Participant> participant,
             const std::filesystem::path& folder, runtime::FeedMode mode) {
  runtime::ComponentContext context;
  context.participant = std::move(participant);
  context.mailbox = mailbox_;
  context.name = "one";
  context.parameters = YAML::Load(parameters_of(type, folder));
  context.common_parameters = YAML::Node(YAML::NodeType::Map);
  context.place = "test.yaml";
  context.mode = mode;
  context.use_sim_time = true;
  context.on_error = [this](const std::string& error) {
    const std::lock_guard lock(mutex_);
    errors_.push_back(error);
  };
  const runtime::Registry registry = tools::all_components();
  component_ = registry.factories().at(type)(std::move(context));
}

Bench::~Bench() {
  component_->deactivate();
  component_->shutdown();
  mailbox_->stop();
}

void Bench::tick() {
  component_->tick();
  settle();
}

std::vector<std::string> Bench::take_errors() {
  const std::lock_guard lock(mutex_);
  return std::exchange(errors_, {});
}

}  // namespace strata::test
