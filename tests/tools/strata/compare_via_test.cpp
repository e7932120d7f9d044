// SPDX-License-Identifier: Apache-2.0
/// `strata compare --via dds`: what the components say is what the library says; the settings that
/// it shares with `localize`.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/tools/strata/replay_fixture.hpp"

namespace strata::tools {
namespace {

using test::bytes_of;
using test::quoted;

class CompareVia : public test::ReplayFixture {
 protected:
  test::Outcome compare(const std::string& out, const std::string& more) {
    return test::run_strata("compare " + quoted(log()) + " --seeds 2 --quiet --out " +
                            quoted(at(out)) + " " + more + " 2>&1");
  }
};

TEST_F(CompareVia, DdsGivesEveryErrorOfTheDirectCall) {
  const std::string models = "--models occupancy,filtered,patch,patch_places,timescale,cells ";
  ASSERT_EQ(compare("direct_errors", models).code, 0);
  const test::Outcome outcome = compare("dds_errors", models + "--via dds --jobs 2");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  EXPECT_EQ(bytes_of(at("direct_errors") / "errors.csv"),
            bytes_of(at("dds_errors") / "errors.csv"));
  const auto result = nlohmann::json::parse(bytes_of(at("dds_errors") / "comparison.json"));
  EXPECT_EQ(result["via"], "dds");
  EXPECT_FALSE(std::filesystem::exists(at("dds_errors_maps"))) << "the maps were for the runs only";
  EXPECT_FALSE(std::filesystem::exists(at("dds_errors_place_maps")));
}

TEST_F(CompareVia, LocalizeDecodesTheMemoryAsToldToo) {
  const auto localize = [this](const std::string& out, const std::string& more) {
    return test::run_strata("localize " + quoted(log()) + " --quiet --model timescale_frozen" +
                            " --initial-pose 0,0,0 --maps " + quoted(at("direct")) + " --out " +
                            quoted(at(out)) + more + " 2>&1");
  };
  ASSERT_EQ(localize("exact", "").code, 0);
  ASSERT_EQ(localize("joint", " --set decoding.edges=joint").code, 0);
  EXPECT_NE(bytes_of(at("exact") / "trajectory.tum"), bytes_of(at("joint") / "trajectory.tum"));
  const test::Outcome unknown = localize("unknown", " --set decoding.edges=guess");
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.out, testing::HasSubstr("decoding.edges"));
}

TEST_F(CompareVia, DecodesTheMemoryAsToldInBothWays) {
  const auto errors = [this](const std::string& out, const std::string& more) {
    const test::Outcome outcome = test::run_strata(
        "compare --train " + quoted(log()) + " --test " + quoted(log()) +
        " --seeds 1 --models timescale_frozen --set protocol.memory_steps=0 --quiet --out " +
        quoted(at(out)) + more + " 2>&1");
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    return bytes_of(at(out) / "errors.csv");
  };
  const std::string joint = " --set decoding.edges=joint";
  const std::string direct = errors("direct_joint", joint);
  EXPECT_EQ(direct, errors("dds_joint", joint + " --via dds"));
  EXPECT_TRUE(direct != errors("exact", ""));
  EXPECT_THAT(bytes_of(at("direct_joint") / "report.html"), testing::HasSubstr("edges: joint"));
}

TEST_F(CompareVia, DdsRefusesAMapThatNoComponentReads) {
  const test::Outcome outcome =
      compare("none", "--via dds --models map --map " + quoted(at("direct") / "occupancy.yaml"));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, testing::HasSubstr("the model `map` is in no MAPS folder"));
  EXPECT_FALSE(std::filesystem::exists(at("none")));
}

}  // namespace
}  // namespace strata::tools
