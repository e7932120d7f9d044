// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/replay_truth.hpp"

#include <chrono>
#include <fstream>
#include <utility>

#include <nlohmann/json.hpp>

#include "components/convert/geometry_messages.hpp"
#include "components/log/whole_file.hpp"
#include "components/maps/localization_files.hpp"
#include "components/runtime/host.hpp"
#include "core/base/error.hpp"
#include "tools/pipeline/localize_output.hpp"
#include "tools/strata/particle_clouds.hpp"

namespace strata::tools {
namespace {

constexpr auto kLongestWait = std::chrono::seconds(20);

std::string text_parameter(const runtime::ComponentEntry& entry, const char* key,
                           const std::string& otherwise) {
  const YAML::Node& parameters = entry.parameters;
  return parameters[key].IsDefined() ? parameters[key].as<std::string>() : otherwise;
}

}  // namespace

ReplayTruth::ReplayTruth(const std::shared_ptr<bus::Participant>& participant,
                         const runtime::Composition& composition,
                         const runtime::ComponentEntry& entry, const pipeline::Runs& runs)
    : name_(bus::expand_name(entry.name, entry.node_namespace, entry.name)),
      entry_(entry),
      folder_(runtime::out_folder_of(entry, composition) /
              text_parameter(entry, "out_subfolder", "")) {
  for (std::size_t i = 0; i < runs.observations.size(); ++i) {
    if (runs.truths[i]) truth_[runs.observations[i].scan.stamp] = *runs.truths[i];
  }
  const std::string topic =
      bus::resolve_name(text_parameter(entry, "particles_topic", "particle_cloud"),
                        entry.node_namespace, entry.name, entry.remappings);
  reader_ = std::make_unique<bus::Reader<nav2_msgs::msg::ParticleCloud>>(
      participant, topic, bus::qos_profile("default").lossless(),
      [this](const nav2_msgs::msg::ParticleCloud& cloud) { judge(cloud); });
}

std::filesystem::path ReplayTruth::maps() const { return text_parameter(entry_, "maps", ""); }

void ReplayTruth::set_map_from_truth(const std::optional<Pose2>& map_from_truth) {
  const std::lock_guard lock(mutex_);
  map_from_truth_ = map_from_truth;
}

bool ReplayTruth::wait_until_heard() const {
  return reader_->raw().wait_for_writers(1, kLongestWait);
}

void ReplayTruth::judge(const nav2_msgs::msg::ParticleCloud& cloud) {
  const std::lock_guard lock(mutex_);
  ++clouds_;
  changed_.notify_all();
  const auto found = truth_.find(convert::from_message(cloud.header().stamp()));
  if (found == truth_.end()) return;
  const Pose2 truth = map_from_truth_ ? *map_from_truth_ * found->second : found->second;
  errors_.push_back(error_of(cloud, truth));
}

void ReplayTruth::write(const std::filesystem::path& out) {
  const std::filesystem::path path = out / folder_ / maps::kMetricsFile;
  std::ifstream in(path);
  if (!in) return;  // it never localized
  nlohmann::json metrics = nlohmann::json::parse(in);
  in.close();
  std::unique_lock lock(mutex_);
  // The last clouds may still be under way from another process.
  const auto scans = metrics["scans"].get<std::size_t>();
  if (!changed_.wait_for(lock, kLongestWait, [&] { return clouds_ >= scans; })) {
    throw Error(name_, "did not publish a particle cloud for every scan",
                "see whether its particles_topic is remapped to another type");
  }
  pipeline::add_errors(metrics, errors_, map_from_truth_);
  log::WholeFile file(path);
  file.stream() << metrics.dump(2) << '\n';
  file.commit();
}

}  // namespace strata::tools
