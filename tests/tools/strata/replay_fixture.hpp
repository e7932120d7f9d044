// SPDX-License-Identifier: Apache-2.0
/// A simulated log, the maps that `strata learn` makes of it, and `strata replay` on it.
#pragma once

#include <filesystem>
#include <iterator>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/components/bus/domain.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace strata::test {

namespace fs = std::filesystem;

inline const fs::path kSource = STRATA_SOURCE_DIR;
inline const fs::path kCompositions = kSource / "components" / "config";

/// Every file below a folder except summary.json, which tells the cost. strata.db is compared as
/// the file it is: both ways make the same saves in the same order.
inline std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> result;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file() || entry.path().filename() == "summary.json") continue;
    result[entry.path().lexically_relative(folder).string()] = bytes_of(entry.path());
  }
  return result;
}

inline nlohmann::json summary_without_cost(const fs::path& folder) {
  nlohmann::json summary = nlohmann::json::parse(bytes_of(folder / "summary.json"));
  summary.erase("cost");
  return summary;
}

/// But for the pictures, which only `strata learn` draws.
inline void expect_same_maps(const fs::path& a, const fs::path& b) {
  auto expected = contents(a);
  auto got = contents(b);
  for (const char* picture : {"map.png", "dynamic.png"}) {
    expected.erase(picture);
    got.erase(picture);
  }
  for (const char* file :
       {"strata.db", "occupancy.pgm", "filtered.pgm", "patches.pgm", "trajectory.tum"}) {
    EXPECT_EQ(expected.count(file), 1U) << file;
  }
  for (const auto& [name, bytes] : expected) {
    const auto found = got.find(name);
    ASSERT_NE(found, got.end()) << name;
    EXPECT_TRUE(found->second == bytes) << name << " differs";
  }
  EXPECT_EQ(got.size(), expected.size());
  EXPECT_EQ(summary_without_cost(a), summary_without_cost(b));
}

/// What `strata topology` leaves and what a replay does, which draws no pictures and does not know
/// what the log is called and what it cost.
inline void expect_same_topologies(const fs::path& direct, const fs::path& replayed) {
  auto expected = nlohmann::json::parse(bytes_of(direct / "topologies.json"));
  expected.erase("log");
  expected.erase("cost");
  EXPECT_GT(expected["visits"].size(), 1U);
  EXPECT_EQ(nlohmann::json::parse(bytes_of(replayed / "topologies.json")), expected);
  for (const char* file :
       {"topology.graphml", "occupancy.yaml", "occupancy.pgm", "trajectory.tum"}) {
    EXPECT_FALSE(bytes_of(direct / file).empty()) << file;
    EXPECT_TRUE(bytes_of(replayed / file) == bytes_of(direct / file)) << file << " differs";
  }
}

class ReplayFixture : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(
        run_strata("simulate --quiet " + quoted(scenario()) + " --out " + quoted(at("sim"))).code,
        0);
    learn(log());
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  [[nodiscard]] static fs::path scenario() {
    return kSource / "tools" / "simulate" / "scenarios" / "empty_room.yaml";
  }
  [[nodiscard]] fs::path log() const { return at("sim") / "log.clf"; }

  void learn(const fs::path& log) const {
    ASSERT_EQ(run_strata("learn --quiet " + quoted(log) + " --out " + quoted(at("direct"))).code,
              0);
  }
  /// Several test programs run at a time: each on a domain of its own.
  [[nodiscard]] Outcome replay(const fs::path& log, const fs::path& composition,
                               const std::string& out, const std::string& more = "") const {
    return run_strata("replay --quiet " + quoted(log) + " --composition " + quoted(composition) +
                      " --out " + quoted(at(out)) +
                      " --set domain=" + std::to_string(own_domain()) + " " + more + " 2>&1");
  }

 private:
  TemporaryDirectory folder_;
};

}  // namespace strata::test
