// SPDX-License-Identifier: Apache-2.0
/// Writes the MAPS folder of a robot that goes on mapping meanwhile.
#pragma once

#include <atomic>
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
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

/// The name of the log in summary.json of maps that a running mapper wrote.
inline constexpr const char* kLiveLog = "live";

/// What is known at one moment.
struct Snapshot {
  log::Bytes slam;                                    ///< slam::Slam::save_state
  std::optional<strata_msgs::msg::PatchMap> patches;  ///< as learned until then
};

/// Does with a copy what the end of a log does (slam::Slam::finish), on a thread of its own; the
/// folder is replaced as a whole, so that it always holds one complete set of maps. The maps are
/// those of the scans that are still kept. Takes the memory of a second Slam meanwhile. One thread
/// at a time may call it.
class MapsSaver {
 public:
  /// error: empty when the folder was written.
  using Done = std::function<void(const std::string& error)>;

  /// keep: as of the Slam that snapshots come from. Mends what a killed one left beside the folder.
  /// Throws OutputError when the folder holds something else than maps that a mapper saved there.
  MapsSaver(const std::filesystem::path& folder, slam::SlamConfig config, slam::KeepConfig keep);
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

  std::filesystem::path folder_;
  slam::SlamConfig config_;
  slam::KeepConfig keep_;
  std::mutex mutex_;
  std::string error_;  // under mutex_: of the last one
  std::atomic<bool> ends_ = false;
  std::atomic<double> last_s_ = 0.0;
  log::NewestWork<Job> work_;  // last: it uses the others
};

}  // namespace strata::scan_matcher
