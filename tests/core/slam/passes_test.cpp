// SPDX-License-Identifier: Apache-2.0
// A pass over the whole log replaces the one before only where it is better by a measure of its
// own.
#include <gtest/gtest.h>

#include "core/slam/slam_state.hpp"

namespace strata::slam {
namespace {

Consistency of(std::size_t compared, std::size_t contradicting, std::size_t fitting_cells,
               std::size_t contradicting_cells) {
  Consistency found;
  found.consistent = contradicting < 2;
  found.compared = compared;
  found.contradicting = contradicting;
  found.fitting_cells = fitting_cells;
  found.contradicting_cells = contradicting_cells;
  return found;
}

EarlierPass pass_with(const Consistency& consistency) {
  EarlierPass pass;
  pass.consistency = consistency;
  return pass;
}

TEST(Passes, AreOutdoneByOneThatContradictsItselfClearlyLess) {
  const EarlierPass before = pass_with(of(150, 10, 10000, 1000));
  EXPECT_TRUE(before.is_outdone_by(of(150, 1, 10000, 1000)));
  EXPECT_TRUE(before.is_outdone_by(of(150, 7, 10000, 1000)));
  EXPECT_FALSE(before.is_outdone_by(of(150, 8, 10000, 1000)));
}

TEST(Passes, AreNotOutdoneByOneThatTearsWaysApart) {
  const EarlierPass before = pass_with(of(150, 10, 10000, 1000));
  EXPECT_FALSE(before.is_outdone_by(of(40, 0, 3000, 50)));
}

TEST(Passes, ThatContradictThemselvesMoreThanTheyAgreeAreNotOutdoneByAWorseOne) {
  const EarlierPass before = pass_with(of(150, 90, 1000, 2000));
  EXPECT_FALSE(before.is_outdone_by(of(150, 90, 1000, 2020)));
}

// Where two ways lay 20 m apart nothing contradicted: they were not compared.
TEST(Passes, AreOutdoneByOneInWhichWaysAgreeInClearlyMoreThoughMoreContradictsToo) {
  const EarlierPass before = pass_with(of(158, 2, 10000, 1000));
  EXPECT_TRUE(before.is_outdone_by(of(179, 7, 11500, 1500)));
}

TEST(Passes, AreKeptWhereWhatAgreesMoreContradictsAsMuchMore) {
  const EarlierPass before = pass_with(of(158, 2, 10000, 1000));
  EXPECT_FALSE(before.is_outdone_by(of(179, 7, 11500, 2500)));
  EXPECT_FALSE(before.is_outdone_by(of(158, 2, 10000, 1000)));
  EXPECT_FALSE(before.is_outdone_by(of(160, 2, 10200, 1000)));
}

}  // namespace
}  // namespace strata::slam
