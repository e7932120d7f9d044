// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/odometry_gate.hpp"

#include <limits>
#include <tuple>

#include <gtest/gtest.h>

namespace strata {
namespace {

using Kind = OdometryStep::Kind;

Stamp at(double seconds) { return Stamp::from_seconds(seconds); }

TEST(OdometryGate, TellsTheMotionSinceTheLastReading) {
  OdometryGate gate;
  const Pose2 a{1.0, 2.0, 0.5};
  const Pose2 step{0.2, 0.0, 0.1};
  const Pose2 b = a * step;
  EXPECT_EQ(gate.pass(at(0.0), &a).kind, Kind::kFirst);
  const OdometryStep told = gate.pass(at(0.1), &b);
  EXPECT_EQ(told.kind, Kind::kTold);
  EXPECT_NEAR(told.motion.x, 0.2, 1e-12);
  EXPECT_NEAR(told.motion.theta, 0.1, 1e-12);
}

TEST(OdometryGate, BridgesScansWithoutAReadingOrWithADamagedOne) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Pose2& damaged : {Pose2{kNan, 0.0, 0.0}, Pose2{0.0, kNan, 0.0}, Pose2{0.0, 0.0, kNan},
                               Pose2{std::numeric_limits<double>::infinity(), 0.0, 0.0}}) {
    OdometryGate gate;
    const Pose2 a{};
    const Pose2 b{0.4, 0.0, 0.0};
    (void)gate.pass(at(0.0), &a);
    EXPECT_EQ(gate.pass(at(0.1), &damaged).kind, Kind::kMissing);
    EXPECT_EQ(gate.pass(at(0.2), nullptr).kind, Kind::kMissing);
    const OdometryStep told = gate.pass(at(0.3), &b);
    EXPECT_EQ(told.kind, Kind::kTold);
    EXPECT_NEAR(told.motion.x, 0.4, 1e-12);
  }
}

TEST(OdometryGate, TakesOffWhatWasFoundOtherwise) {
  OdometryGate gate;
  const Pose2 a{3.0, 1.0, 1.0};
  const Pose2 step{0.4, 0.1, 0.2};
  const Pose2 b = a * step;
  (void)gate.pass(at(0.0), &a);
  (void)gate.pass(at(0.1), nullptr);
  gate.moved_otherwise({0.3, 0.0, 0.1});
  const OdometryStep told = gate.pass(at(0.2), &b);
  EXPECT_EQ(told.kind, Kind::kTold);
  const Pose2 whole = Pose2{0.3, 0.0, 0.1} * told.motion;
  EXPECT_NEAR(whole.x, 0.4, 1e-12);
  EXPECT_NEAR(whole.y, 0.1, 1e-12);
  EXPECT_NEAR(whole.theta, 0.2, 1e-12);
}

TEST(OdometryGate, DoesNotTellAWayThatNobodyKnows) {
  OdometryGate gate;
  const Pose2 a{};
  const Pose2 b{0.4, 0.0, 0.0};
  (void)gate.pass(at(0.0), &a);
  (void)gate.pass(at(0.1), nullptr);
  gate.forget_motion();
  EXPECT_EQ(gate.pass(at(0.2), &b).kind, Kind::kUntold);
  EXPECT_EQ(gate.pass(at(0.3), &b).kind, Kind::kTold);
}

TEST(OdometryGate, TheFirstReadingAfterScansWithoutTellsNothing) {
  OdometryGate gate;
  const Pose2 b{0.4, 0.0, 0.0};
  EXPECT_EQ(gate.pass(at(0.0), nullptr).kind, Kind::kFirst);
  EXPECT_EQ(gate.pass(at(0.1), nullptr).kind, Kind::kMissing);
  EXPECT_EQ(gate.pass(at(0.2), &b).kind, Kind::kUntold);
  gate.reset();
  EXPECT_EQ(gate.pass(at(0.3), &b).kind, Kind::kFirst);
}

TEST(OdometryGate, RefusesJumpsAndTurnsThatNoRobotMakesAndGoesOnFromThere) {
  for (const Pose2& jump : {Pose2{2.0, 0.0, 0.0}, Pose2{0.0, 0.0, 2.5}, Pose2{0.0, 0.0, -2.5}}) {
    OdometryGate gate;
    const Pose2 a{};
    const Pose2 next = jump * Pose2{0.1, 0.0, 0.0};
    (void)gate.pass(at(0.0), &a);
    EXPECT_EQ(gate.pass(at(0.1), &jump).kind, Kind::kJumped);
    const OdometryStep told = gate.pass(at(0.2), &next);
    EXPECT_EQ(told.kind, Kind::kTold);
    EXPECT_NEAR(told.motion.x, 0.1, 1e-12);
  }
  OdometryGate gate;
  const Pose2 a{};
  const Pose2 slowly{2.0, 0.0, 2.5};
  (void)gate.pass(at(0.0), &a);
  EXPECT_EQ(gate.pass(at(1.0), &slowly).kind, Kind::kTold);
}

TEST(OdometryGate, DoesNotTakeABaseThatWasSwitchedOnAgainForADrive) {
  const Pose2 before{12.0, 3.0, 1.2};
  const Pose2 zero{0.001, 0.0, 0.0};
  const Pose2 next{0.101, 0.0, 0.0};
  OdometryGate gate;
  (void)gate.pass(at(0.0), &before);
  EXPECT_EQ(gate.pass(at(20.0), &zero).kind, Kind::kJumped);
  const OdometryStep told = gate.pass(at(20.2), &next);
  EXPECT_EQ(told.kind, Kind::kTold);
  EXPECT_NEAR(told.motion.x, 0.1, 1e-12);

  // Who drives home is believed: scan by scan, and after a pause that ends beside zero or near it.
  const Pose2 near{0.8, 0.0, 0.0};
  const Pose2 beside{0.1, 0.0, 0.0};
  for (const auto& [from, to, s] : {std::tuple(near, zero, 0.5), std::tuple(before, beside, 20.0),
                                    std::tuple(near, zero, 20.0)}) {
    OdometryGate other;
    (void)other.pass(at(0.0), &from);
    EXPECT_EQ(other.pass(at(s), &to).kind, Kind::kTold);
  }
}

TEST(OdometryGate, StampsThatGoBackCountAsNoTime) {
  OdometryGate gate;
  const Pose2 a{};
  const Pose2 near{0.9, 0.0, 0.0};
  const Pose2 far{2.0, 0.0, 0.0};
  (void)gate.pass(at(5.0), &a);
  EXPECT_EQ(gate.pass(at(1.0), &near).kind, Kind::kTold);
  EXPECT_EQ(gate.pass(at(0.5), &far).kind, Kind::kJumped);
}

}  // namespace
}  // namespace strata
