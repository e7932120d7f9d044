// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/landmark_clouds.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strata::paper {
namespace {

using topology::LocalCloud;
using topology::MadeVisit;

/// A wall of 4 m before the robot, 0.1 m between points.
LocalCloud wall(double x_m, std::size_t points = 40) {
  LocalCloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    cloud.points_m.emplace_back(x_m, 0.1 * static_cast<double>(i) - 2.0);
    cloud.normals.emplace_back(1.0, 0.0);
  }
  return cloud;
}

MadeVisit visit(LocalCloud cloud) {
  MadeVisit made;
  made.visit.cloud = std::move(cloud);
  return made;
}

TEST(LandmarkClouds, OverlapAtThePoseAtWhichTheyWereTaken) {
  EXPECT_EQ(overlap(wall(2.0), wall(1.0), {1.0, 0.0, 0.0}), 1.0);
  EXPECT_EQ(overlap(wall(2.0), wall(1.0), {}), 0.0);
  // Half a metre aside, three points of forty and those within 0.2 m of the end are left over.
  EXPECT_NEAR(overlap(wall(2.0), wall(2.0), {0.0, 0.5, 0.0}), 0.92, 0.03);
  EXPECT_EQ(overlap(wall(2.0), {}, {}), 0.0);
  EXPECT_EQ(overlap({}, wall(2.0), {}), 0.0);
}

TEST(LandmarkClouds, TheSmallerOneCountsWhicheverComesFirst) {
  EXPECT_EQ(overlap(wall(2.0), wall(2.0, 5), {}), 1.0);
  EXPECT_EQ(overlap(wall(2.0, 5), wall(2.0), {}), 1.0);
  EXPECT_EQ(overlap(wall(1.0, 5), wall(2.0), {-1.0, 0.0, 0.0}), 1.0);
}

/// Three visits of two landmarks: the third is where the first was, 1 m further on.
struct Toy {
  std::vector<MadeVisit> visits{visit(wall(2.0)), visit(wall(4.0)), visit(wall(1.0))};
  topology::Hypothesis hypothesis;
  Toy() {
    hypothesis.labels = {0, 1, 0};
    hypothesis.poses = {{0.0, 0.0, 0.0}, {50.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  }
};

TEST(LandmarkClouds, OfOneLandmarkAreCountedByThePosesOfTheTopology) {
  Toy toy;
  const CloudAgreement right = cloud_agreement(toy.visits, toy.hypothesis);
  EXPECT_EQ(right.landmarks, 2U);
  EXPECT_EQ(right.with_cloud, 2U);
  EXPECT_EQ(right.pairs, 1U);
  EXPECT_EQ(right.overlapping, 1U);
  EXPECT_EQ(right.others, 1U);
  EXPECT_EQ(right.others_overlapping, 0U);
  toy.hypothesis.poses[2].x = 2.0;
  toy.visits[1] = visit({});
  const CloudAgreement wrong = cloud_agreement(toy.visits, toy.hypothesis);
  EXPECT_EQ(wrong.with_cloud, 1U);
  EXPECT_EQ(wrong.pairs, 1U);
  EXPECT_EQ(wrong.overlapping, 0U);
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t times = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++times;
  }
  return times;
}

TEST(LandmarkClouds, AreDrawnATileALandmarkInAColourAVisit) {
  const Toy toy;
  const std::string svg = draw_clouds(toy.visits, toy.hypothesis).svg();
  EXPECT_EQ(count(svg, "<text"), 2U);
  EXPECT_EQ(count(svg, "stroke=\"#999\""), 2U);
  EXPECT_EQ(count(svg, "#0072b2"), 80U);  // the first visit of each
  EXPECT_EQ(count(svg, "#d55e00"), 40U);
}

TEST(SvgDrawing, CellsHaveNorthUpAndEqualNeighboursAreOne) {
  ReflectionGrid map = make_reflection_grid(0.1, {{0, 0}, {3, 2}});
  map.at({0, 1}) = 1.0F;  // the upper row: occupied, free, free
  map.at({1, 1}) = 0.0F;
  map.at({2, 1}) = 0.0F;
  SvgDrawing drawing(100.0, 100.0);
  drawing.cells(map, map.rect(), 10.0, 20.0, 5.0);
  const std::string svg = drawing.svg();
  const auto has = [&](const std::string& text) { return svg.find(text) != std::string::npos; };
  EXPECT_TRUE(has("x=\"10.0\" y=\"20.0\" width=\"5.0\" height=\"5.0\" fill=\"rgb(0,0,0)\""));
  EXPECT_TRUE(has("x=\"15.0\" y=\"20.0\" width=\"10.0\" height=\"5.0\" fill=\"rgb(255,255,255)\""));
  EXPECT_TRUE(has("x=\"10.0\" y=\"25.0\" width=\"15.0\" height=\"5.0\" fill=\"#b0b6be\""));
}

}  // namespace
}  // namespace strata::paper
