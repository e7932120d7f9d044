// SPDX-License-Identifier: Apache-2.0
/// Writes the MAPS folder of a robot that goes on mapping meanwhile.
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "strata_idl/strata_msgs.h"

#include "components/log/newest_work.hpp"
#include "components/log/state_store.hpp"
#include "components/maps/maps_folder.hpp"
#include "core/patch/patch_learner_config.hpp"
#include "core/patch/patch_map.hpp"
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

/// As of the Slam that snapshots come from, and of who learns the patches.
struct SaverConfig {
  slam::SlamConfig slam;
  slam::KeepConfig keep;
  patch::PatchLearnerConfig patch;
};

/// That saving would replace nothing but maps of a live mapper, or nothing at all. Somebody may
/// have put maps there since the mapper began. Throws OutputError.
void require_replaceable(const std::filesystem::path& folder);

/// What is known at one moment.
struct Snapshot {
  log::Bytes slam;                                    ///< slam::Slam::save_state
  std::optional<strata_msgs::msg::PatchMap> patches;  ///< as learned until then
};

/// Does with a copy what the end of a log does (slam::Slam::finish), on a thread of its own; the
/// folder is replaced as a whole, so that it always holds one complete set of maps. The maps are
/// those of the scans that are still kept. Patches, where some are known, are learned again at the
/// poses that this finds (patch::learn_again), as long as the mapper has forgotten no scan; then
/// they are those that came. Takes the memory of a second Slam meanwhile. One thread at a time may
/// call it.
class MapsSaver {
 public:
  /// error: empty when the folder was written.
  using Done = std::function<void(const std::string& error)>;

  /// Mends what a killed one left beside the folder.
  /// Throws OutputError when the folder holds something else than maps that a mapper saved there.
  MapsSaver(const std::filesystem::path& folder, SaverConfig config);
  /// Gives up what it writes.
  ~MapsSaver();
  MapsSaver(const MapsSaver&) = delete;
  MapsSaver& operator=(const MapsSaver&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// Whether maps of an earlier one are there.
  [[nodiscard]] bool has_maps() const;
  /// Returns at once; `done` is called on the saver's thread. What waits to be written gives way to
  /// something newer, and is done when that is.
  void save(Snapshot snapshot, Done done);
  /// Whether something is written or waits.
  [[nodiscard]] bool is_busy() const { return work_.is_busy(); }
  /// How long the last one took; 0 before the first.
  [[nodiscard]] double last_s() const { return last_s_; }
  /// Sub-maps of the last one that stand where the live mapper had their scans.
  [[nodiscard]] std::size_t live_submaps() const { return live_submaps_; }
  /// Throws OutputError when maps could not be written: once.
  void check();
  /// Waits until everything is written; throws as check.
  void flush();

 private:
  class UntilItEnds;
  struct Job {
    Snapshot snapshot;
    std::vector<Done> done;
  };
  void work_on(const Job& job);
  void write(const Snapshot& snapshot);
  [[nodiscard]] patch::PatchMap learned_again(const patch::PatchMap& known,
                                              const slam::SlamResult& result, Progress& progress);

  std::filesystem::path folder_;
  SaverConfig config_;
  std::mutex mutex_;
  std::string error_;  // under mutex_: of the last one
  std::atomic<bool> ends_ = false;
  std::atomic<double> last_s_ = 0.0;
  std::atomic<std::size_t> live_submaps_ = 0;
  log::NewestWork<Job> work_;  // last: it uses the others
};

}  // namespace strata::scan_matcher
