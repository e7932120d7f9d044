// SPDX-License-Identifier: Apache-2.0
/// Citations in the code: of papers, `[key, eq. (1)]`, against docs/references.bib; of the pages of
/// theory, by page and heading, against those.
#include <cstddef>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
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

/// Keys cited in a text of one line: name, year, word, at the start of square brackets or after a
/// comma or semicolon inside them.
std::vector<std::string> keys_in(const std::string& text) {
  static const std::regex citation(R"(\[([a-z]+[0-9]{4}[a-z]+[^\]]*)\])");
  static const std::regex key(R"((^|[;,] ?)([a-z]+[0-9]{4}[a-z]+))");
  std::vector<std::string> keys;
  for (const std::string& inside : all_matches(text, citation, 1)) {
    for (const std::string& found : all_matches(inside, key, 2)) keys.push_back(found);
  }
  return keys;
}

/// Keys cited in comments.
std::vector<std::string> cited_keys(const std::string& text) {
  static const std::regex comment(R"(//[^\n]*)");
  // Comment lines are joined first: a citation may be broken over two.
  std::string comments;
  for (std::string line : all_matches(text, comment, 0)) {
    line.erase(0, line.find_first_not_of('/'));
    comments += line;
  }
  return keys_in(comments);
}

/// The text on one line, without the marks that begin lines of comments and headings.
std::string on_one_line(const std::string& text) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t begin = line.find_first_not_of(" /#");
    if (begin != std::string::npos) result += line.substr(begin) + ' ';
  }
  return result;
}

/// A page of theory that a text names.
struct TheoryCitation {
  std::string page;                   ///< "slam.md"
  std::vector<std::string> headings;  ///< quoted behind it: `, "One"`, then `and "Another"`
};

std::vector<TheoryCitation> theory_citations(const std::string& text) {
  static const std::string folder = "docs/theory/";
  const std::string flat = on_one_line(text);
  std::vector<TheoryCitation> citations;
  for (std::size_t at = flat.find(folder); at != std::string::npos; at = flat.find(folder, at)) {
    at += folder.size();
    const std::size_t end = flat.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_", at);
    if (end == std::string::npos || flat.compare(end, 3, ".md") != 0) continue;
    citations.push_back({flat.substr(at, end - at) + ".md", {}});
    at = end + 3;
    std::string before = ", \"";
    while (flat.compare(at, before.size(), before) == 0) {
      at += before.size();
      const std::size_t close = flat.find('"', at);
      if (close == std::string::npos) break;
      citations.back().headings.push_back(flat.substr(at, close - at));
      at = close + 1;
      before = " and \"";
    }
  }
  return citations;
}

/// The headings of a page, without their numbers.
std::set<std::string> headings_of(const std::string& page) {
  static const std::regex heading(R"((^|\n)#+ (?:[0-9]+\. )?([^\n]+))");
  const auto found = all_matches(page, heading, 2);
  return {found.begin(), found.end()};
}

/// The pages of theory by name.
std::map<std::string, std::string> theory_pages() {
  std::map<std::string, std::string> pages;
  for (const auto& entry : std::filesystem::directory_iterator(source_root() / "docs/theory")) {
    pages[entry.path().filename().string()] = read_text(entry.path());
  }
  return pages;
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
  for (const auto& [page, text] : theory_pages()) {
    for (const std::string& key : keys_in(on_one_line(text))) {
      if (known.count(key) == 0) missing.insert(page + ": [" + key + "]");
    }
  }
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

TEST(Theory, HasEveryPageAndHeadingThatTheCodeCites) {
  std::map<std::string, std::set<std::string>> headings;
  for (const auto& [page, text] : theory_pages()) headings[page] = headings_of(text);
  std::set<std::string> missing;
  std::size_t citations = 0;
  for (const Source& source : read_sources({"core", "memory", "components", "tools", "tests"},
                                           {".hpp", ".cpp", ".yaml"})) {
    for (const TheoryCitation& citation : theory_citations(source.text)) {
      ++citations;
      const auto page = headings.find(citation.page);
      if (page == headings.end()) {
        missing.insert(source.path + ": " + citation.page);
        continue;
      }
      for (const std::string& heading : citation.headings) {
        if (page->second.count(heading) > 0) continue;
        missing.insert(source.path + ": " + citation.page + ", \"" + heading + "\"");
      }
    }
  }
  EXPECT_GT(citations, 10U);
  EXPECT_THAT(missing, testing::IsEmpty());
}

TEST(Theory, IsFoundInEveryFormOfCitation) {
  const std::string folder = std::string("docs/") + "theory/";  // or this file would cite them
  const auto found = theory_citations(
      "/// (" + folder + "a.md, \"B\n  /// c\" and \"D\"), and\n# " + folder + "e_1.md; " + folder);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].page, "a.md");
  EXPECT_THAT(found[0].headings, testing::ElementsAre("B c", "D"));
  EXPECT_EQ(found[1].page, "e_1.md");
  EXPECT_THAT(found[1].headings, testing::IsEmpty());
  EXPECT_THAT(headings_of("# A b\n\n## 12. C\ntext # d\n"), testing::ElementsAre("A b", "C"));
}

}  // namespace
}  // namespace strata::test
