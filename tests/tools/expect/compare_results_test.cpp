// SPDX-License-Identifier: Apache-2.0
#include "tools/expect/compare_results.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "strata_idl/strata_msgs.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "core/base/error.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::expect {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

void write(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

/// Four poses of a scan matcher in a bag; x of the one at `moved` is moved.
void write_topics(const fs::path& folder, int moved, double moved_by,
                  const std::vector<int>& order = {0, 1, 2, 3}) {
  log::BagWriter bag(folder / kTopicsFolder, log::BagStorage::kMcap);
  const std::size_t topic = bag.add_topic({"/scan_pose", "strata_msgs/msg/ScanPose", "cdr", ""});
  for (const int i : order) {
    strata_msgs::msg::ScanPose pose;
    pose.header(convert::make_header(Stamp{1'000'000'000LL * (10 + i)}, "map"));
    pose.index(static_cast<std::uint64_t>(i));
    pose.map_from_robot().mean().x(0.5 * i + (i == moved ? moved_by : 0.0));
    // Two a stamp, as from two processes that have no order between them.
    bag.write(topic, Stamp{1'000'000'000LL * (10 + i / 2)}, convert::to_cdr(pose));
  }
  bag.close();
}

class CompareResults : public testing::Test {
 protected:
  [[nodiscard]] fs::path expected() const { return folder_.path() / "expected"; }
  [[nodiscard]] fs::path got() const { return folder_.path() / "got"; }
  [[nodiscard]] std::vector<std::string> differences(const Tolerances& tolerances = {}) const {
    std::vector<std::string> texts;
    for (const Difference& difference :
         compare_results(read_results(expected()), read_results(got()), tolerances)) {
      texts.push_back(describe(difference));
    }
    return texts;
  }
  [[nodiscard]] std::vector<std::string> differences_with(
      const std::vector<ToleranceRule>& rules) const {
    Tolerances tolerances;
    tolerances.rules = rules;
    return differences(tolerances);
  }
  [[nodiscard]] const fs::path& folder() const { return folder_.path(); }

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(CompareResults, NamesTheEarliestDifferenceFirstWithItsTimeAndField) {
  write(expected() / "a.tum", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 2 0 0 0 0 0 1\n");
  write(got() / "a.tum", "1 0 0 0 0 0 0 1\n2 1 0.5 0 0 0 0 1\n3 2 0.5 0 0 0 0 1\n");
  write(expected() / "b.tum", "1.5 0 0 0 0 0 0 1\n");
  write(got() / "b.tum", "1.5 0.25 0 0 0 0 0 1\n");
  EXPECT_THAT(differences(),
              ElementsAre("b.tum at 1.500000000 s: x is 0.25, expected 0",
                          "a.tum at 2.000000000 s: y is 0.5, expected 0; 2 of 3 differ"));
}

TEST_F(CompareResults, AllowsWhatTheLastMatchingRuleAllows) {
  write(expected() / "a.tum", "1 100 0 0 0 0 0 1\n");
  write(got() / "a.tum", "1 100.5 0 0 0 0 0 1\n");
  EXPECT_THAT(differences(), SizeIs(1));
  Tolerances tolerances;
  tolerances.absolute = 0.6;
  EXPECT_THAT(differences(tolerances), IsEmpty());
  tolerances = {};
  tolerances.relative = 0.006;
  EXPECT_THAT(differences(tolerances), IsEmpty());
  tolerances = {};
  tolerances.ignore = {"a.tum:x"};
  EXPECT_THAT(differences(tolerances), IsEmpty());
  const ToleranceRule wide{"*.tum:x", 1.0, 0.0};
  const ToleranceRule narrow{"a.tum:*", 0.1, 0.0};
  EXPECT_THAT(differences_with({narrow, wide}), IsEmpty());
  EXPECT_THAT(differences_with({wide, narrow}),
              ElementsAre(HasSubstr("x is 100.5, expected 100 (tolerance 0.1)")));
}

TEST_F(CompareResults, AHeadingATurnAwayIsTheSameWithinATolerance) {
  write(expected() / "a.tum", "1 0 0 0 0 0 1 0.0001\n");
  write(got() / "a.tum", "1 0 0 0 0 0 1 -0.0001\n");
  EXPECT_THAT(differences(), SizeIs(1));
  Tolerances tolerances;
  tolerances.absolute = 0.001;
  EXPECT_THAT(differences(tolerances), IsEmpty());
}

TEST_F(CompareResults, FindsFieldsOfMessages) {
  write_topics(expected(), -1, 0.0);
  write_topics(got(), 3, 0.125);
  EXPECT_THAT(differences(),
              ElementsAre("/scan_pose at 11.000000000 s: map_from_robot.mean.x is 1.625, expected "
                          "1.5; 1 of 4 differ"));
  EXPECT_THAT(differences_with({{"/scan_pose:map_from_robot.mean.*", 0.2, 0.0}}), IsEmpty());
}

TEST_F(CompareResults, MessagesOfOneStampHaveNoOrder) {
  write_topics(expected(), -1, 0.0);
  write_topics(got(), -1, 0.0, {1, 0, 3, 2});
  EXPECT_THAT(differences(), IsEmpty());
}

TEST_F(CompareResults, ALostMessageIsNamedByItsTime) {
  write_topics(expected(), -1, 0.0);
  write_topics(got(), -1, 0.0, {0, 1, 2});
  EXPECT_THAT(differences(), ElementsAre("/scan_pose at 11.000000000 s: number of messages is 3, "
                                         "expected 4; 1 of 4 differ"));
}

TEST_F(CompareResults, JsonIsComparedByFieldAndCostIsNot) {
  write(expected() / "s.json", R"({"em": {"iterations": 6}, "cost": {"wall_s": 1.0}, "a": null})");
  write(got() / "s.json", R"({"em": {"iterations": 7}, "cost": {"wall_s": 2.0}, "a": null})");
  EXPECT_THAT(differences(), ElementsAre("s.json: em.iterations is 7, expected 6"));
}

TEST_F(CompareResults, MapsAreComparedByCell) {
  const std::string yaml =
      "image: m.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
      "free_thresh: 0.25\nmode: trinary\n";
  const std::string head = "P5\n2 2\n255\n";
  write(expected() / "m.yaml", yaml);
  write(got() / "m.yaml", yaml);
  write(expected() / "m.pgm", head + "\xfe\xfe\xfe\xfe");
  write(got() / "m.pgm", head + "\xfe\xfe\xfe" + std::string(1, '\0'));
  EXPECT_THAT(differences(), ElementsAre("m.yaml: cell (1, 0) is 1, expected 0"));
}

TEST_F(CompareResults, MissingFilesDifferAndOthersDoNotMatter) {
  write(expected() / "s.json", "{}");
  write(got() / "more.json", "{}");
  EXPECT_THAT(differences(), ElementsAre("s.json: is missing"));
  EXPECT_THROW((void)read_results(folder() / "none"), InputError);
}

TEST_F(CompareResults, AcceptKeepsTolerancesAndRefusesAFolderOfOtherThings) {
  write(got() / "s.json", "{}");
  write(got() / "strata.db", "bytes");
  accept_results(got(), expected());
  EXPECT_TRUE(fs::exists(expected() / "s.json"));
  EXPECT_FALSE(fs::exists(expected() / "strata.db"));
  EXPECT_EQ(load_tolerances(expected()).ignore, Tolerances{}.ignore);
  write(expected() / kTolerancesFile, "version: 1\nabsolute: 0.5\n");
  accept_results(got(), expected());
  EXPECT_EQ(load_tolerances(expected()).absolute, 0.5);
  write(folder() / "home" / "letter.txt", "dear");
  EXPECT_THROW(accept_results(got(), folder() / "home"), OutputError);
  EXPECT_TRUE(fs::exists(folder() / "home" / "letter.txt"));
}

}  // namespace
}  // namespace strata::expect
