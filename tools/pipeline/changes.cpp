// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/changes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/parallel.hpp"
#include "core/patch/visits.hpp"
#include "core/scan/drop_outs.hpp"
#include "core/scan/range_limit.hpp"
#include "tools/pipeline/change_candidates.hpp"

namespace strata::pipeline {
namespace {

using rays::RayCaster;

double limit_of(const Scan& scan, double r_max_m) {
  const auto own_m = static_cast<double>(scan.range_max_m);
  const bool has_own = tells_reach(scan.range_max_m);
  if (r_max_m <= 0.0) return has_own ? own_m : 100.0;
  return has_own ? std::min(own_m, r_max_m) : r_max_m;
}

/// Metres that a beam measured, the limit where nothing returned; nothing for beams that say
/// nothing.
std::optional<double> measured_m(const Scan& scan, std::size_t beam, double limit_m) {
  switch (scan.kind(beam)) {
    case BeamKind::kHit:
      return std::min(static_cast<double>(scan.ranges_m[beam]), limit_m);
    case BeamKind::kNoReturn:
      return limit_m;
    default:
      return std::nullopt;
  }
}

/// Sees the test scans: which beams tell one map from another, and which reach marked cells.
class Viewer {
 public:
  Viewer(std::span<const Observation> tested, std::span<const std::optional<Pose2>> truths,
         double r_max_m)
      : tested_(tested), truths_(truths), r_max_m_(r_max_m) {}

  [[nodiscard]] ChangeView telling_beams(std::size_t scan, const RayCaster& before,
                                         const RayCaster& after) const {
    ChangeView view{scan, {}, {}};
    view.beams =
        select(scan, [&](const Pose2& laser, double bearing_rad, double z_m, double limit_m) {
          const double after_m = std::min(after.expected_range_m(laser, bearing_rad), limit_m);
          if (std::abs(after_m - z_m) > kBinTolerance_m) return false;
          const double before_m = std::min(before.expected_range_m(laser, bearing_rad), limit_m);
          if (std::abs(before_m - after_m) <= kBinTolerance_m) return false;
          view.before_m.push_back(static_cast<float>(before_m));
          return true;
        });
    return view;
  }
  [[nodiscard]] std::vector<std::uint32_t> reaching_beams(std::size_t scan,
                                                          const RayCaster& places) const {
    return select(scan, [&](const Pose2& laser, double bearing_rad, double z_m, double) {
      return places.expected_range_m(laser, bearing_rad) <= z_m + kBinTolerance_m;
    });
  }

 private:
  template <typename Keep>
  [[nodiscard]] std::vector<std::uint32_t> select(std::size_t scan, Keep&& keep) const {
    std::vector<std::uint32_t> beams;
    if (!truths_[scan]) return beams;
    const Scan& seen = tested_[scan].scan;
    const Pose2 laser = *truths_[scan] * seen.robot_from_laser;
    const double limit_m = limit_of(seen, r_max_m_);
    for (std::size_t beam = 0; beam < seen.size(); ++beam) {
      const std::optional<double> z_m = measured_m(seen, beam, limit_m);
      if (z_m && keep(laser, seen.bearing_rad(beam), *z_m, limit_m)) {
        beams.push_back(static_cast<std::uint32_t>(beam));
      }
    }
    return beams;
  }

  std::span<const Observation> tested_;
  std::span<const std::optional<Pose2>> truths_;
  double r_max_m_;
};

void paste(const ChangeCandidate& candidate, ReflectionGrid& map) {
  for (const auto& [cell, state] : candidate.cells) {
    if (map.contains(cell)) map.at(cell) = state == CellState::kOccupied ? 1.0F : 0.0F;
  }
}

ChangeEvent make_event(const ChangeCandidate& candidate, double resolution_m) {
  ChangeEvent event;
  event.center_m.setZero();
  event.cells = candidate.cells.size();
  event.is_old_state = candidate.is_old_state;
  const auto n = static_cast<double>(candidate.cells.size());
  for (const auto& [cell, state] : candidate.cells) {
    event.center_m += cell_center(cell, resolution_m) / n;
    event.appeared_share += state == CellState::kOccupied ? 1.0 / n : 0.0;
    event.changed.push_back(cell);
    event.occupied.push_back(state == CellState::kOccupied ? 1 : 0);
  }
  return event;
}

/// Goes through the candidates in time, keeping the map as it was last seen.
std::vector<ChangeEvent> make_events(const std::vector<ChangeCandidate>& candidates,
                                     ReflectionGrid map, const Viewer& viewer,
                                     const std::vector<std::size_t>& test_scan_of) {
  std::vector<ChangeEvent> events;
  auto before = std::shared_ptr<const RayCaster>();
  for (const ChangeCandidate& candidate : candidates) {
    if (!candidate.is_tested) {
      paste(candidate, map);
      before.reset();
      continue;
    }
    if (!before) before = std::make_shared<const RayCaster>(map);
    paste(candidate, map);
    ChangeEvent event = make_event(candidate, map.resolution_m());
    event.oracle = std::make_shared<const RayCaster>(map);
    for (std::size_t i = candidate.first_scan; i <= candidate.last_scan; ++i) {
      const std::size_t scan = test_scan_of[i];
      ChangeView view = viewer.telling_beams(scan, *before, *event.oracle);
      if (view.beams.size() >= kMinChangedBeams) event.views.push_back(std::move(view));
    }
    before = event.oracle;
    if (!event.views.empty()) events.push_back(std::move(event));
  }
  return events;
}

RayCaster caster_of_marked(const Grid<std::uint8_t>& marked) {
  ReflectionGrid map(marked.resolution_m(), marked.rect(), 0.0F);
  for (std::size_t i = 0; i < marked.size(); ++i) {
    map.values()[i] = marked.values()[i] != 0 ? 1.0F : 0.0F;
  }
  return RayCaster(map);
}

}  // namespace

bool Changes::sees_change(std::size_t scan) const {
  return scan < place_beams.size() && place_beams[scan].size() >= kMinChangedBeams;
}

Changes find_changes(std::span<const PosedScan> learned, std::span<const Observation> tested,
                     std::span<const std::optional<Pose2>> truths, const ReflectionGrid& base,
                     const patch::PatchLearnerConfig& config, double r_max_m) {
  Changes changes;
  changes.place_beams.resize(tested.size());
  std::vector<PosedScan> all(learned.begin(), learned.end());
  std::vector<std::size_t> test_scan_of(all.size(), 0);
  for (std::size_t i = 0; i < tested.size(); ++i) {
    if (!truths[i]) continue;
    all.push_back({tested[i].run, tested[i].scan, *truths[i], {}});
    test_scan_of.push_back(i);
  }
  WorkerPool pool(1);
  (void)find_drop_outs(all, config.no_return, pool);  // both parts alike
  patch::VisitTable table =
      patch::find_visits(all, base.resolution_m(), config.visits, config.counting);
  table.filter(config.contradiction.prior);
  changes.places = find_places(table, base.resolution_m(), learned.size(), config.contradiction);
  const std::vector<ChangeCandidate> candidates =
      find_candidates(table, changes.places, config.contradiction, learned.size());

  const Viewer viewer(tested, truths, r_max_m);
  const CellRect rect = base.rect().united(changes.places.rect());
  changes.events = make_events(candidates, base.cropped(rect), viewer, test_scan_of);
  const RayCaster places = caster_of_marked(changes.places);
  for (std::size_t i = 0; i < tested.size(); ++i) {
    changes.place_beams[i] = viewer.reaching_beams(i, places);
  }
  return changes;
}

}  // namespace strata::pipeline
