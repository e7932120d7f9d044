// SPDX-License-Identifier: Apache-2.0
/// docs/architecture.md, "Who may include whom", against the #include lines and the CMake targets.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/structure/room_rules.hpp"
#include "tests/structure/source_tree.hpp"

namespace strata::test {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

Source source(const std::string& path, const std::string& text) {
  return {path, text, includes_of(text)};
}

TEST(Rooms, IncludeOnlyWhatTheyMay) {
  const std::vector<Source> sources = read_sources({"core", "memory", "components", "tools"});
  ASSERT_GT(sources.size(), 30U);
  std::vector<std::string> faults;
  for (const Source& file : sources) {
    for (std::string& fault : faults_of(file)) faults.push_back(std::move(fault));
  }
  EXPECT_THAT(faults, IsEmpty());
}

TEST(Rooms, LinkOnlyWhatTheyMayInclude) {
  const std::vector<RoomTarget> rooms = read_rooms();
  ASSERT_GT(rooms.size(), 10U);
  EXPECT_THAT(link_faults(rooms), IsEmpty());
}

TEST(Rooms, LinkWhatTheyInclude) {
  EXPECT_THAT(unlinked_includes(read_sources({"core", "memory", "components"}), read_rooms()),
              IsEmpty());
}

// The checks themselves: each kind of fault is caught.

TEST(RoomRules, FollowTheArrowsOfThePage) {
  EXPECT_TRUE(may_include("core/grid", "core/base"));
  EXPECT_FALSE(may_include("core/base", "core/grid"));
  EXPECT_TRUE(may_include("core/slam", "core/registration"));
  EXPECT_FALSE(may_include("core/patch", "core/slam"));
  EXPECT_FALSE(may_include("core/localization", "memory/nodes"));
  EXPECT_TRUE(may_include("core/patch_beams", "core/rays"));
  EXPECT_FALSE(may_include("core/localization", "core/patch_beams"));
  EXPECT_FALSE(may_include("core/rays", "core/localization"));
  EXPECT_TRUE(may_include("memory/store", "core/patch"));
  EXPECT_FALSE(may_include("memory/nodes", "components/log"));
  EXPECT_TRUE(may_include("components/log", "idl"));
  EXPECT_FALSE(may_include("components/log", "components/bus"));
  EXPECT_FALSE(may_include("components/maps", "components/bus"));
  EXPECT_TRUE(may_include("components/localizer", "components/bus"));
  EXPECT_FALSE(may_include("components/localizer", "components/player"));
  EXPECT_TRUE(may_include("tools/strata", "components/player"));
  EXPECT_FALSE(may_include("components/player", "tools/strata"));
  EXPECT_TRUE(may_include("tools/laboratory", "tools/pipeline"));
  EXPECT_FALSE(may_include("tools/pipeline", "tools/laboratory"));
  EXPECT_FALSE(may_include("core/base", "tests/support"));
}

TEST(RoomRules, CatchAnArrowThatPointsTheWrongWay) {
  EXPECT_THAT(faults_of(source("core/base/a.hpp", "#include \"core/grid/grid.hpp\"\n")), SizeIs(1));
  EXPECT_THAT(faults_of(source("core/grid/a.hpp", "#include \"core/base/error.hpp\"\n")),
              IsEmpty());
  EXPECT_THAT(faults_of(source("core/unheard_of/a.hpp", "#include \"core/base/error.hpp\"\n")),
              SizeIs(1));
}

TEST(RoomRules, CatchWhatCoreAndMemoryMayNotKnow) {
  for (const char* header :
       {"<fastdds/dds/domain/DomainParticipant.hpp>", "<fastcdr/Cdr.h>",
        "\"strata_idl/std_msgs.h\"", "<yaml-cpp/yaml.h>", "<iostream>", "<chrono>", "<fstream>",
        "<filesystem>", "<random>", "<spdlog/spdlog.h>", "<sqlite3.h>"}) {
    const std::string text = std::string("  #  include ") + header + "\n";
    EXPECT_FALSE(faults_of(source("core/base/a.cpp", text)).empty()) << header;
    EXPECT_FALSE(faults_of(source("memory/levels/a.cpp", text)).empty()) << header;
  }
  EXPECT_THAT(faults_of(source("memory/store/a.cpp", "#include <filesystem>\n")), IsEmpty());
  EXPECT_THAT(faults_of(source("memory/store/a.cpp", "#include <iostream>\n")), SizeIs(1));
  EXPECT_THAT(faults_of(source("components/log/a.cpp", "#include <fstream>\n")), IsEmpty());
  EXPECT_THAT(faults_of(source("core/base/a.cpp", "std::normal_distribution<double> d;")),
              SizeIs(1));
  EXPECT_THAT(faults_of(source("core/base/a.cpp", "auto t = steady_clock::now();")), SizeIs(1));
}

TEST(RoomRules, CatchCeresInAHeaderOfCore) {
  EXPECT_THAT(faults_of(source("core/slam/a.hpp", "#include <ceres/ceres.h>\n")), SizeIs(1));
  EXPECT_THAT(faults_of(source("core/slam/a.cpp", "#include <ceres/ceres.h>\n")), IsEmpty());
}

TEST(RoomRules, CatchLinksAndIncludesThatDoNotFit) {
  const std::vector<RoomTarget> rooms{{"core/base", "core_base", {"core_grid"}},
                                      {"core/grid", "core_grid", {"core_scan"}},
                                      {"core/scan", "core_scan", {"core_base"}},
                                      {"core/patch", "core_patch", {"core_nothing"}}};
  EXPECT_THAT(link_faults(rooms), SizeIs(2));
  EXPECT_THAT(unlinked_includes({source("core/grid/a.cpp", "#include \"core/base/error.hpp\"\n")},
                                {rooms[1], rooms[2], {"core/base", "core_base", {}}}),
              IsEmpty());
  EXPECT_THAT(unlinked_includes({source("core/grid/a.cpp", "#include \"core/patch/a.hpp\"\n")},
                                {rooms[1], rooms[2]}),
              SizeIs(1));
}

TEST(RoomRules, ReadRoomsFromCMake) {
  const auto rooms =
      rooms_of("core/grid",
               "find_package(X)\nstrata_room(core_grid\n  SOURCES a.cpp\n  LINKS core_base "
               "core_scan\n  PACKAGES Y::Y)\n");
  ASSERT_THAT(rooms, SizeIs(1));
  EXPECT_EQ(rooms[0].name, "core_grid");
  EXPECT_EQ(rooms[0].links, (std::vector<std::string>{"core_base", "core_scan"}));
}

}  // namespace
}  // namespace strata::test
