// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/topology_trial.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tools/laboratory/experiments/corridor_building.hpp"
#include "tools/laboratory/experiments/topology_odds.hpp"

namespace strata::experiments {
namespace {

topology::Hypothesis hypothesis(topology::Labels labels, double probability) {
  topology::Hypothesis result;
  result.labels = std::move(labels);
  result.probability = probability;
  return result;
}

/// Three visits, the first and the last half a metre apart.
const std::vector<Eigen::Vector2d> kPlaces{{0.0, 0.0}, {5.0, 0.0}, {0.5, 0.0}};

TEST(Reliability, EachProbabilityHasItsBin) {
  Reliability reliability;
  for (const double p : {0.0, 0.015, 0.02, 0.45, 0.979, 0.98, 1.0}) reliability.add(p, true);
  EXPECT_EQ(reliability.bins[0].pairs, 2.0);
  EXPECT_EQ(reliability.bins[1].pairs, 1.0);
  EXPECT_EQ(reliability.bins[5].pairs, 1.0);
  EXPECT_EQ(reliability.bins[10].pairs, 1.0);
  EXPECT_EQ(reliability.bins[11].pairs, 2.0);
  EXPECT_EQ(reliability.pairs(), 7.0);
}

TEST(Reliability, SaysHowFarTheWorstBinOfEnoughPairsIsOff) {
  Reliability reliability;
  for (int i = 0; i < 10; ++i) reliability.add(0.55, i < 8);   // 0.25 too modest
  for (int i = 0; i < 20; ++i) reliability.add(0.95, i < 17);  // 0.10 too sure
  EXPECT_NEAR(reliability.worst_error(5.0), 0.25, 1e-12);
  EXPECT_NEAR(reliability.worst_error(11.0), -0.10, 1e-12);
  EXPECT_EQ(reliability.worst_error(21.0), 0.0);
  EXPECT_NEAR(reliability.mean_error(), (10 * 0.25 + 20 * 0.10) / 30.0, 1e-12);
}

TEST(TopologyTrial, APairIsAsLikelyAsTheTopologiesThatMergeIt) {
  const std::vector<topology::Hypothesis> posterior{
      hypothesis({0, 1, 0}, 0.5), hypothesis({0, 1, 2}, 0.25), hypothesis({0, 0, 0}, 0.25)};
  EXPECT_NEAR(one_landmark(posterior, 0, 2), 0.75, 1e-12);
  EXPECT_NEAR(one_landmark(posterior, 0, 1), 0.25, 1e-12);
  TopologyTrial trial;
  judge_posterior(kPlaces, posterior, trial);
  EXPECT_EQ(trial.partitions, 1.0);
  EXPECT_EQ(trial.truth_first, 1.0);
  EXPECT_EQ(trial.truth_sure, 0.0);
  EXPECT_NEAR(trial.truth_mass, 0.5, 1e-12);
  EXPECT_EQ(trial.at_end.pairs(), 3.0);
  EXPECT_NEAR(trial.at_end.bins[8].probability, 0.75, 1e-12);
  EXPECT_EQ(trial.at_end.bins[8].one_place, 1.0);
  EXPECT_EQ(trial.at_end.bins[3].one_place, 0.0);
}

TEST(TopologyTrial, TheTruthHasNoMassWhereItWasNotKept) {
  TopologyTrial trial;
  judge_posterior(kPlaces, std::vector{hypothesis({0, 1, 2}, 0.9), hypothesis({0, 0, 0}, 0.1)},
                  trial);
  EXPECT_EQ(trial.partitions, 1.0);
  EXPECT_EQ(trial.truth_first, 0.0);
  EXPECT_EQ(trial.truth_mass, 0.0);
  EXPECT_NEAR(trial.largest_mass, 0.9, 1e-12);
}

TEST(TopologyTrial, NoPartitionIsTrueWherePlacesRunIntoEachOther) {
  TopologyTrial trial;
  const std::vector<Eigen::Vector2d> chained{{0.0, 0.0}, {0.8, 0.0}, {1.6, 0.0}};
  judge_posterior(chained, std::vector{hypothesis({0, 0, 0}, 1.0)}, trial);
  EXPECT_EQ(trial.partitions, 0.0);
  EXPECT_EQ(trial.truth_mass, 0.0);
  EXPECT_EQ(trial.at_end.bins.back().pairs, 3.0);
  EXPECT_EQ(trial.at_end.bins.back().one_place, 2.0);
}

TEST(TopologyTrial, OfADriveRoundACornerFindsItsCrossingsAgain) {
  CorridorPlan plan;
  plan.columns = plan.rows = 2;
  plan.spacing_x_m = plan.spacing_y_m = 8.0;
  plan.route = {0, 1, 3, 2, 0, 1, 3};
  const TopologyTrial trial = try_topologies(corridor_building(plan), 1);
  EXPECT_EQ(trial.buildings, 1.0);
  EXPECT_GE(trial.visits, 6.0);
  const double pairs = trial.visits * (trial.visits - 1.0) / 2.0;
  EXPECT_EQ(trial.at_end.pairs(), pairs);
  EXPECT_EQ(trial.when_new.pairs(), pairs);
  double one_place = 0.0;
  double said = 0.0;
  for (const ReliabilityBin& bin : trial.at_end.bins) {
    one_place += bin.one_place;
    said += bin.probability;
  }
  EXPECT_GE(one_place, 2.0) << "revisits";
  EXPECT_NEAR(said, one_place, 0.5);
  EXPECT_EQ(trial.truth_first, 1.0);
}

TEST(CorridorBuilding, LeadsOnlyToCrossingsBesideWhereNoWallIs) {
  CorridorPlan plan;
  plan.columns = 3;
  plan.rows = 2;
  plan.closed = {{0, 1}};
  EXPECT_EQ(plan.beside(0), (std::vector<std::size_t>{3}));
  EXPECT_EQ(plan.beside(4), (std::vector<std::size_t>{1, 3, 5}));
  EXPECT_FALSE(plan.is_open(2, 3)) << "the next row";
  EXPECT_FALSE(plan.is_open(1, 0)) << "closed";
  EXPECT_FALSE(plan.is_open(0, 4)) << "across";
  EXPECT_FALSE(plan.is_open(5, 6)) << "outside";
  plan.route = {3, 0, 1};
  EXPECT_THROW((void)corridor_building(plan), ConfigError);
}

TEST(CorridorBuilding, AtRandomHasADriveThroughOpenCorridors) {
  std::set<std::size_t> visits;
  std::size_t closed = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const CorridorPlan plan = random_corridors(seed);
    EXPECT_EQ(plan.route, random_corridors(seed).route);
    visits.insert(plan.route.size());
    closed += plan.closed.size();
    EXPECT_NO_THROW((void)corridor_building(plan));
    for (std::size_t i = 2; i < plan.route.size(); ++i) {
      if (plan.route[i] != plan.route[i - 2]) continue;
      EXPECT_EQ(plan.beside(plan.route[i - 1]).size(), 1U) << "only out of dead ends";
    }
    for (std::size_t crossing = 0; crossing < plan.crossings(); ++crossing) {
      EXPECT_FALSE(plan.beside(crossing).empty());
    }
  }
  EXPECT_EQ(*visits.begin(), 14U);
  EXPECT_EQ(*visits.rbegin(), 20U);
  EXPECT_GT(closed, 30U);
}

TEST(TopologyOdds, TheOdometryIsFiveToTwentyPercentOff) {
  double least = 1.0;
  double most = 0.0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    simulate::RobotConfig robot;
    draw_odometry_error(seed, robot);
    EXPECT_EQ(robot.scale_stddev, robot.trans_noise);
    least = std::min(least, robot.scale_stddev);
    most = std::max(most, robot.scale_stddev);
  }
  EXPECT_GE(least, 0.05);
  EXPECT_LT(least, 0.07);
  EXPECT_LE(most, 0.20);
  EXPECT_GT(most, 0.18);
}

}  // namespace
}  // namespace strata::experiments
