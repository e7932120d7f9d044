// SPDX-License-Identifier: Apache-2.0
/// A process that dies between any two steps on the disk leaves a site that holds.
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "components/site/site.hpp"
#include "tests/components/site/small_maps.hpp"
#include "tests/support/test_data.hpp"
#include "tests/support/watched_disk.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

class SiteKilled : public testing::Test {
 protected:
  SiteKilled() {
    for (const char* mark : {"a", "b", "c"}) test::write_small_maps(at(mark), mark);
    Site site = Site::create(at("hall"), "hall-3", "map", test::kAda);
    for (const char* mark : {"a", "b"}) {
      const std::string hash = site.add(at(mark), test::kAda, "").status.version.hash;
      site.approve(hash, test::kAda, "");
      (void)site.activate(hash, test::kAda);
    }
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }

  /// Does `work` in a process that ends before step `step` of it; whether it ended before its end.
  [[nodiscard]] bool dies_before(std::size_t step, const std::function<void(Site&)>& work) const {
    const pid_t child = fork();
    if (child == 0) {
      test::WatchedDisk disk;
      disk.before_step = [step](std::size_t number) {
        if (number == step) _exit(9);
      };
      Site site(at("hall"), disk);
      work(site);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WEXITSTATUS(status) == 9;
  }

  /// Everything that is there is whole, and everything can be done.
  void expect_it_holds(const std::string& when) const {
    SCOPED_TRACE(when);
    Site site(at("hall"));
    ASSERT_TRUE(site.active());
    EXPECT_EQ(site.fault_of(*site.active()), "");
    const std::string active = *site.active();
    EXPECT_EQ(site.decisions().activations.back(), active);
    for (const VersionStatus& status : site.versions()) {
      EXPECT_EQ(status.fault, "");
      EXPECT_EQ(site.fault_of(status.version.hash), "");
    }
  }

  /// Kills `work` before each of its steps, and lets it be done from there.
  void try_every_step(const std::string& name, const std::function<void(Site&)>& work,
                      const std::function<bool(const Site&)>& is_done,
                      const std::function<void(Site&)>& undo) const {
    std::size_t step = 0;
    bool died = true;
    for (; died && step < 100; ++step) {
      died = dies_before(step, work);
      expect_it_holds(name + " before step " + std::to_string(step));
      Site site(at("hall"));
      if (!is_done(site)) work(site);
      EXPECT_TRUE(is_done(site)) << name << " after a kill before step " << step;
      undo(site);
      expect_it_holds(name + " undone");
    }
    EXPECT_GT(step, 4U) << name << " has more steps than that";
    EXPECT_FALSE(died);
  }
  test::TemporaryDirectory folder_;
};

TEST_F(SiteKilled, AddLeavesTheVersionWholeOrNotAtAll) {
  try_every_step(
      "add", [&](Site& site) { (void)site.add(at("c"), test::kAda, ""); },
      [](const Site& site) { return site.versions().size() == 3; },
      [](Site& site) {
        fs::remove_all(site.maps_of(site.find("newest").version.hash).parent_path());
      });
  for (const auto& entry : fs::directory_iterator(at("hall") / "versions")) {
    EXPECT_FALSE(entry.path().filename().string().starts_with(".")) << entry;
  }
}

TEST_F(SiteKilled, KeepLeavesWholeRecordings) {
  std::ofstream(at("x.clf")) << std::string(60, 'x');
  std::ofstream(at("y.clf")) << std::string(60, 'y');
  const auto keep = [&](Site& site, const char* name) {
    (void)site.keep(at(name), {}, 100, test::kAda);
  };
  const auto newest = [](const Site& site) {
    const auto all = site.recordings();
    return all.empty() ? std::string() : test::bytes_of(all.back().log);
  };
  Site first(at("hall"));
  keep(first, "x.clf");
  try_every_step(
      "keep", [&](Site& site) { keep(site, "y.clf"); },
      [&](const Site& site) { return newest(site) == std::string(60, 'y'); },
      [&](Site& site) {
        for (const KeptRecording& one : site.recordings()) {
          EXPECT_EQ(test::bytes_of(one.log).size(), 60U);
        }
        keep(site, "x.clf");
      });
}

TEST_F(SiteKilled, PlansAreWholeOrNotThere) {
  FloorPlan plan;
  plan.drawing = {"office.png", "abc", ReflectionGrid(0.02, {{0, 0}, {40, 30}}, 1.0F)};
  const auto set = [&](Site& site) { site.set_plan(plan, test::kAda); };
  const auto remove = [](Site& site) { site.remove_plan(test::kAda); };
  const auto is_there = [](const Site& site) {
    const auto kept = site.plan();  // throws where half a plan is left
    return kept && kept->drawing.lines.size() == 1200;
  };
  const auto is_gone = [&](const Site& site) { return !is_there(site); };
  try_every_step("set a plan", set, is_there, remove);
  Site site(at("hall"));
  set(site);
  try_every_step("remove a plan", remove, is_gone, set);
}

TEST_F(SiteKilled, ZonesAreThoseBeforeOrThoseAfter) {
  const auto zone = [](const std::string& name) {
    return parse_zones(R"({"type": "Feature", "properties": {"kind": "keepout", "name": ")" + name +
                           R"("}, "geometry": {"type": "Polygon", "coordinates":
                           [[[0, 0], [1, 0], [1, 1], [0, 0]]]}})",
                       name);
  };
  Site site(at("hall"));
  (void)site.change_zones([&](Zones& zones) { zones = zone("dock"); }, test::kAda, "set");
  try_every_step(
      "zones",
      [&](Site& now) {
        (void)now.change_zones([&](Zones& zones) { add(zones, zone("lift"), "more"); }, test::kAda,
                               "");
      },
      [](const Site& now) {
        const Zones zones = now.zones();
        EXPECT_NE(zones.find("dock"), nullptr) << "what people drew is lost";
        return zones.find("lift") != nullptr;
      },
      [](Site& now) {
        (void)now.change_zones([](Zones& zones) { remove(zones, "lift", "z"); }, test::kAda, "");
      });
  for (const auto& entry : fs::directory_iterator(at("hall"))) {
    EXPECT_EQ(entry.path().filename().string().find(".partial-"), std::string::npos) << entry;
  }
}

TEST_F(SiteKilled, ActivateLeavesTheOneOrTheOther) {
  const Site site(at("hall"));
  const std::string a = site.find("1").version.hash;
  const std::string b = site.find("2").version.hash;
  try_every_step(
      "activate", [&](Site& now) { (void)now.activate(a, test::kAda); },
      [&](const Site& now) { return now.active() == a; },
      [&](Site& now) { (void)now.activate(b, test::kAda); });
}

TEST_F(SiteKilled, RollbackLeavesTheOneOrTheOther) {
  const Site site(at("hall"));
  const std::string a = site.find("1").version.hash;
  const std::string b = site.find("2").version.hash;
  try_every_step(
      "rollback",
      [&](Site& now) {
        if (now.active() == b) (void)now.rollback(test::kAda);
      },
      [&](const Site& now) { return now.active() == a; },
      [&](Site& now) { (void)now.activate(b, test::kAda); });
}

TEST_F(SiteKilled, RemovingRubbishNeverTakesWhatIsActive) {
  Site site(at("hall"));
  const std::string b = site.find("2").version.hash;
  const auto replace = [&](Site& now) {
    const std::string c = now.add(at("c"), test::kAda, "").status.version.hash;
    now.approve(c, test::kAda, "");
    (void)now.activate(c, test::kAda);
    (void)now.activate(b, test::kAda);
  };
  replace(site);
  // The first version stays: its frame is the site's.
  try_every_step(
      "gc", [](Site& now) { (void)now.remove_rubbish({.keep_retired = 0}, test::kAda); },
      [](const Site& now) { return now.versions().size() == 2; }, replace);
  EXPECT_EQ(site.versions().front().version.number, 1);
}

}  // namespace
}  // namespace strata::site
