// SPDX-License-Identifier: Apache-2.0
/// `strata site` in a folder of its own.
#pragma once

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/components/site/small_maps.hpp"
#include "tests/tools/strata/program.hpp"

namespace strata::tools {

class SiteVerb : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path at(const std::string& name) const {
    return folder_.path() / name;
  }
  [[nodiscard]] test::Outcome site(const std::string& action, const std::string& rest = "") const {
    return test::run_strata("site " + action + " " + test::quoted(at("site")) + " " + rest +
                            " 2>&1");
  }
  [[nodiscard]] nlohmann::json ask(const std::string& action, const std::string& rest = "") const {
    const test::Outcome outcome = site(action, rest + " --json");
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    return nlohmann::json::parse(outcome.out, nullptr, false);
  }
  /// Adds small maps and approves them without a look.
  [[nodiscard]] std::string approved(const std::string& mark) const {
    test::write_small_maps(at(mark), mark);
    const std::string hash = ask("add", test::quoted(at(mark)))["mapHash"];
    EXPECT_EQ(site("approve", hash + " --unchecked --note 'small maps'").code, 0);
    return hash;
  }
  test::TemporaryDirectory folder_;
};

}  // namespace strata::tools
