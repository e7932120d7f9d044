// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/test_data.hpp"
#include "tools/laboratory/experiments/decoder_table.hpp"
#include "tools/laboratory/experiments/place_figures.hpp"
#include "tools/laboratory/experiments/place_views.hpp"
#include "tools/laboratory/experiments/put_object.hpp"

namespace strata::experiments {
namespace {

/// A round room of 3 m; with_box: 1.5 m at bearings 0 to 40 degrees from its middle.
PosedScan look(const Pose2& robot, double time_s, bool with_box) {
  PosedScan scan;
  scan.map_from_robot = robot;
  scan.scan.stamp = Stamp::from_seconds(time_s);
  scan.scan.angle_min_rad = -static_cast<float>(std::numbers::pi);
  scan.scan.angle_increment_rad = static_cast<float>(std::numbers::pi / 180.0);
  scan.scan.range_max_m = 20.0F;
  for (std::size_t i = 0; i < 360; ++i) {
    const double bearing = robot.theta + scan.scan.bearing_rad(i);
    const double degrees =
        180.0 / std::numbers::pi * std::remainder(bearing, 2.0 * std::numbers::pi);
    scan.scan.ranges_m.push_back(with_box && degrees > 0.0 && degrees < 40.0 ? 1.5F : 3.0F);
  }
  return scan;
}

/// The robot turns on the spot.
std::vector<PosedScan> turn(bool with_box, int scans = 20) {
  std::vector<PosedScan> result;
  for (int i = 0; i < scans; ++i) {
    result.push_back(look({0.02, 0.0, 0.3 * i}, 2.0 * i, with_box));
  }
  return result;
}

TEST(PlaceViews, FindTheObjectThatCameAndNothingElse) {
  const memory::PolarBins bins;
  const ChangedPlace place = find_changed_place(turn(false), turn(true), 1.0, bins, 0.5);
  EXPECT_NEAR(place.node_m.norm(), 0.02, 1e-9);
  EXPECT_NEAR(static_cast<double>(place.states.bins.size()), 40.0, 2.0);
  for (const std::size_t bin : place.states.bins) {
    EXPECT_TRUE(bin < 41 || bin == 359) << bin;
    EXPECT_TRUE(place.states.shows_after(1.6F, bin));
    EXPECT_FALSE(place.states.shows_after(2.9F, bin));
  }
  EXPECT_THROW((void)find_changed_place(turn(true), turn(true), 1.0, bins, 0.5), InputError);
}

TEST(PlaceViews, LeaveOutBinsThatOneOccasionShowsInBothStates) {
  std::vector<PosedScan> mixed = turn(true);
  for (const PosedScan& scan : turn(false, 12)) mixed.push_back(scan);
  const memory::PolarBins bins;
  EXPECT_TRUE(tell_apart(views_from(turn(false), {0.0, 0.0}, 1.0, bins),
                         views_from(mixed, {0.0, 0.0}, 1.0, bins), bins, 0.5)
                  .bins.empty());
}

TEST(PlaceFigures, SwitchAsAWholeAndCompleteTheHiddenHalf) {
  PlaceFigures figures;
  figures.seeds = 5;
  const TwoStates states =
      find_changed_place(turn(false), turn(true), 1.0, figures.bins, 0.5).states;
  const std::vector<NamedDecoder> decoders = paper_decoders();
  ASSERT_EQ(decoders[1].name, "exact");
  for (const NamedDecoder& decoder : std::span(decoders).first(2)) {
    const SwitchResult whole = switch_states(states, decoder, figures);
    EXPECT_EQ(whole.never, 0) << decoder.name;
    EXPECT_EQ(whole.mixed, 0.0) << decoder.name;
    EXPECT_GT(whole.min_share, 0.35) << decoder.name;
    EXPECT_LT(whole.greatest_share, 0.65) << decoder.name;
    EXPECT_EQ(complete_half(states, decoder, figures).complete, 5) << decoder.name;
    EXPECT_EQ(wrong_bins(states, decoder, 0.0, figures), 0.0) << decoder.name;
    EXPECT_EQ(wrong_bins(states, decoder, 1.0, figures), 1.0) << decoder.name;
  }
  EXPECT_EQ(complete_half(states, decoders.back(), figures).complete, 0);
  EXPECT_GT(switch_states(states, decoders.back(), figures).mixed, 1.0);
}

TEST(PlaceViews, KeepBinsThatBothOccasionsKnowAboutAsOften) {
  constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
  TwoStates states;
  states.before = {{1.0F, 1.0F, kNothing}, {1.0F, kNothing, kNothing}, {1.0F, 1.0F, 1.0F}};
  states.after = {{2.0F, 2.0F, 2.0F}, {2.0F, 2.0F, 2.0F}, {kNothing, 2.0F, 2.0F}};
  states.bins = {0, 1, 2};
  keep_bins_seen_as_often(states);
  EXPECT_EQ(states.bins, (std::vector<std::size_t>{0, 1}));
}

TEST(PutObject, EndsTheBeamsThatWouldPassItAndNoOthers) {
  std::vector<PosedScan> scans = turn(false, 3);
  scans[1].scan.ranges_m[7] = std::numeric_limits<float>::infinity();
  scans[1].scan.ranges_m[8] = std::numeric_limits<float>::quiet_NaN();
  scans[1].scan.ranges_m[200] = 0.4F;
  // At (1, -0.5) to (1, 0.5): seen from (0.02, 0) at 0.98 m and up to 27 degrees aside.
  const simulate::Segment board = placed({0.98, 1.0}, scans.front());
  EXPECT_NEAR((board.a - Eigen::Vector2d(1.0, -0.5)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((board.b - Eigen::Vector2d(1.0, 0.5)).norm(), 0.0, 1e-9);
  RandomStream random(1, StreamId::kTest);
  const std::vector<PosedScan> seen = with_object(scans, board, 0.0, random);
  for (std::size_t k = 0; k < scans.size(); ++k) {
    for (std::size_t i = 0; i < 360; ++i) {
      const double bearing = std::remainder(
          scans[k].map_from_robot.theta + scans[k].scan.bearing_rad(i), 2.0 * std::numbers::pi);
      const double ahead = std::cos(bearing) > 0.0 ? 0.98 * std::tan(bearing) : 9.0;
      if (std::abs(std::abs(ahead) - 0.5) < 1e-6) continue;
      const float was = scans[k].scan.ranges_m[i];
      if (std::abs(ahead) < 0.5 && !(was < 0.5F)) {
        EXPECT_NEAR(seen[k].scan.ranges_m[i], 0.98 / std::cos(bearing), 1e-6) << k << " " << i;
      } else {
        EXPECT_TRUE(seen[k].scan.ranges_m[i] == was || std::isnan(was)) << k << " " << i;
      }
    }
  }
}

/// Stretches of 8 s or more within 6 cm and 0.03 rad: all there are in the logs of Wean Hall,
/// Freiburg 079 and Intel.
struct Standing {
  const char* name;
  const char* log;
  const char* poses;
  double from_s, middle_s, to_s;
  /// A board 1 m ahead stands behind what is there.
  bool hides_the_board = false;
};

/// The decoder was fitted on seeds 1 to 20 and 1001 to 1100.
constexpr std::uint64_t kNotTunedOn = 2001;

class RobotThatStands : public testing::TestWithParam<Standing> {};

// The paper's robot stood while an object was placed before it; so does this one.
TEST_P(RobotThatStands, MeetsFigures6To8OnRealScans) {
  STRATA_REQUIRE_DATA(log, GetParam().log);
  STRATA_REQUIRE_DATA(poses, GetParam().poses);
  const auto [name, log_name, poses_name, from_s, middle_s, to_s, hides_the_board] = GetParam();
  PlaceFigures figures;
  figures.first_seed = kNotTunedOn;
  figures.seeds = 50;
  const std::vector<PosedScan> before =
      posed_scans({log.string(), poses.string(), from_s, middle_s});
  const std::vector<PosedScan> after = posed_scans({log.string(), poses.string(), middle_s, to_s});
  const Eigen::Vector2d node_m = after.front().map_from_laser().translation();
  const auto seen = [&](const std::vector<PosedScan>& scans, const Pose2& error = {}) {
    return views_from(scans, node_m, 0.5, figures.bins, error);
  };
  const std::vector<NamedDecoder> decoders = paper_decoders();
  const NamedDecoder& scene = decoders.front();
  ASSERT_EQ(scene.name, "scene");
  RandomStream random(1, StreamId::kTest);
  const TwoStates states = tell_apart(
      seen(before), seen(with_object(after, placed({1.0, 0.7}, after.front()), 0.01, random)),
      figures.bins, 0.5);
  EXPECT_EQ(states.bins.size() < 5U, hides_the_board);
  if (!hides_the_board) {
    const SwitchResult whole = switch_states(states, scene, figures);
    EXPECT_EQ(whole.never, 0);
    EXPECT_EQ(whole.mixed, 0.0);
    EXPECT_GT(whole.min_share, 0.35);
    EXPECT_LT(whole.greatest_share, 0.65);
    EXPECT_GE(10 * complete_half(states, scene, figures).complete, 9 * figures.seeds);
    EXPECT_GT(switch_states(states, decoders.back(), figures).mixed, 1.0);
  }
  const TwoStates aside =
      tell_apart(seen(after), seen(after, {-0.3, 0.2, 0.1}), figures.bins, 0.3, true);
  ASSERT_GT(aside.bins.size(), 60U);
  for (const double share : {0.1, 0.2, 0.3}) {
    EXPECT_LE(wrong_bins(aside, scene, share, figures), 0.03) << share;
  }
}

constexpr const char* kIntel[] = {"intel/intel.clf.gz", "intel/intel.ref.txt"};
constexpr const char* kFreiburg[] = {"fr079/fr079.clf.gz", "fr079/fr079.ref.txt"};
INSTANTIATE_TEST_SUITE_P(
    PlaceFigures, RobotThatStands,
    testing::Values(
        Standing{"Intel0s", kIntel[0], kIntel[1], 0.0, 14.0, 28.0},
        Standing{"Intel941s", kIntel[0], kIntel[1], 941.0, 946.0, 950.5},
        Standing{"Freiburg418s", kFreiburg[0], kFreiburg[1], 417.6, 423.0, 428.7},
        Standing{"Freiburg1003s", kFreiburg[0], kFreiburg[1], 1002.56, 1006.61, 1010.66},
        Standing{"Freiburg1049s", kFreiburg[0], kFreiburg[1], 1048.65, 1054.74, 1060.82, true}),
    [](const auto& place) { return std::string(place.param.name); });

TEST(DecoderTable, OnARealLogNoDecoderFindsALikelierPathThanTheExactOne) {
  STRATA_REQUIRE_DATA(log, "wean_hall/run1.clf.gz");
  STRATA_REQUIRE_DATA(poses, "wean_hall/run1.ref.txt");
  memory::TimescaleMemory memory;
  for (const PosedScan& scan : posed_scans({log.string(), poses.string()})) memory.observe(scan);
  const std::vector<DecoderRow> rows = compare_decoders(memory);
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[0].different_levels, 0U);
  EXPECT_EQ(rows[0].inconsistent, 0U);
  for (std::size_t i = 1; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].levels, 3 * memory.nodes().size());
    EXPECT_GT(rows[i].different_levels, 0U) << rows[i].name;
    EXPECT_GT(rows[i].log_product, 0.0) << rows[i].name;
    EXPECT_GE(rows[i].worst_log_product, rows[i].log_product) << rows[i].name;
    EXPECT_LE(rows[i].far_bins, rows[i].different_bins) << rows[i].name;
  }
}

}  // namespace
}  // namespace strata::experiments
