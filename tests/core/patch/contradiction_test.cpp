// SPDX-License-Identifier: Apache-2.0
#include "core/patch/contradiction.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace strata::patch {
namespace {

/// A table on a small lattice: visits[cell] lists (hits, misses) per visit; visit v spans scans
/// 10 v .. 10 v + 5 of every cell.
class TableBuilder {
 public:
  explicit TableBuilder(CellRect rect) : slots_(0.05, rect, -1), visits_(rect.area()) {}
  void set(const Cell& cell, std::vector<VisitEvidence> visits) {
    visits_[slots_.index(cell)] = std::move(visits);
  }
  [[nodiscard]] VisitTable build() const {
    Grid<std::int32_t> slots = slots_;
    std::vector<std::uint32_t> offsets{0};
    std::vector<Visit> all;
    std::int32_t next = 0;
    for (std::size_t i = 0; i < visits_.size(); ++i) {
      if (visits_[i].empty()) continue;
      slots.values()[i] = next++;
      for (std::size_t v = 0; v < visits_[i].size(); ++v) {
        const auto first = static_cast<std::uint32_t>(10 * v);
        all.push_back({first,
                       first + 5,
                       static_cast<float>(visits_[i][v].hits),
                       static_cast<float>(visits_[i][v].misses),
                       {}});
      }
      offsets.push_back(static_cast<std::uint32_t>(all.size()));
    }
    return {slots, offsets, all};
  }

 private:
  Grid<std::int32_t> slots_;
  std::vector<std::vector<VisitEvidence>> visits_;
};

int count(const Grid<std::uint8_t>& mask) {
  int sum = 0;
  for (const auto v : mask.values()) sum += v != 0 ? 1 : 0;
  return sum;
}

/// Eight visits: a line of cells along x occupied in the even ones, free in the odd ones.
TableBuilder changing_line(int visits, int cells) {
  TableBuilder table({{0, 0}, {20, 9}});
  for (int x = 0; x < cells; ++x) {
    std::vector<VisitEvidence> evidence;
    for (int v = 0; v < visits; ++v) {
      evidence.push_back(v % 2 == 0 ? VisitEvidence{6, 0} : VisitEvidence{0, 6});
    }
    table.set({4 + x, 4}, evidence);
  }
  return table;
}

TEST(ManyVisits, FindsALineThatChangesBetweenVisits) {
  const Grid<std::uint8_t> mask = test_many_visits(changing_line(8, 6).build(), {});
  // Its two ends have only one neighbour, fewer than three cells in their block.
  EXPECT_EQ(count(mask), 4);
  EXPECT_EQ(mask.get({6, 4}), 1);
}

TEST(ManyVisits, IgnoresCellsThatAreAlwaysHalfTransparent) {
  TableBuilder table({{0, 0}, {20, 9}});
  for (int x = 0; x < 10; ++x) table.set({4 + x, 4}, std::vector<VisitEvidence>(9, {3, 3}));
  EXPECT_EQ(count(test_many_visits(table.build(), {})), 0);
}

TEST(ManyVisits, ToleratesAWallThatJittersByOneCell) {
  TableBuilder table({{0, 0}, {20, 9}});
  for (int x = 0; x < 12; ++x) {
    std::vector<VisitEvidence> here;
    std::vector<VisitEvidence> there;
    for (int v = 0; v < 10; ++v) {
      here.push_back(v % 2 == 0 ? VisitEvidence{6, 0} : VisitEvidence{0, 6});
      there.push_back(v % 2 == 0 ? VisitEvidence{0, 6} : VisitEvidence{6, 0});
    }
    table.set({4 + x, 4}, here);
    table.set({4 + x, 5}, there);
  }
  EXPECT_EQ(count(test_many_visits(table.build(), {})), 0);
}

TEST(FewVisits, TwoOppositeVisitsOfALineAreEnough) {
  EXPECT_EQ(count(test_few_visits(changing_line(2, 10).build(), {})), 10);
  EXPECT_EQ(count(test_many_visits(changing_line(2, 10).build(), {})), 0);
}

TEST(FewVisits, NeedsTheLeastNumberOfCellsAndTheLeastExtent) {
  EXPECT_EQ(count(test_few_visits(changing_line(2, 8).build(), {})), 8);
  EXPECT_EQ(count(test_few_visits(changing_line(2, 7).build(), {})), 0);
  ContradictionConfig config;
  config.few_min_cells = 1;
  EXPECT_EQ(count(test_few_visits(changing_line(2, 6).build(), config)), 6);
  EXPECT_EQ(count(test_few_visits(changing_line(2, 5).build(), config)), 0) << "25 cm";
}

/// Whether a line along x that one visit hit and the other saw through, by so many beams in each
/// cell, is found. Of beams from everywhere 37/72 of the length goes across a line of six cells:
/// its spread is 1/12 across and 3 along, in cells, and the mean over all directions is half the
/// sum.
bool is_found(int cells, double hits, double misses, int rows = 1) {
  TableBuilder table({{0, 0}, {20, 9}});
  for (int x = 0; x < cells; ++x) {
    for (int y = 0; y < rows; ++y) table.set({4 + x, 4 + y}, {{hits, 0}, {0, misses}});
  }
  const int found = count(find_contradictions(table.build(), {}));
  EXPECT_TRUE(found == 0 || found == cells * rows);
  return found != 0;
}

TEST(FewVisits, SixCellsAreEnoughWhereBothVisitsHaveFifteenBeamsInEach) {
  constexpr double kAcross = 37.0 / 72.0;
  EXPECT_TRUE(is_found(6, 15.0, 15.01 / kAcross));
  EXPECT_FALSE(is_found(6, 14.99, 15.01 / kAcross)) << "too few ended there";
  EXPECT_FALSE(is_found(6, 15.0, 14.99 / kAcross)) << "too few went across";
  EXPECT_FALSE(is_found(5, 1000.0, 1000.0)) << "too few cells";
  EXPECT_FALSE(is_found(3, 1000.0, 1000.0, 2)) << "six cells, 15 cm";
  EXPECT_TRUE(is_found(4, 1000.0, 1000.0, 2)) << "20 cm";
}

TEST(FewVisits, StrengthIsThatOfTheCellsTogether) {
  // A cell at the border of a leaf is hit by few beams.
  for (const double at_the_border : {1.0, 6.0}) {
    TableBuilder table({{0, 0}, {20, 9}});
    for (int x = 0; x < 6; ++x) table.set({4 + x, 4}, {{x == 0 ? 4.0 : 17.0, 0}, {0, 100}});
    table.set({10, 4}, {{at_the_border, 0}, {0, 100}});
    // 4 + 5 x 17 + 6 = 95 in seven cells, and 89 in six where one hit is no evidence at all.
    EXPECT_EQ(count(find_contradictions(table.build(), {})), 0) << at_the_border;
    table.set({5, 4}, {{33, 0}, {0, 100}});
    EXPECT_GE(count(find_contradictions(table.build(), {})), 6) << at_the_border;
  }
}

TEST(FewVisits, MoreEvidenceTakesNoChangeAway) {
  for (int cells = 6; cells <= 10; ++cells) {
    bool was_found = false;
    for (double beams = 3.0; beams < 200.0; beams *= 1.5) {
      const bool is_now = is_found(cells, beams, beams);
      EXPECT_TRUE(is_now || !was_found) << cells << " cells, " << beams << " beams";
      was_found = is_now;
    }
    EXPECT_TRUE(was_found);
  }
}

TEST(FewVisits, FindALineThatLiesAskewAsOneThatDoesNot) {
  TableBuilder table({{0, 0}, {20, 20}});
  // 0.32 m from corner to corner, 0.25 m at most along rows and columns: a door leaf of Wean Hall.
  for (const Cell& cell : std::initializer_list<Cell>{
           {2, 3}, {3, 4}, {4, 4}, {4, 5}, {5, 5}, {4, 6}, {5, 6}, {5, 7}}) {
    table.set(cell, {{6, 0}, {0, 6}});
  }
  EXPECT_EQ(count(test_few_visits(table.build(), {})), 8);
}

TEST(FewVisits, AStateThatOneVisitSawIsFoundAmongAnyNumberOfVisits) {
  for (std::size_t visits = 2; visits <= 20; ++visits) {
    for (const bool is_rarely_free : {false, true}) {
      const VisitEvidence usual = is_rarely_free ? VisitEvidence{6, 0} : VisitEvidence{0, 6};
      std::vector<VisitEvidence> evidence(visits, usual);
      evidence[1] = {usual.misses, usual.hits};
      TableBuilder table({{0, 0}, {20, 9}});
      for (int x = 0; x < 12; ++x) table.set({4 + x, 4}, evidence);
      EXPECT_GE(count(find_contradictions(table.build(), {})), 10)
          << visits << " visits, free in " << (is_rarely_free ? "one" : "all but one");
    }
  }
}

TEST(Contradictions, ASurfaceThatJittersIsGoneWhereOneVisitLookedThroughIt) {
  for (std::size_t visits = 5; visits <= 25; ++visits) {
    TableBuilder table({{0, 0}, {20, 12}});
    std::vector<VisitEvidence> here(visits, VisitEvidence{0, 6});
    std::vector<VisitEvidence> beside = here;
    for (std::size_t v = 0; v + 1 < visits; ++v) (v % 2 == 0 ? here : beside)[v] = {6, 0};
    for (int x = 0; x < 12; ++x) {
      table.set({4 + x, 4}, here);
      table.set({4 + x, 5}, beside);
    }
    EXPECT_EQ(count(find_contradictions(table.build(), {})), 24) << visits << " visits";
  }
}

TEST(Contradictions, SomebodyWhoStoodInAFewVisitsIsNoState) {
  std::vector<VisitEvidence> evidence(20, VisitEvidence{0, 6});
  evidence[3] = {3, 0};
  for (const std::size_t v : {4U, 5U, 11U, 12U}) evidence[v] = {12, 20};
  TableBuilder table({{0, 0}, {20, 12}});
  for (int x = 0; x < 6; ++x) {
    for (int y = 0; y < 4; ++y) table.set({4 + x, 4 + y}, evidence);
  }
  EXPECT_EQ(count(find_contradictions(table.build(), {})), 0);
}

/// A wall of 12 cells that every visit sees, and a line beside it, `rows` away, that changes.
int changes_beside_a_wall(int rows, int wall_visits) {
  TableBuilder table({{0, 0}, {20, 24}});
  for (int x = 0; x < 12; ++x) {
    std::vector<VisitEvidence> wall(4, VisitEvidence{0, 0});
    for (int v = 0; v < wall_visits; ++v) wall[static_cast<std::size_t>(v)] = {6, 0};
    table.set({4 + x, 4}, wall);
    // Free in the last visit, which does not see the wall: from its other side, say.
    table.set({4 + x, 4 + rows}, {{6, 0}, {6, 0}, {6, 0}, {0, 6}});
  }
  return static_cast<int>(count(find_contradictions(table.build(), {})));
}

TEST(Contradictions, NextToASurfaceThatNeverChangesAreThatSurfaceDisplaced) {
  EXPECT_EQ(changes_beside_a_wall(3, 3), 0);
  EXPECT_EQ(changes_beside_a_wall(8, 3), 12) << "0.4 m away it is something else";
  EXPECT_EQ(changes_beside_a_wall(3, 1), 12) << "seen once, the surface is no wall yet";
}

TEST(FewVisits, ToleratesAWallDisplacedWithinTheTolerance) {
  for (const int shift : {1, 2, 3}) {
    TableBuilder table({{0, 0}, {20, 12}});
    for (int x = 0; x < 12; ++x) {
      table.set({4 + x, 4}, {{6, 0}, {0, 6}});
      table.set({4 + x, 4 + shift}, {{0, 6}, {6, 0}});
    }
    EXPECT_EQ(count(test_few_visits(table.build(), {})), 0) << "shift " << shift;
  }
}

TEST(FewVisits, CellsThatDisagreeOnWhenTheyChangedAreNotOneObject) {
  // Neighbours change at different times, as at the ragged border of a wall seen askew.
  TableBuilder table({{0, 0}, {20, 9}});
  for (int x = 0; x < 10; ++x) {
    std::vector<VisitEvidence> evidence(5, VisitEvidence{1, 1});
    evidence[static_cast<std::size_t>(x % 5)] = {6, 0};
    evidence[static_cast<std::size_t>((x + 1) % 5)] = {0, 6};
    table.set({4 + x, 4}, evidence);
  }
  ContradictionConfig config;
  config.tolerance_m = 0.0;
  EXPECT_EQ(count(test_few_visits(table.build(), config)), 0);
}

// Of seventeen visits one or two saw the other state: G over all visits does not see them.
TEST(TwoStates, ARareStateIsSeenAndOneRateIsNot) {
  const ContradictionConfig config;
  for (const std::size_t rare : {1U, 2U}) {
    std::vector<VisitEvidence> visits(17, VisitEvidence{0.0, 4.0});
    for (std::size_t i = 0; i < rare; ++i) visits[3 * i + 1] = {4.0, 0.0};
    EXPECT_GT(chi_squared_tail(g_statistic(visits), 16), 0.1 * config.significance);
    EXPECT_LT(two_states_tail(visits, config), config.significance) << rare;
  }
  std::vector<VisitEvidence> same(17, VisitEvidence{2.0, 2.0});
  EXPECT_EQ(two_states_tail(same, config), 1.0);
  std::vector<VisitEvidence> weak(17, VisitEvidence{0.0, 4.0});
  weak[5] = {1.0, 0.5};
  EXPECT_GT(two_states_tail(weak, config), config.significance);
}

}  // namespace
}  // namespace strata::patch
