// SPDX-License-Identifier: Apache-2.0
/// What the localizers of a replay were off by: their particle clouds against the ground truth.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "components/bus/endpoint.hpp"
#include "components/runtime/composition.hpp"
#include "tools/pipeline/localization_metrics.hpp"
#include "tools/pipeline/runs_input.hpp"

namespace strata::tools {

/// Listens to one localizer; the error of a scan is the paper's, the weighted mean distance of all
/// particles.
class ReplayTruth {
 public:
  /// entry: a strata::Localizer of the composition.
  ReplayTruth(const std::shared_ptr<bus::Participant>& participant,
              const runtime::Composition& composition, const runtime::ComponentEntry& entry,
              const pipeline::Runs& runs);

  [[nodiscard]] const std::string& topic() const { return reader_->raw().topic(); }
  /// The MAPS folder that the localizer reads; empty when its maps come over topics.
  [[nodiscard]] std::filesystem::path maps() const;
  /// Before the first scan that is localized.
  void set_map_from_truth(const std::optional<Pose2>& map_from_truth);
  /// Waits until the localizer's clouds are heard; false when that takes longer than 20 s.
  [[nodiscard]] bool wait_until_heard() const;
  /// Adds the errors to the metrics.json that the localizer left below `out`.
  void write(const std::filesystem::path& out);

 private:
  void judge(const nav2_msgs::msg::ParticleCloud& cloud);

  std::string name_;
  runtime::ComponentEntry entry_;
  std::filesystem::path folder_;  ///< below out
  std::map<Stamp, Pose2> truth_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t clouds_ = 0;                   // under mutex_
  std::optional<Pose2> map_from_truth_;      // under mutex_
  std::vector<pipeline::ScanError> errors_;  // under mutex_
  std::unique_ptr<bus::Reader<nav2_msgs::msg::ParticleCloud>> reader_;
};

}  // namespace strata::tools
