// SPDX-License-Identifier: Apache-2.0
/// `strata topology` on whole real logs with loops: which places are one, and how good the map is.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/test_data.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace strata::tools {
namespace {

using test::bytes_of;

struct Agreement {
  nlohmann::json places;
  double relation_error_m = 0.0;
};

Agreement map_topology(const std::string& log, const std::string& truth,
                       const std::string& relations) {
  const test::TemporaryDirectory folder;
  const std::filesystem::path out = folder.path() / "topology";
  const test::Outcome mapped =
      test::run_strata("topology --quiet " + test::quoted(log) + " --truth " + test::quoted(truth) +
                       " --truth-precision 0.1 --out " + test::quoted(out) + " 2>&1");
  EXPECT_EQ(mapped.code, 0) << mapped.out;
  const test::Outcome evaluated =
      test::run_strata("evaluate --quiet --json " + test::quoted(out / "trajectory.tum") +
                       " --relations " + test::quoted(relations));
  EXPECT_EQ(evaluated.code, 0);
  return {nlohmann::json::parse(bytes_of(out / "topologies.json"))["agreement"],
          nlohmann::json::parse(evaluated.out)["relations"]["error_m"]["mean"].get<double>()};
}

/// Places within a metre of each other are one landmark, others not, as far as the reference can
/// tell; the map is as good as the noise of the relations lets full SLAM's be.
void expect_one_map(const Agreement& agreement, double max_relation_error_m) {
  const auto count = [&](const char* key) { return agreement.places[key].get<int>(); };
  EXPECT_LT(agreement.relation_error_m, max_relation_error_m);
  EXPECT_GT(count("near"), 50);
  EXPECT_EQ(count("near_merged"), count("near"));
  EXPECT_GT(count("between"), 20);
  EXPECT_EQ(count("between_merged"), 0);
  EXPECT_EQ(count("far_merged"), 0);
}

TEST(TopologyOfARealLog, OfFreiburgIsOneMap) {
  STRATA_REQUIRE_DATA(log, "fr079/fr079.clf.gz");
  STRATA_REQUIRE_DATA(truth, "fr079/fr079.ref.txt");
  STRATA_REQUIRE_DATA(relations, "fr079/fr079.relations");
  expect_one_map(map_topology(log, truth, relations), 0.034);
}

TEST(TopologyOfARealLog, OfIntelIsOneMap) {
  STRATA_REQUIRE_DATA(log, "intel/intel.clf.gz");
  STRATA_REQUIRE_DATA(truth, "intel/intel.ref.txt");
  STRATA_REQUIRE_DATA(relations, "intel/intel.relations");
  expect_one_map(map_topology(log, truth, relations), 0.015);
}

}  // namespace
}  // namespace strata::tools
