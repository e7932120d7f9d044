// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/learn_guard.hpp"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "components/maps/maps_folder.hpp"
#include "components/site/map_version.hpp"
#include "core/base/error.hpp"
#include "memory/store/store_summary.hpp"
#include "tools/strata/result_directory.hpp"
#include "tools/strata/warning.hpp"

namespace strata::tools {
namespace {

/// Whether half of the readings are the same to the bit; NaN is as NaN.
bool are_alike(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size() || a.empty()) return false;
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool are_both_nan = !(a[i] == a[i]) && !(b[i] == b[i]);
    same += a[i] == b[i] || are_both_nan ? 1 : 0;
  }
  return 2 * same >= a.size();
}

/// Takes out those entries.
template <class Value>
void erase_at(std::vector<Value>& list, const std::vector<bool>& gone) {
  if (list.empty()) return;
  std::size_t next = 0;
  std::erase_if(list, [&](const Value&) { return gone[next++]; });
}

}  // namespace

void require_no_lost_parts(const std::string& out, const pipeline::LearnParts& parts) {
  if (runs_in(out) == 0) return;
  const memory::StoreSummary there =
      memory::summarize_store(std::filesystem::path(out) / maps::kStoreFile);
  const auto require = [&](bool is_there, bool is_learned, const char* what, const char* part) {
    if (!is_there || is_learned) return;
    throw OutputError(
        out, std::string("has a ") + what + ", which --only without " + part + " would take away",
        "leave --only out, choose another --out, or give --force to lose it");
  };
  require(!there.timescales.empty(), parts.timescale, "timescale memory", "timescale");
  require(!there.patch_maps.empty(), parts.patch, "patch map", "patch");
}

void require_no_lost_runs(const std::string& out, const std::string& update,
                          const maps::EarlierRuns& base, const std::vector<Observation>& seen) {
  if (runs_in(out) == 0) return;
  std::optional<maps::EarlierRuns> there;
  try {
    there = maps::read_earlier_runs(out);
  } catch (const InputError&) {
    return;  // nothing that could be gone on from
  }
  std::set<Stamp> learned;
  for (const Observation& one : seen) learned.insert(one.scan.stamp);
  for (const std::vector<PosedScan>& run : maps::new_runs(std::move(*there), base)) {
    const Stamp begin = run.front().scan.stamp;
    if (learned.contains(begin) && learned.contains(run.back().scan.stamp)) continue;
    throw OutputError(out,
                      "holds run " + std::to_string(run.front().run) + ", which began at " +
                          site::utc_text(begin.ns) + " and which neither " + update +
                          " nor these logs have",
                      "choose another --out, go on from it with --update " + out +
                          ", or give --force to lose it");
  }
}

std::optional<int> repeated_run(std::span<const RunScan> earlier,
                                std::span<const Observation> run) {
  std::multimap<Stamp, const Scan*> known;
  for (const Observation& one : run) known.emplace(one.scan.stamp, &one.scan);
  std::map<int, std::pair<std::size_t, std::size_t>> of_run;  // its scans that are there, all
  for (const RunScan& before : earlier) {
    auto& [there, all] = of_run[before.run];
    ++all;
    const auto [begin, end] = known.equal_range(before.scan->stamp);
    const bool is_there = std::any_of(begin, end, [&](const auto& one) {
      return are_alike(one.second->ranges_m, before.scan->ranges_m);
    });
    there += is_there ? 1 : 0;
  }
  for (const auto& [id, counts] : of_run) {
    if (2 * counts.first >= std::min(counts.second, run.size())) return id;
  }
  return std::nullopt;
}

std::vector<std::string> leave_out_repeated(pipeline::Runs& runs,
                                            const std::vector<std::string>& logs, int first_run,
                                            const maps::EarlierRuns& earlier,
                                            VerbContext& context) {
  std::vector<RunScan> before;
  for (const PosedScan& posed : earlier.scans) before.push_back({posed.run, &posed.scan});
  std::vector<std::string> stay;
  std::vector<bool> gone(runs.observations.size(), false);
  std::size_t begin = 0;
  for (std::size_t log = 0; log < logs.size(); ++log) {
    std::size_t end = begin;
    const int id = first_run + static_cast<int>(log);
    while (end < runs.observations.size() && runs.observations[end].run == id) ++end;
    const std::span<const Observation> run(runs.observations.data() + begin, end - begin);
    const std::optional<int> same = run.empty() ? std::nullopt : repeated_run(before, run);
    if (same) {
      warn(context, logs[log] + " is what run " + std::to_string(*same) +
                        " was learned from: it is left out, or it would count twice (--again: it "
                        "does)");
      std::fill(gone.begin() + static_cast<std::ptrdiff_t>(begin),
                gone.begin() + static_cast<std::ptrdiff_t>(end), true);
    } else {
      stay.push_back(logs[log]);
      for (const Observation& one : run) before.push_back({id, &one.scan});
    }
    begin = end;
  }
  erase_at(runs.observations, gone);
  erase_at(runs.poses, gone);
  erase_at(runs.truths, gone);
  return stay;
}

void require_a_place(const slam::SlamResult& result, const std::string& update, int first_run) {
  const bool is_placed = std::any_of(result.scans.begin(), result.scans.end(),
                                     [&](const PosedScan& scan) { return scan.run >= first_run; });
  if (is_placed || result.unplaced_runs.empty()) return;
  throw InputError(update, "has no place that fits the new logs: nothing was learned",
                   "are they of that building? give --poses, or learn them into maps of their own");
}

}  // namespace strata::tools
