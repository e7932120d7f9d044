// SPDX-License-Identifier: Apache-2.0
/// A server with two sites, and small maps with visits.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/fleet/schema.hpp"
#include "components/fleet/versions.hpp"
#include "components/site/site.hpp"
#include "core/random/stream.hpp"
#include "tests/components/fleet/postgres_server.hpp"
#include "tests/components/site/small_maps.hpp"

namespace strata::test {

inline constexpr const char* kPassword = "robots-secret";

/// A short drive that begins at second `begin_s`; `who` makes it another one.
inline std::vector<PosedScan> drive(std::int64_t begin_s, std::uint64_t who,
                                    std::size_t beams = 60) {
  RandomStream random(who * 1'000'003 + static_cast<std::uint64_t>(begin_s), StreamId::kTest);
  std::vector<PosedScan> scans(20);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    scans[i].scan.stamp = {(begin_s * 10 + static_cast<std::int64_t>(i)) * 100'000'000};
    scans[i].map_from_robot = {0.1 * static_cast<double>(i), random.normal(), 0.0};
    scans[i].scan.angle_increment_rad = 0.01F;
    scans[i].scan.range_max_m = 30.0F;
    scans[i].scan.ranges_m.resize(beams);
    for (float& range_m : scans[i].scan.ranges_m) {
      range_m = static_cast<float>(random.exponential(5.0));
    }
  }
  return scans;
}

/// A MAPS folder with these drives as runs 0, 1, ...
inline void write_maps(const std::filesystem::path& folder,
                       const std::vector<std::vector<PosedScan>>& drives,
                       const std::string& mark = "maps") {
  write_small_maps(folder, mark);
  memory::Store store(folder / maps::kStoreFile);
  for (std::size_t run = 0; run < drives.size(); ++run) {
    store.save_scans(static_cast<int>(run), drives[run]);
  }
}

/// The first tour of every site here.
inline std::vector<PosedScan> first_tour() { return drive(1, 0); }

/// Who does things in sites here.
inline site::Actor ada() { return {"ada", 1'800'000'000'000'000'000}; }

class FleetFixture : public testing::Test {
 protected:
  void SetUp() override {
    STRATA_REQUIRE_POSTGRES();
    server_.emplace();
    fleet::Connection admin = server_->admin();
    (void)fleet::apply_schema(admin);
    for (const char* site : {"hall", "yard"}) add_site(site);
  }

  [[nodiscard]] std::filesystem::path at(const std::string& name) const {
    return folder_.path() / name;
  }
  /// On the server, with robots r1 and r2 and operator ada.
  void add_site(const std::string& site) const {
    fleet::Connection admin = server_->admin();
    (void)fleet::add_site(admin, site, "map");
    for (const char* robot : {"r1", "r2"}) add_robot(site, robot);
    (void)fleet::add_member(admin, fleet::MemberKind::kOperator, site, "ada", kPassword);
  }
  void add_robot(const std::string& site, const std::string& robot) const {
    fleet::Connection admin = server_->admin();
    (void)fleet::add_member(admin, fleet::MemberKind::kRobot, site, robot, kPassword);
  }
  [[nodiscard]] fleet::Connection as(const std::string& role) const {
    return fleet::Connection(server_->url(role, kPassword));
  }
  /// A local site of that name whose version of the first tour is released; its hash.
  std::string release_first_tour(const std::string& site) const {
    write_maps(at(site + "-first"), {first_tour()}, site);
    site::Site local = site::Site::create(at(site + "-site"), site, "map", ada());
    const std::string hash = local.add(at(site + "-first"), ada(), "").status.version.hash;
    local.approve(hash, ada(), "");
    fleet::Connection connection = as(site + ".ada");
    fleet::release(connection, local, hash, "first tour");
    return hash;
  }

  TemporaryDirectory folder_;
  std::optional<PostgresServer> server_;
};

}  // namespace strata::test
