// SPDX-License-Identifier: Apache-2.0
#include "components/log/trajectory_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/relations_file.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::log {
namespace {

using test_log::write_text;

TEST(TrajectoryFile, TumReadsBack) {
  const strata::test::TemporaryDirectory folder;
  const std::vector<StampedPose> poses = {{{1'500'000'000}, {1.25, -2.5, 3.1}},
                                          {{1'663'967'375'543'607'123}, {0.0, 0.0, -3.1}}};
  write_trajectory(folder.path() / "t.tum", poses);
  const auto back = read_trajectory(folder.path() / "t.tum");
  ASSERT_EQ(back.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back[i].stamp, poses[i].stamp);
    EXPECT_NEAR(back[i].pose.x, poses[i].pose.x, 1e-9);
    EXPECT_NEAR(back[i].pose.theta, poses[i].pose.theta, 1e-9);
  }
}

TEST(TrajectoryFile, RowsMarkedUnreliableAreLeftOut) {
  const strata::test::TemporaryDirectory folder;
  const auto path = folder.path() / "t.txt";
  write_text(path, "# stamp x y theta sd\n1 1 2 0.5 0.1\n2 1 2 0.5 6.9\n3 1 2 0.5 nan\n");
  TrajectoryReport report;
  EXPECT_EQ(read_trajectory(path, 10.0, &report).at(0).stamp.ns, 11'000'000'000);
  EXPECT_EQ(report.unreliable, 2U);
  // The same column under another name says something else.
  write_text(path, "# t x y theta hit\n1 1 2 0.5 0.944\n2 1 2 0.5 1\n");
  EXPECT_EQ(read_trajectory(path).size(), 2U);
}

TEST(TrajectoryFile, ARowThatIsNoPoseNamesItsLine) {
  const strata::test::TemporaryDirectory folder;
  const auto path = folder.path() / "t.txt";
  for (const char* row : {"1 2 3", "1 2 x 4", "1 2 nan 4", "1 2 3 0 0 0 0 0"}) {
    write_text(path, std::string("1 1 2 0.5\n") + row + "\n");
    try {
      (void)read_trajectory(path);
      FAIL() << row;
    } catch (const InputError& error) {
      EXPECT_THAT(error.place(), ::testing::HasSubstr("t.txt:2"));
    }
  }
  write_text(path, "# nothing\n");
  EXPECT_THROW((void)read_trajectory(path), InputError);
}

TEST(TrajectoryFile, ACorrectedLogGivesItsLaserPosesBroughtToTheRobot) {
  const strata::test::TemporaryDirectory folder;
  const auto path = folder.path() / "c.log";
  write_text(path,
             "PARAM robot_frontlaser_offset 0.5 h 0\n"
             "FLASER 2 1 1 10.5 0 0 0 0 0 1 h 1\n"
             "FLASER 2 1 1 12.5 3 0 1 0 0 2 h 2\n"
             "FLASER 2 1 1 14.5 6 0 3 0 0 3 h 3\n");
  const auto poses = read_trajectory(path);
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_DOUBLE_EQ(poses[1].pose.x, 12.0);
  EXPECT_DOUBLE_EQ(poses[1].pose.y, 3.0);
}

TEST(TrajectoryFile, RealReferencesRead) {
  STRATA_REQUIRE_DATA(olin, "olin_mac/take_2.ref.txt");
  TrajectoryReport report;
  EXPECT_EQ(read_trajectory(olin, 0.0, &report).size(), 254U);
  EXPECT_EQ(report.unreliable, 103U);
  STRATA_REQUIRE_DATA(wean, "wean_hall/run1.ref.txt");
  EXPECT_EQ(read_trajectory(wean).size(), 713U);
  STRATA_REQUIRE_DATA(fhw, "fhw/fhw-corrected.log.gz");
  EXPECT_EQ(read_trajectory(fhw).size(), 488U);
  STRATA_REQUIRE_DATA(relations, "intel/intel.relations");
  EXPECT_EQ(read_relations(relations).size(), 2984U);
}

TEST(RelationsFile, ABadRowNamesItsLine) {
  const strata::test::TemporaryDirectory folder;
  const auto path = folder.path() / "r";
  write_text(path, "1 2 0.5 0 0 0 0 0.1\n1 2 0.5\n");
  try {
    (void)read_relations(path);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.place(), ::testing::HasSubstr("r:2"));
  }
}

}  // namespace
}  // namespace strata::log
