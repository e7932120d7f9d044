// SPDX-License-Identifier: Apache-2.0
#include "memory/store/coded_visit.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/damage.hpp"
#include "core/random/stream.hpp"
#include "memory/store/visit_content.hpp"

namespace strata::memory {
namespace {

constexpr double kCell_m = 0.05;
constexpr double kWall_m = 4.0;
constexpr double kBox_m = 2.0;
const std::string kHash(64, 'a');

/// A room of 8 m by 8 m that was seen as a whole.
ReflectionGrid room() {
  constexpr int kHalf = 81;
  ReflectionGrid map = make_reflection_grid(kCell_m, {{-kHalf, -kHalf}, {kHalf, kHalf}});
  for (std::size_t i = 0; i < map.size(); ++i) {
    const Cell cell = map.cell(i);
    const bool is_wall =
        cell.x == -kHalf || cell.y == -kHalf || cell.x == kHalf - 1 || cell.y == kHalf - 1;
    map.values()[i] = is_wall ? 0.9F : 0.0F;
  }
  return map;
}

/// How far it is in that room, in which a wall stands at x = kBox_m from y = -1 to 1, or not.
double distance_m(const Pose2& pose, double bearing_rad, bool has_box) {
  const double c = std::cos(pose.theta + bearing_rad);
  const double s = std::sin(pose.theta + bearing_rad);
  double nearest_m = 100.0;
  const auto meet = [&](double from, double to, double along) {
    if (along != 0.0 && (to - from) / along > 0.0)
      nearest_m = std::min(nearest_m, (to - from) / along);
  };
  const double wall_m = kWall_m + 0.5 * kCell_m;
  meet(pose.x, c > 0 ? wall_m : -wall_m, c);
  meet(pose.y, s > 0 ? wall_m : -wall_m, s);
  if (has_box && c > 0.0) {
    const double to_box_m = (kBox_m - pose.x) / c;
    if (to_box_m > 0.0 && std::abs(pose.y + to_box_m * s) <= 1.0)
      nearest_m = std::min(nearest_m, to_box_m);
  }
  return nearest_m;
}

std::vector<PosedScan> drive(bool has_box, std::size_t count = 60) {
  RandomStream random(3, StreamId::kTest);
  std::vector<PosedScan> scans;
  for (std::size_t i = 0; i < count; ++i) {
    PosedScan& posed = scans.emplace_back();
    posed.run = 4;
    posed.map_from_robot = {-2.0 + 0.05 * static_cast<double>(i) + 0.001 * random.normal(),
                            0.3 * random.normal(), 0.1 * random.normal()};
    posed.scan.stamp = {1'700'000'000'123'456'789 + static_cast<std::int64_t>(i) * 503'000'001};
    posed.scan.angle_min_rad = -3.0F;
    posed.scan.angle_increment_rad = 0.0174F;
    posed.scan.scan_time_s = 0.1F + 1e-4F * static_cast<float>(random.normal());
    posed.scan.range_min_m = 0.1F;
    posed.scan.range_max_m = 30.0F;
    posed.scan.ranges_m.resize(340);
    for (std::size_t b = 0; b < posed.scan.size(); ++b) {
      posed.scan.ranges_m[b] =
          static_cast<float>(distance_m(posed.map_from_robot, posed.scan.bearing_rad(b), has_box) +
                             0.01 * random.normal());
    }
    posed.scan.ranges_m[5] = std::numeric_limits<float>::quiet_NaN();
    posed.scan.ranges_m[6] = std::numeric_limits<float>::infinity();
    posed.scan.ranges_m[7] = 0.05F;
  }
  return scans;
}

CodedVisit coded(const std::vector<PosedScan>& scans, double tolerance_m = kCell_m) {
  auto result = code_visit(scans, room(), kHash, tolerance_m);
  EXPECT_TRUE(result.has_value());
  return result ? *result : CodedVisit{};
}

TEST(CodedVisit, IsReadAsWhoWroteItSays) {
  for (const bool has_box : {false, true}) {
    const CodedVisit visit = coded(drive(has_box));
    EXPECT_EQ(map_of_coded_visit(visit.bytes, "visit"), kHash);
    const auto read = scans_of_coded_visit(visit.bytes, room(), 4, "visit");
    EXPECT_EQ(visit_content(read), visit_content(visit.scans));
    ASSERT_FALSE(read.empty());
    EXPECT_EQ(read.front().run, 4);
  }
}

TEST(CodedVisit, KeepsPosesStampsKindsAndRangesWithinWhatIsStated) {
  const auto sent = drive(true);
  const auto read = scans_of_coded_visit(coded(sent).bytes, room(), 0, "visit");
  ASSERT_EQ(read.size(), sent.size());
  EXPECT_EQ(read.front().scan.stamp, sent.front().scan.stamp);
  std::size_t off = 0;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    SCOPED_TRACE(i);
    EXPECT_NEAR(read[i].map_from_robot.x, sent[i].map_from_robot.x, 0.00501);
    EXPECT_NEAR(read[i].map_from_robot.y, sent[i].map_from_robot.y, 0.00501);
    EXPECT_NEAR(read[i].map_from_robot.theta, sent[i].map_from_robot.theta, 0.00077);
    EXPECT_NEAR((read[i].scan.stamp - sent[i].scan.stamp).seconds(), 0.0, 0.00501);
    EXPECT_NEAR(read[i].scan.scan_time_s, sent[i].scan.scan_time_s, 0.02);
    ASSERT_EQ(read[i].scan.size(), sent[i].scan.size());
    for (std::size_t b = 0; b < sent[i].scan.size(); ++b) {
      ASSERT_EQ(read[i].scan.kind(b), sent[i].scan.kind(b)) << b;
      if (sent[i].scan.kind(b) != BeamKind::kHit) continue;
      const double error_m =
          std::abs(static_cast<double>(read[i].scan.ranges_m[b] - sent[i].scan.ranges_m[b]));
      EXPECT_LE(error_m, 0.36) << b;
      if (error_m > 0.06) ++off;
    }
  }
  // Beams that graze a wall may end elsewhere on it.
  EXPECT_LT(off, sent.size() * 340 / 20);
}

/// A wall that the map does not have is told where it stands, and one that is gone is gone.
TEST(CodedVisit, TellsWhatIsNewAndWhatIsGone) {
  for (const bool has_box : {false, true}) {
    const auto sent = drive(has_box);
    ReflectionGrid map = room();
    if (!has_box) {  // the map has it, and the visit does not
      for (int y = -20; y <= 20; ++y) map.at({static_cast<int>(kBox_m / kCell_m), y}) = 0.9F;
    }
    const auto visit = code_visit(sent, map, kHash, kCell_m);
    ASSERT_TRUE(visit.has_value());
    std::size_t through = 0;
    std::size_t right = 0;
    for (std::size_t i = 0; i < sent.size(); ++i) {
      for (std::size_t b = 0; b < sent[i].scan.size(); ++b) {
        const double with_m = distance_m(sent[i].map_from_robot, sent[i].scan.bearing_rad(b), true);
        const double without_m =
            distance_m(sent[i].map_from_robot, sent[i].scan.bearing_rad(b), false);
        if (without_m - with_m < 0.5 || sent[i].scan.kind(b) != BeamKind::kHit) continue;
        ++through;
        const double read_m = static_cast<double>(visit->scans[i].scan.ranges_m[b]);
        if (std::abs(read_m - (has_box ? with_m : without_m)) < 0.15) ++right;
      }
    }
    EXPECT_GT(through, 1000U);
    EXPECT_GT(static_cast<double>(right), 0.99 * static_cast<double>(through)) << has_box;
  }
}

TEST(CodedVisit, IsATenthOfTheVisitByItself) {
  const auto sent = drive(false);
  const std::size_t by_itself = pack_visit(visit_content(sent)).size();
  EXPECT_LT(10 * coded(sent).bytes.size(), by_itself);
  EXPECT_LT(5 * coded(drive(true)).bytes.size(), by_itself) << "though a wall is new";
}

TEST(CodedVisit, KeepsTheOrderOfStampsThatAreClose) {
  auto sent = drive(false, 20);
  for (std::size_t i = 0; i < sent.size(); ++i)
    sent[i].scan.stamp.ns = static_cast<std::int64_t>(1000 + 30'000'000 * (i / 2) + 3 * (i % 2));
  const CodedVisit visit = coded(sent);
  for (std::size_t i = 1; i < sent.size(); ++i) {
    EXPECT_LT(visit.scans[i - 1].scan.stamp, visit.scans[i].scan.stamp);
    EXPECT_NEAR((visit.scans[i].scan.stamp - sent[i].scan.stamp).seconds(), 0.0, 0.0151);
  }
}

TEST(CodedVisit, IsNoneOfScansThatComeFasterThanItsTicks) {
  auto sent = drive(false, 20);
  for (std::size_t i = 0; i < sent.size(); ++i)
    sent[i].scan.stamp.ns = static_cast<std::int64_t>(1000 + 5'000'000 * i);
  EXPECT_FALSE(code_visit(sent, room(), kHash, kCell_m));
}

TEST(CodedVisit, IsNoneOfScansThatCannotBeToldSo) {
  EXPECT_FALSE(code_visit({}, room(), kHash, kCell_m));
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), 2e6}) {
    auto sent = drive(false, 3);
    sent[1].map_from_robot.x = x;
    EXPECT_FALSE(code_visit(sent, room(), kHash, kCell_m));
  }
  EXPECT_FALSE(code_visit(drive(false, 3), room(), "abc", kCell_m));
  auto sent = drive(false, 3);
  sent[2].scan.ranges_m.assign((1U << 16U) + 1, 1.0F);
  EXPECT_FALSE(code_visit(sent, room(), kHash, kCell_m));
}

TEST(CodedVisit, ThatIsCutOffIsRefused) {
  const auto bytes = coded(drive(true, 10)).bytes;
  for (std::size_t size = 0; size + 8 < bytes.size(); size += 7) {
    EXPECT_THROW((void)scans_of_coded_visit(std::span(bytes).first(size), room(), 0, "visit"),
                 DamageError);
  }
  EXPECT_THROW((void)map_of_coded_visit(std::span(bytes).first(31), "visit"), DamageError);
}

/// A room that was not seen as a whole, with a column that is seldom hit and a wall that is gone.
ReflectionGrid example_map() {
  ReflectionGrid map = room();
  for (int i = -30; i <= 30; ++i) map.at({-60, i}) = 0.7F;
  for (int x = 20; x < 24; ++x) {
    for (int y = 40; y < 44; ++y) map.at({x, y}) = 0.3F;
  }
  for (int x = 50; x < 81; ++x) {
    for (int y = 50; y < 81; ++y) map.at({x, y}) = kUnknownReflection;
  }
  return map;
}

std::vector<std::byte> example(const std::string& name) {
  std::ifstream in(std::string(STRATA_STORE_EXAMPLES "/") + name, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto view = std::as_bytes(std::span(bytes));
  return {view.begin(), view.end()};
}

/// Visits stay on servers for ever. `examples/` keeps one of two lasers with a wall that is new,
/// and what is read of it, as a visit by itself.
TEST(CodedVisit, OfFormat2IsReadForEver) {
  const auto coded = example("visit_of_format_2");
  const auto content = unpack_visit(example("visit_of_format_2.by_itself"), "example");
  EXPECT_EQ(map_of_coded_visit(coded, "example"), kHash);
  const auto read = scans_of_coded_visit(coded, example_map(), 0, "example");
  EXPECT_EQ(read.size(), 30U);
  EXPECT_EQ(visit_content(read), content);
}

/// Four billion scans in a few bytes.
TEST(CodedVisit, ThatAsksForAllMemoryIsRefused) {
  std::vector<std::byte> bytes(32 + 4, std::byte{0});
  bytes.resize(32 + 4000, std::byte{0xAA});
  EXPECT_THROW((void)scans_of_coded_visit(bytes, room(), 0, "visit"), DamageError);
}

/// A robot that stands for days where all is as expected: its beams take next to no bytes.
TEST(CodedVisit, OfFewBytesHasNotEndlesslyManyBeams) {
  const Scan wide = [] {
    Scan scan = drive(false, 1).front().scan;
    scan.angle_increment_rad = 1e-4F;
    scan.range_max_m = 1.0F;
    scan.ranges_m.assign(60'000, std::numeric_limits<float>::infinity());
    return scan;
  }();
  const auto stands = [&](std::size_t count) {
    std::vector<PosedScan> scans(count);
    for (std::size_t i = 0; i < count; ++i) {
      scans[i].scan = wide;
      scans[i].scan.stamp.ns = static_cast<std::int64_t>(i) * 1'000'000'000;
    }
    return code_visit(scans, make_reflection_grid(kCell_m, {{0, 0}, {9, 9}}), kHash, kCell_m);
  };
  EXPECT_TRUE(stands(4));
  EXPECT_FALSE(stands(60));
}

}  // namespace
}  // namespace strata::memory
