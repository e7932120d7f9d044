// SPDX-License-Identifier: Apache-2.0
/// Seeded damage: whatever the bytes, a reader answers with scans or with an Error.
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "components/log/carmen.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "components/log/map_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/error.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : state_(seed * 2 + 1) {}
  std::size_t below(std::size_t limit) {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<std::size_t>((state_ >> 33) % limit);
  }
  std::string damage(std::string bytes) {
    const std::size_t times = 1 + below(4);
    for (std::size_t i = 0; i < times && !bytes.empty(); ++i) {
      const std::size_t at = below(bytes.size());
      switch (below(5)) {
        case 0:
          bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
          break;
        case 1:
          bytes[at] = static_cast<char>(below(256));
          break;
        case 2:
          bytes.resize(at);
          break;
        case 3:
          bytes.erase(at, 1 + below(16));
          break;
        default:
          bytes.insert(at, std::string(1 + below(8), static_cast<char>(below(256))));
      }
    }
    return bytes;
  }

 private:
  std::uint64_t state_;
};

/// Returns how many of the damaged files were still read.
int read_damaged(const fs::path& file, int times,
                 const std::function<void(const fs::path&)>& read) {
  const std::string original = test::bytes_of(file);
  int good = 0;
  for (int i = 0; i < times; ++i) {
    test_log::write_text(file, Mutator(static_cast<std::uint64_t>(i)).damage(original));
    try {
      read(file);
      ++good;
    } catch (const Error& error) {
      EXPECT_FALSE(error.place().empty());
      EXPECT_FALSE(error.remedy().empty());
    }
  }
  return good;
}

void read_and_check(const fs::path& file) {
  for (const Observation& observation : read_observations(file)) {
    ASSERT_TRUE(is_finite(observation.odom_from_robot));
    ASSERT_TRUE(is_finite(observation.scan.robot_from_laser));
    ASSERT_GT(observation.scan.size(), 0U);
  }
}

TEST(Fuzz, DamagedCarmenLogsGiveScansOrErrors) {
  const strata::test::TemporaryDirectory folder;
  write_carmen(folder.path() / "f.clf", test_log::make_log(6, 12, 1));
  EXPECT_GT(read_damaged(folder.path() / "f.clf", 500, read_and_check), 250);
}

TEST(Fuzz, DamagedMcapFilesGiveScansOrErrors) {
  const strata::test::TemporaryDirectory folder;
  for (const auto compression :
       {BagCompression::kNone, BagCompression::kZstd, BagCompression::kLz4}) {
    const fs::path bag = folder.path() / ("bag" + std::to_string(static_cast<int>(compression)));
    write_bag(bag, test_log::make_log(6, 12, 1), BagStorage::kMcap, compression);
    const fs::path file = bag / (bag.filename().string() + "_0.mcap");
    EXPECT_GT(read_damaged(file, 300, read_and_check), 10);
  }
}

TEST(Fuzz, DamagedDatabasesGiveScansOrErrors) {
  const strata::test::TemporaryDirectory folder;
  write_bag(folder.path() / "bag", test_log::make_log(6, 12, 1), BagStorage::kSqlite3);
  EXPECT_GT(read_damaged(folder.path() / "bag" / "bag_0.db3", 300, read_and_check), 50);
}

TEST(Fuzz, DamagedRos1BagsGiveScansOrErrors) {
  const strata::test::TemporaryDirectory folder;
  write_bag(folder.path() / "ros2", test_log::make_log(6, 12, 1), BagStorage::kSqlite3);
  for (const char* compression : {"none", "bz2", "lz4"}) {
    for (const auto end : {test_log::Ros1End::kWhole, test_log::Ros1End::kUnfinishedChunk}) {
      const fs::path file = folder.path() / "f.bag";
      test_log::write_text(file, test_log::ros1_bag_of(folder.path() / "ros2",
                                                       {.compression = compression, .end = end}));
      EXPECT_GT(read_damaged(file, 300, read_and_check), 10) << compression;
    }
  }
}

TEST(Fuzz, DamagedMapsAndTrajectoriesGiveValuesOrErrors) {
  const strata::test::TemporaryDirectory folder;
  ReflectionGrid grid = make_reflection_grid(0.1, {{0, 0}, {6, 5}});
  for (float& value : grid.values()) value = 1.0F;
  write_map(folder.path() / "m.yaml", grid);
  const fs::path yaml = folder.path() / "m.yaml";
  const auto read = [&](const fs::path&) { (void)read_map(yaml); };
  EXPECT_GT(read_damaged(folder.path() / "m.pgm", 300, read), 10);
  write_map(yaml, grid);
  EXPECT_GT(read_damaged(yaml, 300, read), 10);
  const fs::path tum = folder.path() / "t.tum";
  write_trajectory(tum, std::vector<StampedPose>{{{1}, {1, 2, 3}}, {{2'000'000'000}, {4, 5, 6}}});
  EXPECT_GT(read_damaged(tum, 300, [](const fs::path& path) { (void)read_trajectory(path); }), 10);
}

}  // namespace
}  // namespace strata::log
