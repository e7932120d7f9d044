// SPDX-License-Identifier: Apache-2.0
/// A site of a hall, and small maps for its versions.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/site/site.hpp"
#include "core/base/error.hpp"
#include "tests/components/site/small_maps.hpp"
#include "tests/support/test_data.hpp"

namespace strata::test {

class SiteTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path at(const std::string& name) const {
    return folder_.path() / name;
  }
  site::Site make() const { return site::Site::create(at("hall"), "hall-3", "map", kAda); }
  /// Adds maps that differ by `mark`; their hash.
  std::string add(site::Site& site, const std::string& mark) const {
    write_small_maps(at("maps-" + mark), mark);
    return site.add(at("maps-" + mark), kAda, mark).status.version.hash;
  }
  std::string activated(site::Site& site, const std::string& mark) const {
    const std::string hash = add(site, mark);
    site.approve(hash, kAda, "seen");
    (void)site.activate(hash, kAda);
    return hash;
  }
  [[nodiscard]] static std::vector<std::string> states(const site::Site& site) {
    std::vector<std::string> all;
    for (const site::VersionStatus& status : site.versions())
      all.emplace_back(site::name_of(status.state));
    return all;
  }
  [[nodiscard]] static std::string error_of(const std::function<void()>& body) {
    try {
      body();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  TemporaryDirectory folder_;
};

}  // namespace strata::test
