// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/turning_robot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tools/simulate/laser.hpp"

namespace strata::experiments {
namespace {

using memory::NodeLevel;
using memory::PolarBins;
using memory::VirtualScan;

constexpr double kReach_m = 0.4;  // of the robot from the node
constexpr int kViews = 200;
constexpr double kDifference_m = 0.3;
constexpr double kWhole = 0.95;
const Pose2 kWrong{-0.3, 0.2, 0.1};

double heading_to(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

Pose2 drawn_pose(const BoardRoom& room, Looking looking, RandomStream& random) {
  const double away_m = kReach_m * std::sqrt(random.uniform());
  const double aside = random.uniform(-std::numbers::pi, std::numbers::pi);
  const Eigen::Vector2d at =
      room.node_m + away_m * Eigen::Vector2d(std::cos(aside), std::sin(aside));
  const double to_board = heading_to(at, 0.5 * (room.board.a + room.board.b));
  switch (looking) {
    case Looking::kAtBoard:
      return {at.x(), at.y(), to_board + random.uniform(-1.0, 1.0) * 0.25 * std::numbers::pi};
    case Looking::kPastHalfBoard:
      return {at.x(), at.y(), to_board - 0.5 * std::numbers::pi};
    case Looking::kAnywhere:
      break;
  }
  return {at.x(), at.y(), random.uniform(-std::numbers::pi, std::numbers::pi)};
}

std::vector<VirtualScan> seen(const BoardRoom& room, bool with_board, Looking looking, int count,
                              const PolarBins& bins, std::uint64_t seed, const Pose2& error = {}) {
  return views_from(turned_scans(room, with_board, looking, count, seed), room.node_m,
                    2.0 * kReach_m, bins, error);
}

}  // namespace

BoardRoom board_room() {
  const std::vector<Eigen::Vector2d> corners{{0.0, 0.0}, {3.1, -0.3}, {6.2, 0.2}, {6.0, 2.4},
                                             {6.6, 5.1}, {3.4, 4.8},  {0.4, 5.3}, {-0.3, 2.7}};
  BoardRoom room;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    room.walls.push_back({corners[i], corners[(i + 1) % corners.size()]});
  }
  room.node_m = {2.8, 2.4};
  room.board = {room.node_m + Eigen::Vector2d(1.0, -0.35),
                room.node_m + Eigen::Vector2d(1.0, 0.35)};
  return room;
}

std::vector<PosedScan> turned_scans(const BoardRoom& room, bool with_board, Looking looking,
                                    int count, std::uint64_t seed) {
  simulate::LaserConfig laser;
  laser.mount_x_m = 0.0;
  std::vector<simulate::Segment> changeable;
  if (with_board) changeable.push_back(room.board);
  RandomStream random(seed, StreamId::kTest, 91);
  std::vector<PosedScan> scans;
  for (int i = 0; i < count; ++i) {
    const Pose2 pose = drawn_pose(room, looking, random);
    simulate::TrueScan taken =
        simulate::take_scan(laser, pose, {room.walls, changeable, {}}, random);
    taken.scan.stamp = Stamp::from_seconds(i);
    scans.push_back({0, std::move(taken.scan), pose, {}});
  }
  return scans;
}

TwoStates board_states(const BoardRoom& room, const PolarBins& bins, std::uint64_t seed) {
  std::vector<VirtualScan> before = seen(room, false, Looking::kAnywhere, kViews, bins, seed);
  std::vector<VirtualScan> after = seen(room, true, Looking::kAnywhere, kViews, bins, seed + 1);
  // Which bins are the board's, by the views that show most of it; then all views again.
  TwoStates states = tell_apart(before, after, bins, kDifference_m);
  states.before = std::move(before);
  states.after = std::move(after);
  return states;
}

TwoStates wrong_pose_states(const BoardRoom& room, const PolarBins& bins, std::uint64_t seed) {
  return tell_apart(seen(room, true, Looking::kAnywhere, kViews, bins, seed),
                    seen(room, true, Looking::kAnywhere, kViews, bins, seed, kWrong), bins,
                    kDifference_m, true);
}

TurnedAway turn_away(const BoardRoom& room, const PolarBins& bins, std::uint64_t seed) {
  TurnedAway turned{board_states(room, bins, seed), {}, {}, {}};
  turned.whole = seen(room, true, Looking::kAtBoard, kViews, bins, seed + 2);
  turned.partly = seen(room, true, Looking::kPastHalfBoard, kViews, bins, seed + 3);
  for (const std::size_t bin : turned.states.bins) {
    const bool is_hidden =
        std::all_of(turned.partly.begin(), turned.partly.end(),
                    [bin](const VirtualScan& view) { return std::isnan(view[bin]); });
    if (is_hidden) turned.hidden.push_back(bin);
  }
  return turned;
}

CompletionResult complete_turned(const TurnedAway& turned, const NamedDecoder& decoder,
                                 const PlaceFigures& figures) {
  CompletionResult result;
  for (int i = 0; i < figures.seeds; ++i) {
    RandomStream random(figures.first_seed + static_cast<std::uint64_t>(i), StreamId::kTest);
    // Pairs leave on their own with every decoder, as in complete_half.
    NodeLevel level(figures.bins, figures.samples, false);
    for (int t = 0; t < 4 * figures.samples; ++t) {
      level.insert(draw(turned.states.before, random), random);
    }
    for (int t = 0; t < 5; ++t) level.insert(draw(turned.whole, random), random);
    for (int t = 0; t < 80; ++t) level.insert(draw(turned.partly, random), random);
    const std::vector<float> decoded = decoder.ranges(level);
    const bool is_complete =
        !turned.hidden.empty() && turned.states.share_after(decoded, turned.hidden) >= kWhole;
    result.complete += is_complete ? 1 : 0;
    if (i == 0) result.decoded_m = decoded;
  }
  return result;
}

}  // namespace strata::experiments
