// SPDX-License-Identifier: Apache-2.0
/// A localizer whose maps are a site's, with two approved versions of the same room.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/site/site.hpp"
#include "tests/components/localizer/live_fixture.hpp"

namespace strata::localizer {

namespace fs = std::filesystem;

inline const site::Actor kAda{"ada", 1'000'000'000};

class LiveSite : public LiveLocalizer {
 protected:
  LiveSite() {
    host_.reset();
    site_.emplace(site::Site::create(folder_.path() / "hall", "hall-3", "map", kAda));
    hashes_.push_back(add(room().folder.path()));
    // The same room, as another run would have left it.
    const fs::path other = folder_.path() / "other";
    fs::copy(room().folder.path(), other, fs::copy_options::recursive);
    std::ofstream(other / "trajectory.tum", std::ios::app) << "\n";
    hashes_.push_back(add(other));
    (void)site_->activate(hashes_[0], kAda);
    start(parameters_in(site_->folder()));
  }

  [[nodiscard]] static std::string parameters_in(const fs::path& maps) {
    std::string text = parameters_of("filtered", false);
    const std::string before = room().folder.path().string();
    return text.replace(text.find(before), before.size(), maps.string());
  }

  std::string add(const fs::path& maps) {
    const std::string hash = site_->add(maps, kAda, "").status.version.hash;
    site_->approve(hash, kAda, "");
    return hash;
  }

  [[nodiscard]] double error_of(const geometry_msgs::msg::PoseWithCovarianceStamped& pose) const {
    const Stamp stamp = convert::from_message(pose.header().stamp());
    std::size_t scan = 0;
    while (room().observations[scan].scan.stamp != stamp) ++scan;
    return translation_distance(planar(convert::from_message(pose.pose().pose())),
                                room().truth[scan]);
  }

  test::TemporaryDirectory folder_;
  std::optional<site::Site> site_;
  std::vector<std::string> hashes_;
};

}  // namespace strata::localizer
