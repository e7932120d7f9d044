// SPDX-License-Identifier: Apache-2.0
/// What the fuzz target `cdr` and its seeds name, against the messages and services of the code.
#include <cctype>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/structure/source_tree.hpp"

namespace strata::test {
namespace {

using testing::IsSupersetOf;

std::vector<std::string> groups(const std::string& text, const std::regex& pattern) {
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern); it != std::sregex_iterator();
       ++it) {
    found.push_back((*it)[1].str());
  }
  return found;
}

std::set<std::string> groups_of_components(const std::regex& pattern) {
  std::set<std::string> found;
  for (const Source& source : read_sources({"components"})) {
    for (std::string& name : groups(source.text, pattern)) found.insert(std::move(name));
  }
  return found;
}

std::string fuzzer() { return read_text(source_root() / "tests/fuzz/cdr_fuzzer.cpp"); }

/// In the order of its table.
std::vector<std::string> fuzzed_services() {
  static const std::regex entry(R"(serve<srv::(\w+)>)");
  return groups(fuzzer(), entry);
}

/// "GetState" as "get_state".
std::string snake(const std::string& name) {
  std::string text;
  for (const char c : name) {
    if (std::isupper(static_cast<unsigned char>(c)) != 0 && !text.empty()) text += '_';
    text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return text;
}

TEST(FuzzCorpus, HasARequestOfEveryServiceInBothStyles) {
  static const std::regex offered(R"(STRATA_\w*SERVICE_TYPE\((?:\w+, )?(\w+)\);)");
  const std::vector<std::string> services = fuzzed_services();
  ASSERT_GT(services.size(), 20U);
  EXPECT_EQ(std::set<std::string>(services.begin(), services.end()), groups_of_components(offered));
  for (std::size_t place = 0; place < services.size(); ++place) {
    const auto seed = [&](const std::string& prefix) {
      return read_text(source_root() / "tests/fuzz/corpus/cdr" / (prefix + snake(services[place])));
    };
    const std::string plain = seed("request_");
    const std::string of_cyclone = seed("request_of_cyclone_");
    ASSERT_GT(plain.size(), 6U) << services[place];
    ASSERT_GT(of_cyclone.size(), 22U) << services[place];
    EXPECT_EQ(static_cast<unsigned char>(plain[1]), place) << services[place];
    EXPECT_EQ(static_cast<unsigned char>(of_cyclone[1]), 128 + place) << services[place];
  }
}

TEST(FuzzCorpus, KnowsEveryMessageThatAComponentReads) {
  static const std::regex read(R"((?:subscribe|from_cdr)<(\w+::msg::\w+)>)");
  static const std::regex known(R"((\w+::msg::\w+)>)");
  const std::set<std::string> messages = groups_of_components(read);
  ASSERT_GT(messages.size(), 10U);
  EXPECT_THAT(groups(fuzzer(), known), IsSupersetOf(messages));
}

}  // namespace
}  // namespace strata::test
