// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/changes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/patch/contradiction.hpp"
#include "core/patch/jitter.hpp"
#include "core/patch/visits.hpp"

namespace strata::pipeline {
namespace {

using localization::RayCaster;

constexpr std::size_t kLeastChangedCells = 4;
/// An old state: this share of the changed cells that an earlier visit knows were as they are now.
constexpr double kSameState = 0.8;

enum class CellState : std::uint8_t { kUnknown, kFree, kOccupied };

CellState state_of(double hits, double misses, const patch::ContradictionConfig& config) {
  const double total = hits + misses;
  if (total < config.few_min_beams) return CellState::kUnknown;
  if (hits >= 0.5 * total) return CellState::kOccupied;
  return hits <= config.few_free_share * total ? CellState::kFree : CellState::kUnknown;
}

/// One stay of the robot near a place, and what it saw of each cell.
struct PlaceVisit {
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;
  std::vector<CellState> cells;
};

/// Visits of single cells that share time are one visit of the place. O(v log v + v cells).
std::vector<PlaceVisit> visits_of_place(const std::vector<Cell>& cells,
                                        const patch::VisitTable& table,
                                        const patch::ContradictionConfig& config) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> spans;
  for (const Cell& cell : cells) {
    for (const patch::Visit& visit : table.at(cell)) {
      spans.emplace_back(visit.first_scan, visit.last_scan);
    }
  }
  std::sort(spans.begin(), spans.end());
  std::vector<PlaceVisit> visits;
  for (const auto& [first, last] : spans) {
    if (visits.empty() || first > visits.back().last_scan) {
      visits.push_back({first, last, std::vector<CellState>(cells.size())});
    }
    visits.back().last_scan = std::max<std::size_t>(visits.back().last_scan, last);
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    auto visit = visits.begin();
    double hits = 0.0;
    double misses = 0.0;
    for (const patch::Visit& seen : table.at(cells[c])) {
      while (seen.first_scan > visit->last_scan) {
        ++visit;
        hits = misses = 0.0;
      }
      hits += static_cast<double>(seen.hits);
      misses += static_cast<double>(seen.misses);
      visit->cells[c] = state_of(hits, misses, config);
    }
  }
  return visits;
}

/// A change of a place before anyone looked at beams.
struct Candidate {
  std::size_t first_scan = 0;
  std::size_t last_scan = 0;
  bool is_tested = false;  ///< begins in the test part
  bool is_old_state = false;
  std::vector<std::pair<Cell, CellState>> cells;
};

/// `earlier` visits, the last one excluded: did one of them find these cells like this?
bool was_seen_before(std::span<const PlaceVisit> earlier, const std::vector<CellState>& now,
                     const std::vector<std::size_t>& changed) {
  return std::any_of(earlier.begin(), earlier.end(), [&](const PlaceVisit& visit) {
    std::size_t known = 0;
    std::size_t same = 0;
    for (const std::size_t c : changed) {
      if (visit.cells[c] == CellState::kUnknown) continue;
      ++known;
      same += visit.cells[c] == now[c] ? 1 : 0;
    }
    return 2 * known >= changed.size() &&
           static_cast<double>(same) >= kSameState * static_cast<double>(known);
  });
}

void append_changes(const std::vector<Cell>& cells, const std::vector<PlaceVisit>& visits,
                    std::size_t learned_scans, std::vector<Candidate>& candidates) {
  std::vector<CellState> last(cells.size(), CellState::kUnknown);
  for (std::size_t v = 0; v < visits.size(); ++v) {
    const std::vector<CellState>& now = visits[v].cells;
    std::vector<std::size_t> changed;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (now[c] == CellState::kUnknown) continue;
      if (last[c] != CellState::kUnknown && last[c] != now[c]) changed.push_back(c);
    }
    Candidate candidate;
    candidate.first_scan = visits[v].first_scan;
    candidate.last_scan = visits[v].last_scan;
    candidate.is_tested =
        visits[v].first_scan >= learned_scans && changed.size() >= kLeastChangedCells;
    if (candidate.is_tested) {
      candidate.is_old_state = was_seen_before(std::span(visits).first(v), now, changed);
    }
    // What was learned is pasted too, cell by cell, so that the map before the first event is that
    // of the last look at each place.
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const bool is_news = last[c] == CellState::kUnknown && now[c] != CellState::kUnknown;
      const bool is_change = std::find(changed.begin(), changed.end(), c) != changed.end();
      if (is_change || (is_news && !candidate.is_tested)) {
        candidate.cells.emplace_back(cells[c], now[c]);
      }
      if (now[c] != CellState::kUnknown) last[c] = now[c];
    }
    if (!candidate.cells.empty()) candidates.push_back(std::move(candidate));
  }
}

std::vector<Candidate> find_candidates(const patch::VisitTable& table, Grid<std::uint8_t> mask,
                                       const patch::ContradictionConfig& config,
                                       std::size_t learned_scans) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (mask.values()[i] == 0) continue;
    const std::vector<Cell> cells = patch::take_component(mask, mask.cell(i));
    append_changes(cells, visits_of_place(cells, table, config), learned_scans, candidates);
  }
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const Candidate& a, const Candidate& b) { return a.first_scan < b.first_scan; });
  return candidates;
}

/// The last two visits of learning and the first three of the test. A state met once among many
/// visits is noise to the test for many; whether the test part differs from what was there last is
/// a question for the test for few.
patch::VisitTable visits_about_split(const patch::VisitTable& table, double resolution_m,
                                     std::size_t learned_scans) {
  Grid<std::int32_t> slots(resolution_m, table.rect(), -1);
  std::vector<std::uint32_t> offsets{0};
  std::vector<patch::Visit> kept;
  for (const Cell& cell : table.cells()) {
    const auto visits = table.at(cell);
    const auto split = std::find_if(visits.begin(), visits.end(), [&](const patch::Visit& visit) {
      return visit.first_scan >= learned_scans;
    });
    const auto first = split - std::min<std::ptrdiff_t>(2, split - visits.begin());
    const auto last = split + std::min<std::ptrdiff_t>(3, visits.end() - split);
    slots.at(cell) = static_cast<std::int32_t>(offsets.size() - 1);
    kept.insert(kept.end(), first, last);
    offsets.push_back(static_cast<std::uint32_t>(kept.size()));
  }
  return {std::move(slots), std::move(offsets), std::move(kept)};
}

/// Cells whose visits contradict each other, over all time or about the split.
Grid<std::uint8_t> find_places(const patch::VisitTable& table, double resolution_m,
                               std::size_t learned_scans,
                               const patch::ContradictionConfig& config) {
  Grid<std::uint8_t> places = patch::find_contradictions(table, config);
  const Grid<std::uint8_t> lately =
      patch::find_contradictions(visits_about_split(table, resolution_m, learned_scans), config);
  for (std::size_t i = 0; i < lately.size(); ++i) {
    if (lately.values()[i] != 0) places.at(lately.cell(i)) = 1;
  }
  return places;
}

double limit_of(const Scan& scan, double r_max_m) {
  const auto own_m = static_cast<double>(scan.range_max_m);
  const bool has_own = std::isfinite(own_m) && own_m > 0.0;
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

  [[nodiscard]] std::vector<std::uint32_t> telling_beams(std::size_t scan, const RayCaster& before,
                                                         const RayCaster& after) const {
    return select(scan, [&](const Pose2& laser, double bearing_rad, double z_m, double limit_m) {
      const double after_m = std::min(after.expected_range_m(laser, bearing_rad), limit_m);
      if (std::abs(after_m - z_m) > kBinTolerance_m) return false;
      const double before_m = std::min(before.expected_range_m(laser, bearing_rad), limit_m);
      return std::abs(before_m - after_m) > kBinTolerance_m;
    });
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

void paste(const Candidate& candidate, ReflectionGrid& map) {
  for (const auto& [cell, state] : candidate.cells) {
    if (map.contains(cell)) map.at(cell) = state == CellState::kOccupied ? 1.0F : 0.0F;
  }
}

ChangeEvent make_event(const Candidate& candidate, double resolution_m) {
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
std::vector<ChangeEvent> make_events(const std::vector<Candidate>& candidates, ReflectionGrid map,
                                     const Viewer& viewer,
                                     const std::vector<std::size_t>& test_scan_of) {
  std::vector<ChangeEvent> events;
  auto before = std::shared_ptr<const RayCaster>();
  for (const Candidate& candidate : candidates) {
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
      ChangeView view{scan, viewer.telling_beams(scan, *before, *event.oracle)};
      if (view.beams.size() >= kLeastChangedBeams) event.views.push_back(std::move(view));
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
  return scan < place_beams.size() && place_beams[scan].size() >= kLeastChangedBeams;
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
  patch::VisitTable table =
      patch::find_visits(all, base.resolution_m(), config.visits, config.counting);
  table.filter(config.contradiction.prior);
  changes.places = find_places(table, base.resolution_m(), learned.size(), config.contradiction);
  const std::vector<Candidate> candidates =
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
