// SPDX-License-Identifier: Apache-2.0
/// Citations in the code, `[key, eq. (1)]`, against docs/references.bib.
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/structure/source_tree.hpp"

namespace strata::test {
namespace {

std::vector<std::string> all_matches(const std::string& text, const std::regex& pattern,
                                     int group) {
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern); it != std::sregex_iterator();
       ++it) {
    found.push_back((*it)[static_cast<std::size_t>(group)].str());
  }
  return found;
}

/// Keys cited in comments: name, year, word, at the start of square brackets or after a comma or
/// semicolon inside them.
std::vector<std::string> cited_keys(const std::string& text) {
  static const std::regex comment(R"(//[^\n]*)");
  static const std::regex citation(R"(\[([a-z]+[0-9]{4}[a-z]+[^\]]*)\])");
  static const std::regex key(R"((^|[;,] ?)([a-z]+[0-9]{4}[a-z]+))");
  // Comment lines are joined first: a citation may be broken over two.
  std::string comments;
  for (std::string line : all_matches(text, comment, 0)) {
    line.erase(0, line.find_first_not_of('/'));
    comments += line;
  }
  std::vector<std::string> keys;
  for (const std::string& inside : all_matches(comments, citation, 1)) {
    for (const std::string& found : all_matches(inside, key, 2)) keys.push_back(found);
  }
  return keys;
}

TEST(References, HoldEveryKeyThatTheCodeCites) {
  static const std::regex entry(R"(@[a-z]+\{([^,\s]+),)");
  const auto listed = all_matches(read_text(source_root() / "docs/references.bib"), entry, 1);
  const std::set<std::string> known(listed.begin(), listed.end());
  ASSERT_FALSE(known.empty());
  EXPECT_EQ(known.size(), listed.size()) << "a key is there twice";
  std::set<std::string> missing;
  std::size_t citations = 0;
  for (const Source& source : read_sources({"core", "memory", "components", "tools", "tests"})) {
    for (const std::string& key : cited_keys(source.text)) {
      ++citations;
      if (known.count(key) == 0) missing.insert(source.path + ": [" + key + "]");
    }
  }
  EXPECT_GT(citations, 10U);
  EXPECT_THAT(missing, testing::IsEmpty());
}

TEST(References, AreFoundInEveryFormOfCitation) {
  const std::string year = "2003";  // built at run time, or this file would cite them
  const std::string a = "/// [a" + year + "x] and [b" + year + "y, eq. (1)] and\n";
  const std::string b = "/// [c" + year + "z; d" + year + "w section 2,\n/// e" + year + "v]\n";
  EXPECT_THAT(cited_keys(a + b + "int f" + year + "g[f" + year + "g];"),
              testing::ElementsAre("a" + year + "x", "b" + year + "y", "c" + year + "z",
                                   "d" + year + "w", "e" + year + "v"));
}

}  // namespace
}  // namespace strata::test
