// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/wean_doors.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>

#include "core/patch/contradiction.hpp"
#include "core/patch/jitter.hpp"

namespace strata::experiments {
namespace {

constexpr double kAtDoor_m = 0.5;
constexpr double kAroundDoor_m = 0.6;
constexpr double kMinDifferent = 0.8;

constexpr DoorState kUnseen = DoorState::kUnseen;
constexpr DoorState kOpen = DoorState::kOpen;
constexpr DoorState kClosed = DoorState::kClosed;

/// The cells at the door that changed.
std::vector<Cell> cells_at(const patch::Submap& submap, const WeanDoor& door) {
  std::vector<Cell> cells;
  const Grid<std::uint8_t>& mask = submap.contradictory;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    const Cell cell = mask.cell(i);
    if (mask.values()[i] != 0 && (mask.center(cell) - door.middle_m).norm() < kAtDoor_m) {
      cells.push_back(cell);
    }
  }
  return cells;
}

/// Whether a configuration holds a surface in the 3 x 3 block of a cell.
bool is_occupied_near(const ReflectionGrid& grid, const Cell& cell) {
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const float m = grid.get({cell.x + dx, cell.y + dy});
      if (is_known(m) && is_occupied(m)) return true;
    }
  }
  return false;
}

/// What the sequences of a run mostly chose; nothing where it has none.
std::optional<std::size_t> configuration_of(const patch::Submap& submap, int run) {
  std::vector<double> sum(submap.configurations.size(), 0.0);
  bool has_any = false;
  for (const patch::SequenceInfo& sequence : submap.sequences) {
    if (sequence.run != run) continue;
    has_any = true;
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += sequence.membership[k];
  }
  if (!has_any) return std::nullopt;
  return static_cast<std::size_t>(
      std::distance(sum.begin(), std::max_element(sum.begin(), sum.end())));
}

}  // namespace

bool WeanDoor::differs(int run_a, int run_b) const {
  const DoorState a = in_run.at(static_cast<std::size_t>(run_a));
  const DoorState b = in_run.at(static_cast<std::size_t>(run_b));
  return a != kUnseen && b != kUnseen && a != b;
}

std::span<const WeanDoor> wean_doors() {
  static const std::vector<WeanDoor> doors{
      {{27.9, 42.6}, {kClosed, kOpen, kClosed}}, {{29.5, 39.6}, {kClosed, kOpen, kOpen}},
      {{49.4, 37.8}, {kClosed, kOpen, kClosed}}, {{51.6, 37.6}, {kClosed, kOpen, kClosed}},
      {{52.5, 40.4}, {kClosed, kOpen, kClosed}}, {{19.3, 40.6}, {kUnseen, kOpen, kUnseen}},
      {{21.8, 43.2}, {kUnseen, kOpen, kUnseen}}};
  return doors;
}

bool covers(const patch::Submap& submap, const WeanDoor& door) {
  return !cells_at(submap, door).empty();
}

std::size_t cells_apart(const patch::VisitTable& visits, std::span<const PosedScan> scans,
                        const WeanDoor& door, int run_a, int run_b) {
  const patch::ContradictionConfig config;
  const std::vector<Cell> around = patch::disc_offsets(config.tolerance_m, visits.resolution_m());
  std::size_t apart = 0;
  for (const Cell& cell : visits.cells()) {
    if ((cell_center(cell, visits.resolution_m()) - door.middle_m).norm() > kAroundDoor_m) continue;
    std::array<bool, 2> was_hit{};
    std::array<bool, 2> was_free{};
    for (const patch::Visit& visit : visits.at(cell)) {
      const int run = scans[visit.first_scan].run;
      if ((run != run_a && run != run_b) || visit.total() < config.few_min_beams) continue;
      const std::size_t which = run == run_a ? 0 : 1;
      const double share = static_cast<double>(visit.hits) / visit.total();
      if (share >= config.few_occupied_share) was_hit[which] = true;
      if (share <= config.few_free_share &&
          !patch::was_hit_nearby(visits, cell, visit, around, config.few_free_share)) {
        was_free[which] = true;
      }
    }
    if ((was_hit[0] && was_free[1]) || (was_hit[1] && was_free[0])) ++apart;
  }
  return apart;
}

bool has_both_states(const patch::Submap& submap, const WeanDoor& door, int run_a, int run_b) {
  const std::vector<Cell> cells = cells_at(submap, door);
  const auto a = configuration_of(submap, run_a);
  const auto b = configuration_of(submap, run_b);
  if (cells.empty() || !a || !b || *a == *b) return false;
  const auto differ = std::count_if(cells.begin(), cells.end(), [&](const Cell& cell) {
    return is_occupied_near(submap.configurations[*a].reflection, cell) !=
           is_occupied_near(submap.configurations[*b].reflection, cell);
  });
  return static_cast<double>(differ) > kMinDifferent * static_cast<double>(cells.size());
}

}  // namespace strata::experiments
