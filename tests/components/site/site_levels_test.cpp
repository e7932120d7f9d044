// SPDX-License-Identifier: Apache-2.0
/// A building: a site whose levels are sites.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/site/active_maps.hpp"
#include "components/site/site.hpp"
#include "core/base/error.hpp"
#include "tests/components/site/small_maps.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using testing::HasSubstr;

class SiteLevels : public testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] static std::string error_of(const std::function<void()>& body) {
    try {
      body();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  test::TemporaryDirectory folder_;
  Site building_ = Site::create(folder_.path() / "house", "house", "map", test::kAda);
};

TEST_F(SiteLevels, AreSitesOfTheirOwnFromTheLowestUp) {
  EXPECT_TRUE(building_.levels().empty());
  (void)building_.add_level("1", 3.5, "house-1", test::kAda);
  (void)building_.add_level("0", 0.0, "house-0", test::kAda);
  (void)building_.add_level("cellar", -3.0, "house-cellar", test::kAda);
  const auto levels = building_.levels();
  ASSERT_EQ(levels.size(), 3U);
  EXPECT_EQ(levels[0].name, "cellar");
  EXPECT_EQ(levels[1].name, "0");
  EXPECT_EQ(levels[2].elevation_m, 3.5);
  Site first(levels[2].folder);
  EXPECT_EQ(first.decisions().id, "house-1");
  EXPECT_EQ(first.decisions().frame, "map");
  test::write_small_maps(at("maps"), "a");
  const std::string hash = first.add(at("maps"), test::kAda, "").status.version.hash;
  first.approve(hash, test::kAda, "");
  (void)first.activate(hash, test::kAda);
  EXPECT_EQ(identify(real_maps(levels[2].folder)).id, "house-1");
  EXPECT_THAT(error_of([&] { (void)real_maps(building_.folder()); }), HasSubstr("name one"));
  EXPECT_EQ(building_.decisions().diary.back().what, "level");
}

TEST_F(SiteLevels, AreRefusedWhereTheyWouldBeMistaken) {
  for (const char* name : {"", ".", "..", "a/b", ".hidden", "first floor"}) {
    EXPECT_THAT(error_of([&] { (void)building_.add_level(name, 0.0, "x", test::kAda); }),
                HasSubstr("cannot name a level"));
  }
  EXPECT_THAT(error_of([&] { (void)building_.add_level("1", std::nan(""), "x", test::kAda); }),
              HasSubstr("no height"));
  const Level level = building_.add_level("1", 0.0, "x", test::kAda);
  EXPECT_THAT(error_of([&] { (void)building_.add_level("1", 0.0, "x", test::kAda); }),
              HasSubstr("there already"));
  Site below(level.folder);
  EXPECT_THAT(error_of([&] { (void)below.add_level("2", 0.0, "x", test::kAda); }),
              HasSubstr("a level itself"));
  test::write_small_maps(at("maps"), "a");
  EXPECT_THAT(error_of([&] { (void)building_.add(at("maps"), test::kAda, ""); }),
              HasSubstr("has levels"));
  Site old = Site::create(at("old"), "old", "map", test::kAda);
  (void)old.add(at("maps"), test::kAda, "");
  EXPECT_THAT(error_of([&] { (void)old.add_level("1", 0.0, "x", test::kAda); }),
              HasSubstr("maps of its own"));
  std::ofstream(level.folder / kLevelFile) << "{";
  EXPECT_THAT(error_of([&] { (void)building_.levels(); }), HasSubstr("how high"));
}

TEST_F(SiteLevels, GoOnlyWithoutVersions) {
  const Level level = building_.add_level("1", 0.0, "x", test::kAda);
  test::write_small_maps(at("maps"), "a");
  (void)Site(level.folder).add(at("maps"), test::kAda, "");
  EXPECT_THAT(error_of([&] { building_.remove_level("1", test::kAda); }),
              HasSubstr("has versions"));
  (void)building_.add_level("2", 4.0, "y", test::kAda);
  building_.remove_level("2", test::kAda);
  EXPECT_EQ(building_.levels().size(), 1U);
  EXPECT_THAT(error_of([&] { building_.remove_level("2", test::kAda); }),
              HasSubstr("has no level"));
}

}  // namespace
}  // namespace strata::site
