// SPDX-License-Identifier: Apache-2.0
// What SQLite's own check does not see: bits that flipped within a value.
#include <algorithm>
#include <string>

#include "core/base/damage.hpp"
#include "memory/store/detail/blob.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {

void Store::check_contents() const {
  {
    detail::Statement grids(impl_->database, "SELECT name, data FROM grid");
    while (grids.step()) {
      (void)detail::decompress(grids.blob(1), path_.string() + ": grid " + grids.text(0));
    }
  }
  if (has_patch_map()) (void)load_patch_map();
  if (has_timescale()) (void)load_timescale();
  for (const int run : runs_with_scans()) {
    const std::vector<PosedScan> scans = load_scans(run);
    const std::vector<TrajectoryPose> poses = load_trajectory(run);
    if (poses.size() != scans.size()) continue;  // of a mapper, which keeps more poses than scans
    const bool is_same = std::equal(scans.begin(), scans.end(), poses.begin(),
                                    [](const PosedScan& scan, const TrajectoryPose& pose) {
                                      return scan.scan.stamp == pose.stamp &&
                                             scan.map_from_robot == pose.map_from_robot;
                                    });
    if (!is_same) {
      throw DamageError(path_.string() + ": trajectory of run " + std::to_string(run),
                        "is not that of its scans", "take the store from a backup");
    }
  }
}

}  // namespace strata::memory
