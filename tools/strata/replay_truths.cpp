// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/replay_truths.hpp"

#include <optional>

#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "memory/store/store.hpp"
#include "tools/pipeline/truth_frame.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

/// Where the truth lies in maps that this replay learned.
std::optional<Pose2> learned_frame(const fs::path& maps_folder, const pipeline::Runs& runs) {
  std::vector<pipeline::LearnedPose> poses;
  const memory::Store store(maps_folder / maps::kStoreFile, {.read_only = true, .check = false});
  for (const int run : store.runs()) {
    for (const memory::TrajectoryPose& pose : store.load_trajectory(run)) {
      poses.push_back({run, pose.stamp, pose.map_from_robot});
    }
  }
  return pipeline::map_from_truth(runs, poses);
}

}  // namespace

std::vector<fs::path> folders_with(const fs::path& out, const char* file) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    if (entry.path().filename() == file) folders.push_back(entry.path().parent_path());
  }
  return folders;
}

ReplayTruths::ReplayTruths(bool is_given, const pipeline::Runs& runs, ReplaySession& session)
    : runs_(runs), is_given_(is_given) {
  if (!is_given_) return;
  for (const auto& process : session.composition().processes) {
    for (const auto& entry : process.components) {
      if (entry.type != "strata::Localizer") continue;
      localizers_.push_back(
          std::make_unique<ReplayTruth>(session.participant(), session.composition(), entry, runs));
    }
  }
  for (const auto& localizer : localizers_) {
    if (localizer->maps().empty()) continue;
    localizer->set_map_from_truth(maps::read_maps(localizer->maps()).map_from_truth);
  }
}

void ReplayTruths::wait_until_heard() const {
  for (const auto& localizer : localizers_) {
    if (localizer->wait_until_heard()) continue;
    throw Error("--truth", "the localizer's particle clouds are not heard",
                "check its particles_topic");
  }
}

void ReplayTruths::align(const fs::path& out) {
  if (!is_given_) return;
  for (const fs::path& folder : folders_with(out, maps::kStoreFile)) {
    const auto frame = learned_frame(folder, runs_);
    if (!frame) continue;
    maps::write_map_from_truth(folder, *frame);
    for (const auto& localizer : localizers_) {
      if (localizer->maps().empty()) localizer->set_map_from_truth(frame);
    }
  }
}

void ReplayTruths::write(const fs::path& out) {
  for (const auto& localizer : localizers_) localizer->write(out);
}

}  // namespace strata::tools
