// SPDX-License-Identifier: Apache-2.0
#include "core/base/damage.hpp"

#include <fstream>
#include <functional>
#include <new>
#include <optional>
#include <string>
#include <typeinfo>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "memory/store/store.hpp"
#include "tests/support/test_data.hpp"

namespace strata::memory {
namespace {

using testing::HasSubstr;

/// A store with one large grid, in a folder of its own.
class StoreFile : public testing::Test {
 protected:
  void SetUp() override {
    ReflectionGrid grid = make_reflection_grid(0.05, {{0, 0}, {200, 200}});
    float value = 0.0F;
    for (float& cell : grid.values()) cell = value = value * 1.618034F + 0.31F - std::floor(value);
    Store store(path());
    store.save_grid("map", grid);
    store.save_text("key", "value");
  }
  [[nodiscard]] std::filesystem::path path() const { return directory_.path() / "strata.db"; }

  void run_sql(const char* sql) const {
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(path().c_str(), &handle), SQLITE_OK);
    ASSERT_EQ(sqlite3_exec(handle, sql, nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(handle);
  }
  [[nodiscard]] std::string read_file() const { return test::bytes_of(path()); }
  void write_file(const std::string& bytes) const {
    std::ofstream(path(), std::ios::binary | std::ios::trunc) << bytes;
  }

 private:
  test::TemporaryDirectory directory_;
};

template <typename E>
std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const E& error) {
    EXPECT_FALSE(error.remedy().empty());
    return error.what();
  }
  return "no error";
}

TEST_F(StoreFile, OfANewerVersionIsRefusedWithARemedy) {
  run_sql("PRAGMA user_version = 99");
  for (const bool read_only : {true, false}) {
    const std::string message =
        error_of<InputError>([&] { const Store store(path(), {.read_only = read_only}); });
    EXPECT_THAT(message, HasSubstr("newer"));
    EXPECT_THAT(message, HasSubstr("99"));
    EXPECT_THAT(message, HasSubstr("update Strata"));
  }
}

/// At every amount of memory that SQLite may have a whole store is read, or memory ran out: it is
/// never called damaged, nor is its disk to be looked at.
TEST_F(StoreFile, ThatThereIsNoMemoryToReadIsNotCalledDamaged) {
  std::size_t refused = 0;
  std::size_t opened = 0;
  for (sqlite3_int64 more = 20'000; more < 6'000'000; more += more / 16) {
    sqlite3_hard_heap_limit64(sqlite3_memory_used() + more);
    try {
      const Store store(path(), {.read_only = true});
      ++opened;
    } catch (const std::bad_alloc&) {
      ++refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << more << " bytes: " << error.what();
    }
    sqlite3_hard_heap_limit64(0);
  }
  EXPECT_GT(refused, 10U);
  EXPECT_GT(opened, 10U);
}

TEST_F(StoreFile, ThatIsAnotherKindOfDatabaseIsRefused) {
  run_sql("PRAGMA application_id = 1");
  EXPECT_THAT(error_of<InputError>([&] { const Store store(path()); }),
              HasSubstr("not a Strata store"));
}

/// A bit that flips in a blob is nothing to SQLite.
TEST_F(StoreFile, WithAFlippedBitInAScanOrAMovedPoseIsFound) {
  std::vector<PosedScan> scans(30);
  std::vector<TrajectoryPose> poses;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    scans[i].scan.stamp = {static_cast<std::int64_t>(i) * 100'000'000};
    scans[i].map_from_robot = {0.1 * static_cast<double>(i), 0.0, 0.0};
    scans[i].scan.ranges_m.assign(100, 1.0F + 0.01F * static_cast<float>(i));
    poses.push_back({scans[i].scan.stamp, scans[i].map_from_robot, std::nullopt});
  }
  {
    Store store(path());
    store.save_scans(0, scans);
    store.save_trajectory(0, poses);
    store.check_contents();
  }
  const std::string whole = read_file();
  const auto damaged = [&] {
    return error_of<DamageError>([&] { Store(path(), {.read_only = true}).check_contents(); });
  };
  run_sql(
      "UPDATE scan_chunk SET data = CAST(substr(data, 1, length(data) - 9) || x'00' || "
      "substr(data, length(data) - 7) AS BLOB)");
  EXPECT_THAT(damaged(), HasSubstr("scans of run 0"));
  write_file(whole);
  run_sql("UPDATE pose SET x_m = x_m + 1e-9 WHERE place = 7");
  EXPECT_THAT(damaged(), HasSubstr("trajectory of run 0"));
  write_file(whole);
  run_sql(
      "UPDATE grid SET data = CAST(substr(data, 1, length(data) - 99) || x'00' || "
      "substr(data, length(data) - 97) AS BLOB)");
  EXPECT_THAT(damaged(), HasSubstr("grid map"));
}

template <typename E>
bool throws_exactly(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return typeid(error) == typeid(E);
  }
  return false;
}

TEST_F(StoreFile, OfOursThatIsDamagedIsToldFromOneOfSomebodyElse) {
  const std::string whole = read_file();
  const auto open = [this] { const Store store(path()); };
  std::string broken = whole;
  broken[21] = 1;  // in the header, where 64 must be
  for (const std::string& ours :
       {whole.substr(0, whole.size() / 2), std::string(8192, '\0'), whole.substr(0, 50), broken}) {
    write_file(ours);
    EXPECT_TRUE(throws_exactly<DamageError>(open)) << ours.size();
  }
  write_file(
      "P5 10 10 255 this is a picture and no database at all, is it, and so large that it "
      "has the bytes of a header and some more");
  EXPECT_TRUE(throws_exactly<UnknownContentError>(open));
  write_file(whole);
  run_sql("PRAGMA application_id = 1");
  EXPECT_TRUE(throws_exactly<InputError>(open));
  run_sql(("PRAGMA application_id = " + std::to_string(0x53747261)).c_str());
  run_sql("PRAGMA user_version = 99");
  EXPECT_TRUE(throws_exactly<InputError>(open));
}

TEST_F(StoreFile, WithAPatchMapThatDoesNotFitTogetherIsDamaged) {
  patch::Submap submap;
  submap.rect = {{0, 0}, {3, 2}};
  submap.contradictory = Grid<std::uint8_t>(0.05, submap.rect, 1);
  submap.configurations.push_back(
      {Grid<CellCounts>(0.05, submap.rect), make_reflection_grid(0.05, submap.rect), 1.0});
  submap.sequences.push_back({0, {}, {}, 4, {1.0}});
  patch::PatchMap map{make_reflection_grid(0.05, submap.rect), {submap}};
  const auto load = [&](const std::string& sql) {
    {
      Store store(path());
      store.save_patch_map(map);
    }
    run_sql(sql.c_str());
    (void)Store(path()).load_patch_map();
  };
  EXPECT_NO_THROW(load(""));
  for (const std::string sql : {"UPDATE submap SET max_x = 4", "DELETE FROM configuration",
                                "INSERT INTO membership SELECT map, submap, sequence, 1, 0.5 FROM "
                                "membership"}) {
    EXPECT_TRUE(throws_exactly<DamageError>([&] { load(sql); })) << sql;
  }
  EXPECT_TRUE(throws_exactly<DamageError>(
      [&] { load("UPDATE grid SET resolution_m = 0 WHERE name LIKE 'patch%'"); }));
}

TEST_F(StoreFile, ThatIsNoDatabaseIsRefused) {
  write_file("P5 10 10 255 this is a picture and no database at all, is it");
  EXPECT_THAT(error_of<InputError>([&] { const Store store(path(), {.read_only = true}); }),
              HasSubstr("strata.db"));
}

TEST_F(StoreFile, ThatIsTruncatedIsRefused) {
  const std::string bytes = read_file();
  write_file(bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT(error_of<InputError>([&] { const Store store(path(), {.read_only = true}); }),
              HasSubstr("damaged"));
}

TEST_F(StoreFile, WithAFlippedBitInAGridIsFoundWhenReading) {
  std::string bytes = read_file();
  // Somewhere in the middle of the overflow pages, which hold the compressed cells.
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  write_file(bytes);
  EXPECT_THAT(error_of<InputError>([&] {
                const Store store(path(), {.read_only = true});
                (void)store.load_reflection_grid("map");
              }),
              HasSubstr("damaged"));
}

TEST_F(StoreFile, ThatIsMissingIsNotCreatedByAReader) {
  std::filesystem::remove(path());
  EXPECT_THAT(error_of<InputError>([&] { const Store store(path(), {.read_only = true}); }),
              HasSubstr("no such file"));
  EXPECT_FALSE(std::filesystem::exists(path()));
}

TEST_F(StoreFile, OpenedForReadingRefusesToSave) {
  Store store(path(), {.read_only = true});
  EXPECT_THAT(error_of<OutputError>([&] { store.save_text("a", "b"); }), HasSubstr("reading only"));
}

TEST_F(StoreFile, LockedByAnotherProgramSaysSo) {
  Store other(path());
  Store store(path(), {.busy_timeout_ms = 1});
  other.transaction([&] {
    EXPECT_THAT(error_of<OutputError>([&] { store.save_text("a", "b"); }),
                HasSubstr("another program"));
  });
}

TEST_F(StoreFile, NamesWhatItDoesNotHave) {
  const Store store(path(), {.read_only = true});
  EXPECT_THAT(error_of<InputError>([&] { (void)store.load_reflection_grid("other"); }),
              HasSubstr("no grid 'other'"));
  EXPECT_THAT(error_of<InputError>([&] { (void)store.load_counts_grid("map"); }),
              HasSubstr("it is a reflection grid"));
  EXPECT_THAT(error_of<InputError>([&] { (void)store.load_patch_map(); }),
              HasSubstr("no patch map"));
}

TEST(Store, CannotBeMadeInAFolderThatIsNotThere) {
  const test::TemporaryDirectory directory;
  EXPECT_THAT(error_of<OutputError>([&] { const Store store(directory.path() / "no" / "a.db"); }),
              HasSubstr("a.db"));
}

}  // namespace
}  // namespace strata::memory
