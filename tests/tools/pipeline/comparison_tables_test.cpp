// SPDX-License-Identifier: Apache-2.0
/// What the report of a comparison says of pairs: differences in a row each, all else once.
#include "tools/pipeline/comparison_tables.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/pipeline/comparison.hpp"

namespace strata::pipeline {
namespace {

using Groups = std::vector<std::vector<std::string>>;

Comparison comparison_of(const std::vector<std::string>& names) {
  Comparison comparison;
  for (const std::string& name : names) comparison.models.emplace_back().model = name;
  return comparison;
}

PairedTest pair_of(const std::string& better, const std::string& worse, bool significant) {
  PairedTest test;
  test.better = better;
  test.worse = worse;
  test.mean_difference_m = 0.02;
  test.ci95_m = significant ? statistics::Interval{0.01, 0.04} : statistics::Interval{-0.06, 0.05};
  test.p = significant ? 0.001 : 1.0;
  test.significant = significant;
  return test;
}

std::string page_of(const Comparison& comparison, const std::vector<PairedTest>& tests) {
  report::HtmlReport page(".", "");
  add_pairs(comparison, tests, page);
  return page.body();
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) {
    ++found;
  }
  return found;
}

TEST(ComparisonPairs, WithoutADifferenceAreSaidOnce) {
  const std::vector<PairedTest> tests{pair_of("b", "a", false), pair_of("a", "c", false),
                                      pair_of("b", "c", false)};
  const std::string page = page_of(comparison_of({"a", "b", "c"}), tests);
  EXPECT_EQ(count(page, "No difference shown"), 1U) << page;
  EXPECT_NE(page.find("between a, b and c, neither"), std::string::npos) << page;
  EXPECT_NE(page.find("reach to 0.060 m"), std::string::npos) << "the farthest end of an interval";
  EXPECT_EQ(page.find("<table"), std::string::npos) << page;
}

TEST(ComparisonPairs, WithADifferenceHaveARowEach) {
  const std::vector<PairedTest> tests{pair_of("a", "b", false), pair_of("a", "c", true),
                                      pair_of("b", "c", true)};
  const std::string page = page_of(comparison_of({"a", "b", "c"}), tests);
  EXPECT_EQ(count(page, "<th scope=\"row\">"), 2U) << page;
  EXPECT_NE(page.find("between a and b, neither"), std::string::npos) << page;
  EXPECT_NE(page.find("<dt>p (Holm)</dt>"), std::string::npos) << "explained where it stands";
  EXPECT_NE(page.find("<dt>Cliff&#39;s delta</dt>"), std::string::npos) << page;
}

TEST(ComparisonPairs, ThatDifferOnlyInLostRunsHaveARow) {
  PairedTest test = pair_of("a", "b", false);
  test.lost_only_worse = 12;
  test.p_lost = 0.001;
  const std::string page = page_of(comparison_of({"a", "b"}), {test});
  EXPECT_EQ(count(page, "<th scope=\"row\">"), 1U) << page;
  EXPECT_NE(page.find("<td>lost runs</td>"), std::string::npos) << page;
  EXPECT_EQ(page.find("No difference shown"), std::string::npos) << page;
}

TEST(ComparisonPairs, AreGroupedOnlyWhereNoTwoDiffer) {
  // a and c differ, b is alike to both; d to all.
  const std::vector<PairedTest> tests{pair_of("a", "b", false), pair_of("a", "c", true),
                                      pair_of("a", "d", false), pair_of("b", "c", false),
                                      pair_of("b", "d", false), pair_of("d", "c", false)};
  EXPECT_EQ(alike_models(comparison_of({"a", "b", "c", "d"}), tests),
            (Groups{{"a", "b", "d"}, {"b", "c", "d"}}));
}

TEST(ComparisonPairs, OfOneModelAreNothingToTellOf) {
  EXPECT_EQ(page_of(comparison_of({"a"}), {}), "");
}

}  // namespace
}  // namespace strata::pipeline
