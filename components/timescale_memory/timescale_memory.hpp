// SPDX-License-Identifier: Apache-2.0
/// strata::TimescaleMemory: posed scans in; what each level expects around each node out.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/text_message.hpp"
#include "components/runtime/component.hpp"
#include "components/runtime/pose_watch.hpp"
#include "components/timescale_memory/config.hpp"
#include "components/timescale_memory/memory_file.hpp"
#include "core/base/damage.hpp"
#include "core/grid/frame_watch.hpp"
#include "core/grid/grid.hpp"
#include "memory/nodes/stored_places.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::timescale_memory {

/// In: mapped_scan (lockstep) or labeled_scan (live). Out: node_map; expected_scan/LEVEL, what a
/// scan from the robot's pose would look like if the level were right; changed_places, where two
/// levels differ, as JSON; at the end of a log the
/// memory in MAPS. Live, with a store: the memory survives the process. Several robots may feed it,
/// each from its namespace's labeled_scan; every scan that arrives is offered to the memory.
class TimescaleMemory final : public runtime::Component {
 public:
  using Component::Component;

 private:
  struct FrameCheck {
    explicit FrameCheck(memory::StoredPlaces stored) : places(std::move(stored)) {}
    memory::StoredPlaces places;
    FrameWatch watch;
    std::chrono::steady_clock::time_point since = std::chrono::steady_clock::now();
  };
  void on_declare() override { declare_parameters<TimescaleMemoryConfig>(); }
  void on_configure() override;
  void on_cleanup() override;
  void on_deactivate() override;
  void on_tick() override;
  [[nodiscard]] bool learns() const override { return true; }
  void on_finish(const std::filesystem::path& out_dir) override;
  void on_diagnose(runtime::Health& health) const override;
  void open_store();
  /// Whether the store is of the frame that scans come in.
  void check_frame(const PosedScan& scan);
  /// Sets the store aside, which is not.
  void begin_anew();
  [[nodiscard]] bool may_save() const;
  void on_scan(const strata_msgs::msg::LabeledScan& message, int robot = 0);
  [[nodiscard]] bool is_time_to_publish(Stamp stamp);
  /// A node that was found to be damaged: counted, and told of.
  void pass_over(const DamageError& error);
  /// max_read: nodes that may be read from the store for it.
  void publish_map(Stamp stamp, std::size_t max_read);
  void publish_changes(Stamp stamp);
  void publish_expected(const PosedScan& scan, const std::string& frame);

  static constexpr double kZoneCell_m = 0.05;  // the memory has no cells of its own

  TimescaleMemoryConfig config_;
  std::optional<memory::TimescaleMemory> memory_;
  std::optional<MemoryFile> file_;
  std::map<int, runtime::PoseWatch> poses_;                       // by robot
  Grid<std::uint8_t> never_learned_{kZoneCell_m, CellRect{}, 0};  // cells with 1
  std::shared_ptr<const memory::NodeMap> decoded_;
  std::optional<FrameCheck> frame_;  ///< while it is open, with what a store held
  std::uint64_t damaged_nodes_ = 0;  ///< passed over
  std::optional<Stamp> last_published_;
  std::optional<Stamp> last_changes_;
  std::function<void(const std_msgs::msg::String&)> publish_changes_;
  std::chrono::steady_clock::time_point rest_until_;
  std::function<void(const strata_msgs::msg::NodeMap&)> publish_map_;
  std::vector<std::function<void(const sensor_msgs::msg::LaserScan&)>> publish_level_;
};

}  // namespace strata::timescale_memory
