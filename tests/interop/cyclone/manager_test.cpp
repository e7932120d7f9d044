// SPDX-License-Identifier: Apache-2.0
/// `strata run` led by Cyclone DDS as nav2's lifecycle manager leads its nodes.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <signal.h>

#include "components/log/map_file.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/interop/cyclone/process.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::test {
namespace {

/// Two processes of `strata run` in which nothing happens before somebody says so.
class CycloneManager : public testing::Test {
 protected:
  CycloneManager() {
    log::write_map(folder_.path() / "room.yaml", {0.1, CellRect{{0, 0}, {5, 7}}, 1.0F});
    std::ofstream(file())
        << "version: 1\ntransport: loopback\nnamespace: /robot1\nstart: unconfigured\n"
           "processes:\n"
           "  - name: maps\n    components:\n"
           "      - {type: strata::MapServer, name: maps, parameters: {map: "
        << (folder_.path() / "room.yaml").string()
        << "}}\n"
           "      - {type: strata::MapSaver, name: saver}\n"
           "  - name: places\n    components:\n"
           "      - {type: strata::ScanMatcher, name: matcher}\n";
  }
  [[nodiscard]] fs::path file() const { return folder_.path() / "managed.yaml"; }
  [[nodiscard]] std::vector<std::string> command() const {
    return {STRATA_PROGRAM, "run", file().string(), "--set",
            "domain=" + std::to_string(own_domain())};
  }
  /// What the manager gets to hear when it leads a node through these transitions.
  static std::vector<std::string> lead(const std::string& node,
                                       const std::vector<std::string>& transitions) {
    std::vector<std::string> words = {"manage", node};
    words.insert(words.end(), transitions.begin(), transitions.end());
    CycloneProcess manager(words);
    std::vector<std::string> heard = {manager.wait_for_line("state")};
    for (const std::string& transition : transitions) {
      heard.push_back(manager.wait_for_line(transition + " success"));
    }
    return heard;
  }
  TemporaryDirectory folder_;
};

using Heard = std::vector<std::string>;

TEST_F(CycloneManager, BringsUpAndDownNodesOfStrataRunAsNav2Does) {
  ChildProcess run(command(), {}, ChildProcess::Errors::kMerged);
  EXPECT_EQ(lead("/robot1/maps", {"1", "3"}),
            (Heard{"state 1", "1 success 1 state 2", "3 success 1 state 3"}));
  CycloneProcess map({"get_map", "/robot1/maps"});
  EXPECT_EQ(map.wait_for_line("map"), "map 5 7 map");
  CycloneProcess bond({"bond", "/robot1", "maps"});
  EXPECT_EQ(bond.wait_for_line("bond"), "bond 1");
  // Reset, and all over again; the bond ends and is formed anew with that.
  EXPECT_EQ(lead("/robot1/maps", {"4", "2"}),
            (Heard{"state 3", "4 success 1 state 2", "2 success 1 state 1"}));
  EXPECT_EQ(bond.wait_for_line("bond"), "bond 0");
  EXPECT_EQ(lead("/robot1/maps", {"1", "3"}),
            (Heard{"state 1", "1 success 1 state 2", "3 success 1 state 3"}));
  EXPECT_EQ(bond.wait_for_line("bond"), "bond 1");
  // Nodes beside it, one of another process, are led apart; each state has its shutdown.
  EXPECT_EQ(
      lead("/robot1/saver", {"3", "1", "6"}),
      (Heard{"state 1", "3 success 0 state 1", "1 success 1 state 2", "6 success 1 state 4"}));
  EXPECT_EQ(lead("/robot1/matcher", {"1", "3", "7", "1"}),
            (Heard{"state 1", "1 success 1 state 2", "3 success 1 state 3", "7 success 1 state 4",
                   "1 success 0 state 4"}));
  EXPECT_EQ(
      lead("/robot1/maps", {"4", "2", "5"}),
      (Heard{"state 3", "4 success 1 state 2", "2 success 1 state 1", "5 success 1 state 4"}));
  EXPECT_TRUE(run.runs());
  run.send(SIGINT);
  EXPECT_EQ(run.wait(), 0);
}

}  // namespace
}  // namespace strata::test
