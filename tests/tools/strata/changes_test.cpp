// SPDX-License-Identifier: Apache-2.0
/// `strata changes`.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "memory/store/store.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/pipeline/changed_room.hpp"
#include "tests/tools/strata/program.hpp"

namespace strata::test {
namespace {

class Changes : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_.path() / "maps");
    memory::Store(folder_.path() / "maps" / "strata.db").save_timescale(changed_room());
  }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const {
    return folder_.path() / name;
  }

 private:
  TemporaryDirectory folder_;
};

TEST_F(Changes, AreListedDrawnAndGivenAsJson) {
  const Outcome listed = run_strata("changes " + quoted(path("maps")) + " --path 0.5,0,4.3,0");
  EXPECT_EQ(listed.code, 0);
  EXPECT_THAT(listed.out, testing::HasSubstr("1 place differs between 'long' and 'short'"));
  EXPECT_THAT(listed.out, testing::HasSubstr("appeared at (2."));
  EXPECT_THAT(listed.out, testing::HasSubstr("from that of 'long'"));
  const Outcome json =
      run_strata("changes " + quoted(path("maps") / "strata.db") +
                 " --before long --now mid --path 0.5,0,4.3,0 --path -1,2,3,2 --json --out " +
                 quoted(path("changes")));
  ASSERT_EQ(json.code, 0);
  const auto told = nlohmann::json::parse(json.out);
  EXPECT_EQ(told["now"], "mid");
  ASSERT_EQ(told["paths"].size(), 2U);
  EXPECT_EQ(told["paths"][1]["from"], nlohmann::json({-1.0, 2.0}));
  EXPECT_EQ(nlohmann::json::parse(bytes_of(path("changes") / "changes.json")), told);
  EXPECT_TRUE(std::filesystem::exists(path("changes") / "changes.png"));
  EXPECT_TRUE(std::filesystem::exists(path("changes") / "path_2.png"));
}

TEST_F(Changes, AreOfTheLevelsAsTheDecoderToldShowsThem) {
  const auto draw = [this](const std::string& out, const std::string& more) {
    EXPECT_EQ(
        run_strata("changes " + quoted(path("maps")) + " --out " + quoted(path(out)) + more).code,
        0);
    return bytes_of(path(out) / "level_short.png");
  };
  EXPECT_NE(draw("exact", ""), draw("conditional",
                                    " --set decoding.edges=conditional"
                                    " --set decoding.cost=reciprocal"));
  const Outcome unknown =
      run_strata("changes " + quoted(path("maps")) + " --set decode.edges=scene 2>&1");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.out, testing::HasSubstr("decode"));
}

TEST_F(Changes, OfALevelOrStoreThatIsNotThereEndWithTwoAndOneLine) {
  const Outcome level = run_strata("changes " + quoted(path("maps")) + " --now yearly --out " +
                                   quoted(path("x")) + " 2>&1");
  EXPECT_EQ(level.code, 2);
  EXPECT_THAT(level.out, testing::HasSubstr("choose one of: short, mid, long"));
  EXPECT_FALSE(std::filesystem::exists(path("x")));
  const Outcome store = run_strata("changes " + quoted(path("nowhere.db")) + " 2>&1");
  EXPECT_EQ(store.code, 2);
  EXPECT_THAT(store.out, testing::HasSubstr("no such file"));
}

}  // namespace
}  // namespace strata::test
