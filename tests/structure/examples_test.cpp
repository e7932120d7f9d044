// SPDX-License-Identifier: Apache-2.0
/// Programs that pages show against examples/, which install_test.cmake builds and runs.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/structure/source_tree.hpp"

namespace strata::test {
namespace {

/// The text of every ```cpp or ```cmake block of a page.
std::vector<std::string> blocks_of(const std::string& page, const std::string& language) {
  const std::string open = "```" + language + "\n";
  std::vector<std::string> blocks;
  for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at)) {
    at += open.size();
    const std::size_t end = page.find("```", at);
    blocks.push_back(page.substr(at, end - at));
  }
  return blocks;
}

std::string example(const std::string& file) {
  return read_text(source_root() / "examples" / file);
}

/// Without the line of the license.
std::string program(const std::string& name) {
  const std::string text = example(name + "/" + name + ".cpp");
  return text.substr(text.find('\n') + 1);
}

TEST(Examples, AreWhatThePageOfTheLibraryShows) {
  const std::string page = read_text(source_root() / "docs/use-as-a-library.md");
  EXPECT_THAT(blocks_of(page, "cpp"),
              testing::ElementsAre(program("localize_in_a_map"), program("learn_from_scans")));
  const std::vector<std::string> builds = blocks_of(page, "cmake");
  ASSERT_EQ(builds.size(), 2U);
  EXPECT_THAT(example("localize_in_a_map/CMakeLists.txt"), testing::EndsWith(builds[0]));
  EXPECT_THAT(example("learn_from_scans/CMakeLists.txt"), testing::EndsWith(builds[1]));
}

TEST(Examples, AreWhatThePageOfOwnComponentsShows) {
  const std::string page = read_text(source_root() / "docs/own-components.md");
  const std::vector<std::string> shown = blocks_of(page, "cpp");
  ASSERT_FALSE(shown.empty());
  EXPECT_EQ(shown.front(), program("obstacle_alarm"));
  const std::vector<std::string> builds = blocks_of(page, "cmake");
  ASSERT_EQ(builds.size(), 1U);
  EXPECT_THAT(example("obstacle_alarm/CMakeLists.txt"), testing::HasSubstr("\n" + builds[0]));
  EXPECT_THAT(blocks_of(page, "yaml"),
              testing::ElementsAre(example("obstacle_alarm/composition.yaml")));
}

TEST(Examples, AreWhatTheReadmeShows) {
  const std::string readme = read_text(source_root() / "README.md");
  const std::vector<std::string> shown = blocks_of(readme, "cpp");
  ASSERT_EQ(shown.size(), 1U);
  ASSERT_GT(shown[0].size(), 500U);
  EXPECT_THAT(program("localize_in_a_map"), testing::HasSubstr(shown[0]));
  EXPECT_THAT(readme, testing::HasSubstr("(docs/use-as-a-library.md)"));
}

}  // namespace
}  // namespace strata::test
