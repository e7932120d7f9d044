// SPDX-License-Identifier: Apache-2.0
#include <strata/beam_filter/beam_filter.hpp>
#include <strata/registration/scan_matcher.hpp>
#include <strata/store/store.hpp>

int main() {
  strata::WorkerPool pool(2);
  std::vector<strata::PosedScan> scans(1);
  scans[0].scan.range_max_m = 10.0F;
  scans[0].scan.ranges_m = {1.0F, 1.0F};
  const auto result = strata::beam_filter::filter_at_fixed_poses(scans, {}, pool);
  return result.filtered.get({20, 0}) == 1.0F ? 0 : 1;
}
