// SPDX-License-Identifier: Apache-2.0
/// The recipe of docs/site.md for every night.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/site/site.hpp"
#include "tests/components/site/small_maps.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/tools/strata/site_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::Outcome;
using test::quoted;
using testing::HasSubstr;

/// Days of an empty room, the first of which is active and the third kept.
class SiteVerbAtNight : public SiteVerb {
 protected:
  void SetUp() override {
    ASSERT_EQ(test::run_strata("simulate '" STRATA_SOURCE_DIR
                               "/tools/simulate/scenarios/empty_room.yaml' --set days=4 --per-day "
                               "--quiet --out " +
                               quoted(at("days")))
                  .code,
              0);
    ASSERT_EQ(learn(1, "--out " + quoted(at("maps"))).code, 0);
    ASSERT_EQ(site("init", "--id hall-3").code, 0);
    ASSERT_EQ(ask("take", quoted(at("maps")))["state"], "active");
    ASSERT_EQ(site("keep", log(3)).code, 0);
  }
  [[nodiscard]] std::string log(int day) const {
    return quoted(at("days/day_" + std::to_string(day) + "/log.clf"));
  }
  [[nodiscard]] Outcome learn(int day, const std::string& rest) const {
    return test::run_strata("learn " + log(day) + " --quiet --only em " + rest + " 2>&1");
  }
  /// The line of docs/site.md for every night, with the day's log.
  [[nodiscard]] Outcome learn_as_documented(int day, const std::string& rest = "") const {
    const std::string line =
        "strata learn tuesday.clf --update site/active --out maps --force\n"
        "strata site take site maps\n";
    EXPECT_THAT(test::bytes_of(STRATA_SOURCE_DIR "/docs/site.md"), HasSubstr(line));
    return learn(day, "--update " + quoted(at("site/active")) + " --out " + quoted(at("maps")) +
                          " --force " + rest);
  }
  /// As if the robot had been elsewhere, and turned.
  void write_astray(int day, const fs::path& to) const {
    std::ifstream in(at("days/day_" + std::to_string(day) + "/truth.tum"));
    std::ofstream out(to);
    for (std::string stamp, x, y; in >> stamp >> x >> y;) {
      std::string rest;
      std::getline(in, rest);
      out << stamp << " " << std::stod(x) + 1.2 << " " << std::stod(y) + 0.7
          << " 0 0 0 0.247404 0.968912\n";
    }
  }
};

TEST_F(SiteVerbAtNight, GoesOnFromWhatIsActiveAfterANightThatWasRefused) {
  write_astray(2, at("astray.tum"));
  ASSERT_EQ(learn_as_documented(2, "--poses " + quoted(at("astray.tum"))).code, 0);
  const Outcome refused = site("take", quoted(at("maps")));
  EXPECT_EQ(refused.code, 2) << refused.out;
  ASSERT_EQ(learn_as_documented(4).code, 0);
  const Outcome good = site("take", quoted(at("maps")));
  EXPECT_EQ(good.code, 0) << good.out;
  EXPECT_EQ(ask("status")["active"]["mapVersion"], "3");
  EXPECT_EQ(ask("list")[1]["state"], "candidate") << "to be looked at";
}

TEST_F(SiteVerbAtNight, DoesNotReplaceARunThatNothingElseHolds) {
  const std::string update = "--update " + quoted(at("site/active")) + " --out ";
  ASSERT_EQ(learn(2, update + quoted(at("maps"))).code, 0) << "the active version has its run";
  const Outcome refused = learn(4, update + quoted(at("maps")));
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.out, HasSubstr("holds run 1, which began at "));
  EXPECT_EQ(learn(2, update + quoted(at("maps"))).code, 0) << "the same drive";
  EXPECT_EQ(learn(4, "--update " + quoted(at("maps")) + " --out " + quoted(at("maps"))).code, 0);
  EXPECT_EQ(learn(4, update + quoted(at("maps"))).code, 1);
  EXPECT_EQ(learn(4, update + quoted(at("maps")) + " --force").code, 0);
}

TEST_F(SiteVerbAtNight, TakesNothingInThePlaceOfAVersionThatWasNotComparedWith) {
  ASSERT_EQ(learn_as_documented(2).code, 0);
  ASSERT_EQ(site("take", quoted(at("maps"))).code, 0);
  ASSERT_EQ(learn_as_documented(4).code, 0);
  auto taken = std::async(std::launch::async, [&] { return site("take", quoted(at("maps"))); });
  site::Site here(at("site"));
  ASSERT_TRUE(test::comes_true([&] { return here.versions().size() == 3; }));
  (void)here.rollback(test::kAda);  // while its recordings are driven
  const Outcome refused = taken.get();
  EXPECT_EQ(refused.code, 2) << refused.out;
  EXPECT_THAT(refused.out, HasSubstr("has another active version by now"));
  EXPECT_EQ(ask("status")["active"]["mapVersion"], "1");
  EXPECT_EQ(ask("list")[2]["state"], "candidate");
}

}  // namespace
}  // namespace strata::tools
