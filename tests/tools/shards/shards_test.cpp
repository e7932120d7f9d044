// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"
#include "tools/shards/fingerprint.hpp"
#include "tools/shards/shard.hpp"
#include "tools/shards/shard_folder.hpp"
#include "tools/shards/units.hpp"

namespace strata::shards {
namespace {

using testing::HasSubstr;

/// What an error says, whole.
template <typename Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Shard, IsReadAndRefusedByItsText) {
  EXPECT_EQ(parse_shard("3/8"), (Shard{3, 8}));
  EXPECT_EQ(label({3, 8}), "3/8");
  for (const char* text :
       {"", "3", "3/", "/8", "a/8", "3/8x", "0/8", "9/8", "1/0", "-1/8", "1/100001"}) {
    EXPECT_THROW(static_cast<void>(parse_shard(text)), InputError) << text;
  }
}

TEST(Shard, OwnsNeighboursOfAboutEqualWeight) {
  const std::vector<double> weights{10, 1, 1, 1, 1, 1, 10, 1, 1, 1, 1, 1};
  for (const int shards : {1, 2, 3, 5, 40}) {
    const std::vector<int> owner = owners(weights, shards);
    ASSERT_EQ(owner.size(), weights.size());
    EXPECT_TRUE(std::is_sorted(owner.begin(), owner.end()));
    EXPECT_GE(owner.front(), 1);
    EXPECT_LE(owner.back(), shards);
    std::vector<double> sums(static_cast<std::size_t>(shards) + 1, 0.0);
    for (std::size_t i = 0; i < owner.size(); ++i)
      sums[static_cast<std::size_t>(owner[i])] += weights[i];
    // No more than a fair part and the heaviest unit.
    for (const double sum : sums) EXPECT_LE(sum, 30.0 / shards + 10.0);
  }
  EXPECT_EQ(owners(weights, 2)[5], 1);
  EXPECT_EQ(owners(weights, 2)[6], 2);
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
}

TEST(Fingerprint, IsOfTheContentWhereverItLies) {
  const test::TemporaryDirectory dir;
  for (const char* bag : {"one", "two", "other"}) {
    std::filesystem::create_directories(dir.path() / bag);
    write_text(dir.path() / bag / "a.db3", "scans");
    write_text(dir.path() / bag / "metadata.yaml", bag == std::string("other") ? "x" : "y");
  }
  const auto of = [&](const char* name) { return fingerprint(dir.path() / name); };
  // sha256sum of the file.
  EXPECT_EQ(of("one/a.db3"), "5982f892947ea523f3a9473a5af9ded238c1204127e1e595e845e7555ba6c99c");
  EXPECT_EQ(of("one"), of("two"));
  EXPECT_NE(of("one"), of("other"));
  EXPECT_THROW(static_cast<void>(of("none")), InputError);
}

/// Shards of one job, in folders of their own.
class ShardFolders : public testing::Test {
 protected:
  std::string write(const std::string& name, const Shard& shard, const std::string& settings = "a",
                    std::map<std::string, std::string> inputs = {{"log", "1"}}) {
    ShardInfo info = shard_info("a test", shard, "1.0");
    info.same["settings"] = settings;
    info.inputs = std::move(inputs);
    std::filesystem::create_directories(dir_.path() / name);
    write_shard(info, log::Bytes{1, 2, 3}, dir_.path() / name);
    return (dir_.path() / name).string();
  }
  static std::vector<ShardFolder> read(const std::vector<std::string>& folders) {
    return read_all_shards(folders, "a test", "1.0");
  }
  test::TemporaryDirectory dir_;
};

TEST_F(ShardFolders, AreReadInTheirOrderWhateverTheirNames) {
  const auto shards = read({write("x", {3, 3}), write("y", {1, 3}), write("z", {2, 3})});
  ASSERT_EQ(shards.size(), 3U);
  EXPECT_EQ(shards[0].path.filename(), "y");
  EXPECT_EQ(shards[2].path.filename(), "x");
  EXPECT_EQ(read_shard_results(shards[0].path), (log::Bytes{1, 2, 3}));
}

TEST_F(ShardFolders, ThatAreLostAreNamed) {
  const std::vector<std::string> some{write("a", {1, 5}), write("b", {3, 5})};
  EXPECT_THAT(error_of([&] { (void)read(some); }),
              HasSubstr("has no shard 2/5, 4/5, 5/5; run the same"));
}

TEST_F(ShardFolders, OfOtherSettingsInputsAndProgramsAreRefused) {
  const std::string one = write("a", {1, 2});
  const auto refused = [&](const std::string& other) {
    return error_of([&] { (void)read({one, other}); });
  };
  EXPECT_THAT(refused(write("b", {2, 2}, "b")), HasSubstr("its settings differs"));
  EXPECT_THAT(refused(write("c", {2, 2}, "a", {{"log", "2"}})), HasSubstr("its log differs"));
  EXPECT_THAT(refused(write("d", {2, 3})), HasSubstr("its number of shards differs"));
  EXPECT_THAT(refused(write("e", {1, 2})), HasSubstr("is shard 1/2 as is"));
  EXPECT_EQ(refused(write("f", {2, 2}, "a", {{"log of another", "2"}})), "no error");
  const std::string good = write("g", {2, 2});
  EXPECT_THAT(error_of([&] {
                (void)read_all_shards(std::vector{one, good}, "a test", "1.1");
              }),
              HasSubstr("was made by another version"));
  EXPECT_THAT(error_of([&] {
                (void)read_all_shards(std::vector{one, good}, "another", "1.0");
              }),
              HasSubstr("is a shard of a test"));
  EXPECT_THAT(error_of([&] {
                (void)read({one, (dir_.path() / "nowhere").string()});
              }),
              HasSubstr("holds no shard"));
}

TEST_F(ShardFolders, ThatAreDamagedSayWhichToRunAgain) {
  const std::string folder = write("a", {2, 4});
  write_text(std::filesystem::path(folder) / kShardResults, "nothing");
  EXPECT_THAT(error_of([&] { static_cast<void>(read_shard_results(folder)); }),
              HasSubstr("again with --shard 2/4"));
  write_text(std::filesystem::path(folder) / kShardFile, "{");
  EXPECT_THROW(static_cast<void>(read_shard_info(folder)), DamageError);
}

double sum_of(Units& units) {
  double sum = 0.0;
  for (int i = 0; i < 10; ++i) {
    sum += units.of<double>("unit " + std::to_string(i), [&] { return 1.0 / (1.0 + i); });
  }
  return sum;
}

TEST_F(ShardFolders, OfUnitsMergeToTheSameBits) {
  Units all;
  const double whole = sum_of(all);
  EXPECT_TRUE(all.is_whole());
  std::vector<std::string> folders;
  std::size_t own = 0;
  for (int i = 1; i <= 3; ++i) {
    Units units(Shard{i, 3});
    EXPECT_NE(sum_of(units), whole);
    EXPECT_FALSE(units.is_whole());
    own += units.own();
    folders.push_back(write("units" + std::to_string(i), {i, 3}));
    write_shard(read_shard_info(folders.back()), units.results(), folders.back());
  }
  EXPECT_EQ(own, 10U);
  Units merged(read(folders));
  EXPECT_EQ(sum_of(merged), whole);
  EXPECT_EQ(merged.own(), 0U);
  EXPECT_THAT(error_of([&] { (void)merged.of<double>("unit 10", [] { return 0.0; }); }),
              HasSubstr("the shards lack unit 10"));
}

}  // namespace
}  // namespace strata::shards
