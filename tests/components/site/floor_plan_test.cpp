// SPDX-License-Identifier: Apache-2.0
#include "components/site/floor_plan.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/map_file.hpp"
#include "components/log/map_image.hpp"
#include "components/log/sha256.hpp"
#include "components/site/site.hpp"
#include "core/base/error.hpp"
#include "tests/components/site/small_maps.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using testing::HasSubstr;

class FloorPlans : public testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  /// White but for a row of dark pixels from the left in the lowest line, as long as told.
  [[nodiscard]] fs::path drawn(const std::string& name, int dark, std::uint8_t ink = 20,
                               std::uint8_t paper = 250) const {
    log::MapImage image;
    image.width = 300;
    image.height = 100;
    image.pixels.assign(30'000, paper);
    std::fill_n(image.pixels.end() - image.width, dark, ink);
    log::write_map_image(at(name), image, log::MapImageFormat::kPng);
    return at(name);
  }
  static void expect_refused(const std::function<void()>& work, const std::string& why) {
    try {
      work();
      ADD_FAILURE() << "was taken, though it " << why;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  }
  test::TemporaryDirectory folder_;
};

TEST_F(FloorPlans, HaveTheirOriginAtTheLowerLeftCorner) {
  const Drawing drawing = read_drawing(drawn("a.png", 120), {.metres_per_pixel = 0.05});
  EXPECT_EQ(drawing.name, "a.png");
  EXPECT_EQ(drawing.sha256, log::sha256_of(test::bytes_of(at("a.png"))));
  EXPECT_EQ(drawing.lines.rect(), (CellRect{{0, 0}, {300, 100}}));
  EXPECT_DOUBLE_EQ(drawing.lines.resolution_m(), 0.05);
  EXPECT_EQ(drawing.lines.at({119, 0}), 1.0F);
  EXPECT_EQ(drawing.lines.at({120, 0}), 0.0F);
  EXPECT_EQ(drawing.lines.at({0, 1}), 0.0F);
}

TEST_F(FloorPlans, JoinPixelsThatAreSmallerThanNeeded) {
  const Drawing drawing = read_drawing(drawn("a.png", 121), {.metres_per_pixel = 0.005});
  EXPECT_DOUBLE_EQ(drawing.lines.resolution_m(), 0.02);
  EXPECT_EQ(drawing.lines.rect(), (CellRect{{0, 0}, {75, 25}}));
  EXPECT_EQ(drawing.lines.at({30, 0}), 1.0F) << "one pixel of its sixteen is dark";
  EXPECT_EQ(drawing.lines.at({31, 0}), 0.0F);
}

TEST_F(FloorPlans, MayBeLightOnDarkAndAMapServersMap) {
  const Drawing inverted =
      read_drawing(drawn("i.png", 120, 250, 20), {.metres_per_pixel = 0.05, .is_inverted = true});
  EXPECT_EQ(inverted.lines.at({119, 0}), 1.0F);
  EXPECT_EQ(inverted.lines.at({120, 0}), 0.0F);
  log::write_map(at("map.yaml"), inverted.lines.cropped({{-40, 0}, {260, 100}}));
  const Drawing map = read_drawing(at("map.yaml"), {});
  EXPECT_EQ(map.lines.at({119, 0}), 1.0F);
  EXPECT_EQ(map.lines.at({120, 0}), 0.0F);
}

TEST_F(FloorPlans, AreRefusedWithWhatToDo) {
  const fs::path good = drawn("good.png", 120);
  const auto reads = [](const fs::path& file, const DrawingScale& scale) {
    return [file, scale] { (void)read_drawing(file, scale); };
  };
  expect_refused(reads(at("none.png"), {0.05}), "is missing");
  expect_refused(reads(at(""), {0.05}), "is missing or no file");
  const std::string bytes = test::bytes_of(good);
  std::ofstream(at("cut.png"), std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  expect_refused(reads(at("cut.png"), {0.05}), "damaged PNG");
  for (const double scale : {-1.0, 1e-9, 100.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    expect_refused(reads(good, {scale}), "of no floor plan");
  }
  expect_refused(reads(good, {0.001}), "which is no building");
  expect_refused(reads(drawn("white.png", 0), {0.05}), "shows nothing");
  expect_refused(reads(drawn("dark.png", 120, 250, 20), {0.05}), "--inverted");
}

TEST_F(FloorPlans, StayWhereTheyWerePut) {
  Site site = Site::create(at("site"), "hall-3", "map", test::kAda);
  EXPECT_FALSE(site.plan());
  expect_refused([&] { site.remove_plan(test::kAda); }, "has no plan");
  FloorPlan plan;
  plan.drawing = read_drawing(drawn("a.png", 120), {.metres_per_pixel = 0.013});
  plan.site_from_plan = {{1.0 / 3.0, -2.0, 0.1}, 1.001};
  plan.fit = plan::PlanPlace{plan.site_from_plan, -0.1, 0.8, 0.9, 0.85, 0.02};
  plan.version = "abc";
  site.set_plan(plan, test::kAda);
  const FloorPlan kept = *Site(at("site")).plan();
  EXPECT_EQ(kept.drawing.lines.rect(), plan.drawing.lines.rect());
  EXPECT_EQ(kept.drawing.lines.values(), plan.drawing.lines.values());
  EXPECT_EQ(kept.drawing.lines.resolution_m(), plan.drawing.lines.resolution_m());
  EXPECT_EQ(to_json(kept)["sha256"], plan.drawing.sha256);
  EXPECT_EQ(kept.site_from_plan.pose.vector(), plan.site_from_plan.pose.vector());
  EXPECT_EQ(kept.site_from_plan.scale, 1.001);
  ASSERT_TRUE(kept.fit);
  EXPECT_EQ(kept.fit->map_share, 0.8);
  EXPECT_EQ(kept.version, "abc");
  EXPECT_EQ(kept.placed.by, "ada");
  expect_refused([&] { site.set_plan(plan, test::kAda); }, "has a plan already");
  EXPECT_EQ(site.decisions().diary.back().what, "plan");
  site.remove_plan({"grace", 2});
  EXPECT_FALSE(site.plan());
  EXPECT_EQ(site.decisions().diary.back().actor.by, "grace");
  site.set_plan(plan, test::kAda);
  EXPECT_TRUE(site.plan());
}

TEST_F(FloorPlans, ThatAreDamagedAreToldAndCanBeTakenAway) {
  Site site = Site::create(at("site"), "hall-3", "map", test::kAda);
  FloorPlan plan;
  plan.drawing = read_drawing(drawn("a.png", 120), {.metres_per_pixel = 0.05});
  site.set_plan(plan, test::kAda);
  const std::string good = test::bytes_of(at("site/plan/plan.json"));
  std::string no_scale = good;
  no_scale.replace(no_scale.find("\"scale\": 1"), 10, "\"scale\": 0");
  for (const std::string& bad :
       {std::string("{"), std::string("[]"), std::string("{}"), no_scale}) {
    std::ofstream(at("site/plan/plan.json")) << bad;
    expect_refused([&] { (void)site.plan(); }, "remove");
  }
  site.remove_plan(test::kAda);
  EXPECT_FALSE(site.plan());
}

}  // namespace
}  // namespace strata::site
