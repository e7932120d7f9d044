// SPDX-License-Identifier: Apache-2.0
/// The journal of a robot that changes the level.
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/components/localizer/house_fixture.hpp"
#include "tests/components/localizer/journal_fixture.hpp"

namespace strata::localizer {
namespace {

class JournalOfLevels : public LocalizerJournal {
 protected:
  JournalOfLevels() : LocalizerJournal(seen_on_ride()) {}
};

TEST_F(JournalOfLevels, GivesTheSamePosesOnBothAndLeavesOutTheScanThatChangedTheLevel) {
  begin_with(parameters_on_ride(start_of_ride(), house().site));
  const Poses poses = drive(static_cast<int>(scan_count_) - 1);  // the first scan gives none
  std::set<std::string> maps;
  for (const ParameterEvent& point : points_->wait_for(1)) maps.insert(restore_point(point).maps);
  ASSERT_EQ(maps.size(), 2U) << "or the level never changed";
  const JournalReplay::Outcome outcome = run(journal(poses.size() - 1));
  EXPECT_TRUE(outcome.is_same());
  EXPECT_EQ(replayed_.size(), poses.size() - 1);
}

}  // namespace
}  // namespace strata::localizer
