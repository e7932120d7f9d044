// SPDX-License-Identifier: Apache-2.0
#include "core/patch_beams/patch_ray_caster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "core/base/error.hpp"

namespace strata::patch_beams {
namespace {

std::uint64_t occupied_mask(const patch::PatchMap& map, std::size_t s, const Cell& cell) {
  std::uint64_t mask = 0;
  for (std::size_t k = 0; k < map.submaps[s].configurations.size(); ++k) {
    if (is_occupied(patch::reflection_at(map, s, k, cell))) mask |= std::uint64_t{1} << k;
  }
  return mask;
}

/// Cells of a rectangle as a box, a rounding larger: whether a point on the edge of a cell is in it
/// is for the walker to say.
rays::RayBox box_of(const CellRect& rect, double resolution_m) {
  constexpr double kSpareCells = 1e-10;
  return {(rect.min.x - kSpareCells) * resolution_m, (rect.min.y - kSpareCells) * resolution_m,
          (rect.max.x + kSpareCells) * resolution_m, (rect.max.y + kSpareCells) * resolution_m};
}

/// 1 for cells that the base map or any configuration knows.
Grid<std::uint8_t> known_cells(const patch::PatchMap& map, const CellRect& rect) {
  Grid<std::uint8_t> known(map.base.resolution_m(), rect);
  const auto add = [&](const ReflectionGrid& from) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Cell cell = from.cell(i);
      if (is_known(from.values()[i]) && known.contains(cell)) known.at(cell) = 1;
    }
  };
  add(map.base);
  for (const patch::Submap& submap : map.submaps) {
    for (const patch::Configuration& configuration : submap.configurations) {
      add(configuration.reflection);
    }
  }
  return known;
}

}  // namespace

PatchRayCaster::PatchRayCaster(const patch::PatchMap& map) {
  CellRect rect = map.base.rect();
  for (const patch::Submap& submap : map.submaps) {
    rect = rect.united(submap.rect);
    const std::size_t count = submap.configurations.size();
    all_.push_back(count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1);
    for (const patch::Configuration& configuration : submap.configurations) {
      if (configuration.reflection.resolution_m() != map.base.resolution_m()) {
        throw InputError("sub-map " + std::to_string(submap.id),
                         "has another resolution than the base map", "learn the maps together");
      }
    }
  }
  Grid<std::uint8_t> fixed(map.base.resolution_m(), rect);
  const Grid<std::int32_t> marks = mark_cells(map, rect, fixed);
  static_ = rays::RayWalker(fixed);
  known_ = known_cells(map, rect);
  std::vector<CellRect> changing(map.submaps.size());
  std::vector<std::set<std::int32_t>> marks_in(map.submaps.size());
  CellRect whole;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks.values()[i] == 0) continue;
    const Cell cell = marks.cell(i);
    const CellRect one{cell, {cell.x + 1, cell.y + 1}};
    // One of those in which it is an obstacle, so that no box reaches from one to the next.
    std::size_t n = begins_[static_cast<std::size_t>(marks.values()[i])];
    while (owners_[n].mask == 0) ++n;
    CellRect& of = changing[static_cast<std::size_t>(owners_[n].submap)];
    of = of.united(one);
    whole = whole.united(one);
    marks_in[static_cast<std::size_t>(owners_[n].submap)].insert(marks.values()[i]);
  }
  for (std::size_t s = 0; s < changing.size(); ++s) {
    if (changing[s].empty()) continue;
    rays::RayBox box = box_of(changing[s], map.base.resolution_m());
    box.number = boxes_.size();
    boxes_.push_back(box);
    contents_.push_back(contents_of(marks_in[s]));
    for (BoxContent& content : contents_.back()) {
      const CellRect seen = seen_by(content.current, changing[s], marks);
      content.box = box_of(seen, map.base.resolution_m());
      content.box.number = box.number;
      find_uniform(seen.inflated(1), marks, content);
    }
  }
  // With a margin, so that every ray steps into a marked cell from one that is not.
  Grid<std::int32_t> near(map.base.resolution_m(), whole.inflated(2));
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Cell cell = near.cell(i);
    if (marks.contains(cell)) near.values()[i] = marks.at(cell);
  }
  changing_ = rays::RayWalker(near);
}

/// The part of a rectangle where cells are an obstacle in some configurations for particles in
/// `current`.
CellRect PatchRayCaster::seen_by(int current, const CellRect& rect,
                                 const Grid<std::int32_t>& marks) const {
  CellRect seen;
  for (int y = rect.min.y; y < rect.max.y; ++y) {
    for (int x = rect.min.x; x < rect.max.x; ++x) {
      const std::int32_t mark = marks.at({x, y});
      if (mark == 0 || owner(mark, current).mask == 0) continue;
      seen = seen.united({{x, y}, {x + 1, y + 1}});
    }
  }
  return seen;
}

/// Whether rays through these cells meet those of one owner and mask only, be they of another box.
void PatchRayCaster::find_uniform(const CellRect& rect, const Grid<std::int32_t>& marks,
                                  BoxContent& content) const {
  content.is_uniform = false;
  if (content.owners.size() != 1) return;
  const CellOwner& only = content.owners.front();
  std::set<std::int32_t> seen;
  std::set<std::int32_t> hidden;
  for (int y = rect.min.y; y < rect.max.y; ++y) {
    for (int x = rect.min.x; x < rect.max.x; ++x) {
      const std::int32_t mark = marks.contains({x, y}) ? marks.at({x, y}) : 0;
      if (mark == 0) continue;
      const CellOwner cell = owner(mark, content.current);
      const bool is_same = cell.submap == only.submap && cell.mask == only.mask;
      if (!is_same && cell.mask != 0) return;
      (is_same ? seen : hidden).insert(mark);
    }
  }
  // One number tells a ray which cells to go through.
  content.is_uniform = hidden.size() <= 1 || seen.size() == 1;
  content.hidden = hidden.empty() ? 0 : (hidden.size() == 1 ? *hidden.begin() : -*seen.begin());
}

/// Adds cells of a mark to what is in a box.
void PatchRayCaster::BoxContent::add(std::int32_t submap, std::uint64_t mask) {
  if (mask == 0) return;
  const auto is_same = [&](const CellOwner& owner) { return owner.submap == submap; };
  const auto found = std::find_if(owners.begin(), owners.end(), is_same);
  if (found == owners.end()) {
    owners.push_back({submap, mask});
  } else {
    found->mask |= mask;
  }
}

/// What is in a box with cells of these marks: as seen from elsewhere, and from each sub-map that
/// owns some of them.
std::vector<PatchRayCaster::BoxContent> PatchRayCaster::contents_of(
    const std::set<std::int32_t>& marks) const {
  std::vector<BoxContent> contents(1);
  for (const std::int32_t mark : marks) {
    const auto place = static_cast<std::size_t>(mark);
    for (std::size_t n = begins_[place]; n < begins_[place + 1]; ++n) {
      const auto is_same = [&](const BoxContent& content) {
        return content.current == owners_[n].submap;
      };
      if (std::none_of(contents.begin(), contents.end(), is_same)) {
        contents.emplace_back().current = owners_[n].submap;
      }
    }
  }
  for (BoxContent& content : contents) {
    for (const std::int32_t mark : marks) {
      const CellOwner cell = owner(mark, content.current);
      content.add(cell.submap, cell.mask);
    }
  }
  return contents;
}

/// The mark of each cell that is an obstacle in some configurations: cells with the same owners
/// have the same. Cells that end every ray go to `fixed`.
Grid<std::int32_t> PatchRayCaster::mark_cells(const patch::PatchMap& map, const CellRect& rect,
                                              Grid<std::uint8_t>& fixed) {
  Grid<std::int32_t> marks(map.base.resolution_m(), rect);
  Grid<std::uint8_t> inside(map.base.resolution_m(), rect);
  for (const patch::Submap& submap : map.submaps) {
    for (int y = submap.rect.min.y; y < submap.rect.max.y; ++y) {
      for (int x = submap.rect.min.x; x < submap.rect.max.x; ++x) inside.at({x, y}) = 1;
    }
  }
  using Owners = std::vector<std::pair<std::size_t, std::uint64_t>>;
  std::map<Owners, std::int32_t> known;
  begins_ = {0, 0};  // mark 0 has none
  Owners owners;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    const Cell cell = marks.cell(i);
    if (inside.values()[i] == 0) {
      fixed.values()[i] = is_occupied(map.base.get(cell)) ? 1 : 0;
      continue;
    }
    owners.clear();
    std::uint64_t any = 0;
    bool is_certain = true;
    for (const std::size_t s : patch::submaps_at(map, cell)) {
      owners.emplace_back(s, occupied_mask(map, s, cell));
      any |= owners.back().second;
      is_certain = is_certain && owners.back().second == all_[s];
    }
    if (any == 0) continue;
    if (is_certain) {
      fixed.values()[i] = 1;
      continue;
    }
    const auto [found, is_new] = known.try_emplace(owners, static_cast<int>(begins_.size()) - 1);
    marks.values()[i] = found->second;
    if (!is_new) continue;
    for (const auto& [s, mask] : owners) owners_.push_back({static_cast<std::int32_t>(s), mask});
    begins_.push_back(owners_.size());
  }
  return marks;
}

bool PatchRayCaster::may_end_beams(const rays::RayBox& box, int current, int fixed) const {
  for (const CellOwner& cells : owners_in(box, current)) {
    if ((cells.mask & counting(cells.submap, current, fixed)) != 0) return true;
  }
  return false;
}

void PatchRayCaster::events(double x_m, double y_m, double c, double s, double max_range_m,
                            int current, std::vector<RayEvent>& events) const {
  events.clear();
  double static_m = std::numeric_limits<double>::infinity();
  static_.walk(x_m, y_m, c, s, max_range_m, [&](std::size_t, double entry_m, double exit_m) {
    static_m = 0.5 * (entry_m + exit_m);
    return false;
  });
  bool is_ended = false;
  const auto visit = [&](std::size_t index, double entry_m, double exit_m) {
    if (entry_m > static_m) return false;
    const CellOwner cell = owner(changing_.mark(index), current);
    std::uint64_t ended = 0;
    for (const RayEvent& event : events) {
      if (event.submap == cell.submap) ended |= event.mask;
    }
    const std::uint64_t fresh = cell.mask & ~ended;
    if (fresh != 0) events.push_back({cell.submap, fresh, 0.5 * (entry_m + exit_m)});
    is_ended = (ended | fresh) == all(cell.submap);
    return !is_ended;
  };
  changing_.walk(x_m, y_m, c, s, max_range_m, visit);
  if (!is_ended && std::isfinite(static_m)) events.push_back({-1, 0, static_m});
}

}  // namespace strata::patch_beams
