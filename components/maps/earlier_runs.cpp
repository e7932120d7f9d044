// SPDX-License-Identifier: Apache-2.0
#include "components/maps/earlier_runs.hpp"

#include <algorithm>
#include <fstream>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "components/maps/maps_folder.hpp"
#include "core/base/error.hpp"
#include "memory/store/store.hpp"

namespace strata::maps {

std::string log_of(const std::filesystem::path& dir) {
  std::ifstream in(dir / kSummaryFile);
  const nlohmann::json json = nlohmann::json::parse(in, nullptr, false);
  return json.is_object() && json.contains("log") && json["log"].is_string()
             ? json["log"].get<std::string>()
             : std::string();
}

EarlierRuns read_earlier_runs(const std::filesystem::path& dir) {
  const memory::Store store = open_for_reading(dir);
  EarlierRuns earlier;
  earlier.log = log_of(dir);
  earlier.map_from_truth = read_map_from_truth(store);
  if (store.has_timescale()) {
    earlier.timescale = std::make_shared<memory::TimescaleMemory>(store.load_timescale());
  }
  for (const int run : store.runs_with_scans()) {
    std::vector<PosedScan> scans = store.load_scans(run);
    earlier.scans.insert(earlier.scans.end(), std::make_move_iterator(scans.begin()),
                         std::make_move_iterator(scans.end()));
    earlier.next_run = run + 1;
  }
  earlier.thinned = read_thinned_runs(store);
  for (const ThinnedRun& run : earlier.thinned) {
    earlier.next_run = std::max(earlier.next_run, run.run + 1);  // the last may have no scan left
  }
  if (earlier.scans.empty()) {
    throw InputError((dir / kStoreFile).string(), "holds no scans to go on from",
                     "learn its logs again with this version, or learn them together with the new "
                     "ones");
  }
  return earlier;
}

void add_run(EarlierRuns& earlier, std::vector<PosedScan> scans) {
  const int last = earlier.scans.empty() ? -1 : earlier.scans.back().run;
  const int run = std::max(earlier.next_run, last + 1);
  for (PosedScan& scan : scans) {
    scan.run = run;
    earlier.scans.push_back(std::move(scan));
  }
}

std::size_t forget_scans(EarlierRuns& earlier, const HistoryConfig& config) {
  const std::vector<bool> keeps = scans_to_keep(earlier.scans, earlier.next_run, config);
  const auto forgotten = static_cast<std::size_t>(std::count(keeps.begin(), keeps.end(), false));
  if (forgotten == 0) return 0;
  const auto ends_of = [&](std::size_t begin) {
    std::size_t end = begin;
    while (end < keeps.size() && earlier.scans[end].run == earlier.scans[begin].run) ++end;
    return end;
  };
  for (std::size_t begin = 0; begin < keeps.size(); begin = ends_of(begin)) {
    const std::size_t end = ends_of(begin);
    const std::span<const PosedScan> run(earlier.scans.data() + begin, end - begin);
    const bool loses = std::find(keeps.begin() + static_cast<std::ptrdiff_t>(begin),
                                 keeps.begin() + static_cast<std::ptrdiff_t>(end),
                                 false) != keeps.begin() + static_cast<std::ptrdiff_t>(end);
    if (loses && thinned_run(earlier.thinned, run.front().run) == nullptr) {
      earlier.thinned.push_back({run.front().run, visit_hash(run), run.front().scan.stamp.ns});
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keeps.size(); ++i) {
    if (!keeps[i]) continue;
    if (kept != i) earlier.scans[kept] = std::move(earlier.scans[i]);
    ++kept;
  }
  earlier.scans.resize(kept);
  return forgotten;
}

std::vector<std::vector<PosedScan>> new_runs(EarlierRuns other, const EarlierRuns& earlier) {
  const auto name = [](const PosedScan& scan) {
    const Pose2& pose = scan.map_from_robot;
    return std::tuple(scan.scan.stamp, pose.x, pose.y, pose.theta);
  };
  std::set<decltype(name(earlier.scans.front()))> known;
  for (const PosedScan& scan : earlier.scans) known.insert(name(scan));
  std::set<std::string> thinned;
  for (const ThinnedRun& run : earlier.thinned) thinned.insert(run.visit);
  std::vector<std::vector<PosedScan>> runs;
  for (PosedScan& scan : other.scans) {
    if (runs.empty() || runs.back().front().run != scan.run) runs.emplace_back();
    runs.back().push_back(std::move(scan));
  }
  std::erase_if(runs, [&](const std::vector<PosedScan>& run) {
    const auto there = std::count_if(
        run.begin(), run.end(), [&](const PosedScan& scan) { return known.contains(name(scan)); });
    if (there >= 2 || static_cast<std::size_t>(there) == run.size()) return true;
    if (thinned.empty()) return false;
    const ThinnedRun* before = thinned_run(other.thinned, run.front().run);
    return thinned.contains(before != nullptr ? before->visit : visit_hash(run));
  });
  return runs;
}

}  // namespace strata::maps
