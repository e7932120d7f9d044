// SPDX-License-Identifier: Apache-2.0
#include "memory/store/visit_content.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/damage.hpp"
#include "core/random/stream.hpp"
#include "tests/support/same_scan.hpp"

namespace strata::memory {
namespace {

enum class Ranges { kFloats, kCentimetres, kMillimetres };

/// A drive along a wall; some beams saw nothing.
std::vector<PosedScan> visit(Ranges kind, std::size_t count = 300) {
  RandomStream random(5, StreamId::kTest);
  std::vector<PosedScan> scans;
  for (std::size_t i = 0; i < count; ++i) {
    PosedScan& posed = scans.emplace_back();
    posed.run = 7;
    posed.map_from_robot = {0.1 * random.normal(), 0.05 * static_cast<double>(i), 0.3};
    posed.scan.stamp = {1'700'000'000'000'000'000 + static_cast<std::int64_t>(i) * 100'000'001};
    posed.scan.robot_from_laser = {0.1, -0.0, 0.01};
    posed.scan.angle_min_rad = -1.5F;
    posed.scan.angle_increment_rad = 0.01F;
    posed.scan.time_increment_s = 1e-5F;
    posed.scan.scan_time_s = 0.1F;
    posed.scan.range_min_m = 0.05F;
    posed.scan.range_max_m = 60.0F;
    posed.scan.ranges_m.resize(i % 50 == 7 ? 0 : 181);
    for (float& range_m : posed.scan.ranges_m) {
      const double true_m = 8.0 + 0.02 * random.normal();
      if (kind == Ranges::kFloats) range_m = static_cast<float>(true_m);
      if (kind == Ranges::kCentimetres) {
        range_m = static_cast<float>(std::round(100 * true_m) / 100);
      }
      if (kind == Ranges::kMillimetres) {
        range_m = static_cast<float>(std::round(1000 * true_m) / 1000);
      }
    }
    if (posed.scan.ranges_m.size() > 3) {
      posed.scan.ranges_m[0] = std::numeric_limits<float>::quiet_NaN();
      posed.scan.ranges_m[1] = std::numeric_limits<float>::infinity();
      posed.scan.ranges_m[2] = -std::numeric_limits<float>::infinity();
    }
    posed.static_probability.assign(posed.scan.size(), 0.5F);
  }
  return scans;
}

class EveryKindOfRange : public testing::TestWithParam<Ranges> {};
INSTANTIATE_TEST_SUITE_P(VisitContent, EveryKindOfRange,
                         testing::Values(Ranges::kFloats, Ranges::kCentimetres,
                                         Ranges::kMillimetres));

TEST_P(EveryKindOfRange, ComesBackBitForBitButForTheLabels) {
  const std::vector<PosedScan> sent = visit(GetParam());
  const auto packed = pack_visit(visit_content(sent));
  const std::vector<PosedScan> come = scans_of_visit(unpack_visit(packed, "visit"), 3, "visit");
  ASSERT_EQ(come.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    SCOPED_TRACE(i);
    test::expect_same_scan(sent[i].scan, come[i].scan);
    EXPECT_EQ(sent[i].map_from_robot, come[i].map_from_robot);
    EXPECT_EQ(come[i].run, 3);
    EXPECT_TRUE(come[i].static_probability.empty());
  }
}

TEST(VisitContent, DependsOnNeitherLabelsNorTheNumberOfTheRun) {
  const std::vector<PosedScan> before = visit(Ranges::kCentimetres);
  std::vector<PosedScan> after = before;
  for (PosedScan& posed : after) {
    posed.run = 2;
    posed.static_probability.clear();
  }
  EXPECT_EQ(visit_content(before), visit_content(after));
  after.back().map_from_robot.x += 1e-9;
  EXPECT_NE(visit_content(before), visit_content(after));
}

TEST(VisitContent, OfRangesInWholeCentimetresIsAQuarterOfTheirBits) {
  const auto centimetres = pack_visit(visit_content(visit(Ranges::kCentimetres)));
  const auto floats = pack_visit(visit_content(visit(Ranges::kFloats)));
  EXPECT_LT(4 * centimetres.size(), 300 * 181 * sizeof(float));
  EXPECT_LT(2 * centimetres.size(), floats.size());
}

TEST(VisitContent, ThatIsDamagedIsRefused) {
  const auto content = visit_content(visit(Ranges::kMillimetres, 20));
  for (std::size_t size = 0; size < content.size(); size += size < 200 ? 1 : 97) {
    EXPECT_THROW((void)scans_of_visit(std::span(content).first(size), 0, "visit"), DamageError);
  }
  auto longer = content;
  longer.push_back(std::byte{0});
  EXPECT_THROW((void)scans_of_visit(longer, 0, "visit"), DamageError);
  auto packed = pack_visit(content);
  packed[packed.size() / 2] ^= std::byte{0x10};
  EXPECT_THROW((void)unpack_visit(packed, "visit"), DamageError);
  EXPECT_THROW((void)unpack_visit({}, "visit"), DamageError);
}

TEST(VisitContent, WithWhatNoLearnerCouldUseIsRefused) {
  constexpr std::size_t kScans = 20;
  std::vector<PosedScan> scans = visit(Ranges::kMillimetres, kScans);
  auto content = visit_content(scans);
  EXPECT_NO_THROW((void)scans_of_visit(content, 0, "visit"));
  // The lowest byte of the steps a metre of one scan: headers lie in planes of their bytes.
  constexpr std::size_t kStepsAt = 84;
  content[sizeof(std::uint32_t) + kStepsAt * kScans + 3] ^= std::byte{1};
  EXPECT_THROW((void)scans_of_visit(content, 0, "visit"), DamageError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (double Pose2::*part : {&Pose2::x, &Pose2::y, &Pose2::theta}) {
    scans = visit(Ranges::kMillimetres, kScans);
    scans[3].map_from_robot.*part = nan;
    EXPECT_THROW((void)scans_of_visit(visit_content(scans), 0, "visit"), DamageError);
    scans = visit(Ranges::kMillimetres, kScans);
    scans[3].scan.robot_from_laser.*part = nan;
    EXPECT_THROW((void)scans_of_visit(visit_content(scans), 0, "visit"), DamageError);
  }
}

/// A frame that says it unpacks to 16 GB: the first bytes of a zstd frame with an 8-byte size.
TEST(VisitContent, ThatAsksForAllMemoryIsRefused) {
  std::vector<std::byte> frame{std::byte{0x28}, std::byte{0xB5}, std::byte{0x2F}, std::byte{0xFD},
                               std::byte{0xE0}};
  const std::uint64_t stated = 1ULL << 34U;
  frame.resize(5 + sizeof(stated) + 16);
  std::memcpy(frame.data() + 5, &stated, sizeof(stated));
  EXPECT_THROW((void)unpack_visit(frame, "visit"), DamageError);
}

}  // namespace
}  // namespace strata::memory
