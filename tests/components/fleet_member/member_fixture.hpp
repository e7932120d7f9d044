// SPDX-License-Identifier: Apache-2.0
/// A robot's fleet member beside a server, and what it says of itself.
#pragma once

#include <chrono>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/fleet/visits.hpp"
#include "components/fleet_member/register.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::test {

class MemberFixture : public FleetFixture {
 protected:
  void SetUp() override {
    FleetFixture::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    setenv("PGPASSWORD", kPassword, 1);
    (void)release_first_tour("hall");
    (void)site::Site::create(at("robot"), "hall", "map", ada());
  }
  void TearDown() override {
    host_.reset();
    unsetenv("PGPASSWORD");
  }

  void start(const std::string& more = "", const std::string& pulled = "activate") {
    runtime::Registry registry;
    fleet_member::register_component(registry);
    auto participant = make_participant();
    told_ = std::make_unique<bus::Reader<diagnostic_msgs::msg::DiagnosticArray>>(
        participant, "/diagnostics", bus::qos_profile("default"), [this](const auto& message) {
          const std::lock_guard lock(mutex_);
          for (const auto& status : message.status()) {
            values_ = {{"message", status.message()}, {"level", std::to_string(status.level())}};
            for (const auto& value : status.values()) values_[value.key()] = value.value();
          }
        });
    host_ = make_host(
        "{type: strata::FleetMember, name: fleet, parameters: {server: "
        "'postgresql://hall.r1@/postgres?host=" +
            server_->folder().string() + "', site: hall, maps: ['" + at("maps").string() +
            "'], site_folder: '" + at("robot").string() + "', pulled: " + pulled +
            ", period_s: 0.05, retry: {first_s: 0.02, longest_s: 0.1}" + more + "}}",
        registry, participant);
    host_->activate();
  }
  /// The folder as `strata learn` writes it: whole, in one step.
  void learn(const std::vector<std::vector<PosedScan>>& drives) const {
    std::vector<std::vector<PosedScan>> all{first_tour()};
    all.insert(all.end(), drives.begin(), drives.end());
    write_maps(at("new"), all);
    std::filesystem::remove_all(at("maps"));
    std::filesystem::rename(at("new"), at("maps"));
  }
  /// Of the status that came last; "" for nothing.
  [[nodiscard]] std::string told(const std::string& key) {
    host_->tick();
    const std::lock_guard lock(mutex_);
    const auto found = values_.find(key);
    return found == values_.end() ? "" : found->second;
  }
  [[nodiscard]] bool comes_to_say(const std::string& key, const std::string& text) {
    return comes_true([&] { return told(key).find(text) != std::string::npos; });
  }
  [[nodiscard]] bool comes_to_be(const std::string& key, const std::string& value) {
    return comes_true([&] { return told(key) == value; });
  }
  [[nodiscard]] std::vector<fleet::VisitName> there() const {
    fleet::Connection ada = as("hall.ada");
    return fleet::visit_names(ada, "hall");
  }
  [[nodiscard]] std::string active() const {
    return site::Site(at("robot")).active().value_or("none");
  }
  /// Released by the operator, from maps with one more drive.
  std::string release(std::int64_t begin_s) const {
    const std::string name = "by-ada-" + std::to_string(begin_s);
    write_maps(at(name), {first_tour(), drive(begin_s, 9)}, name);
    site::Site local(at("hall-site"));
    const std::string hash = local.add(at(name), ada(), "").status.version.hash;
    local.approve(hash, ada(), "");
    fleet::Connection ada = as("hall.ada");
    fleet::release(ada, local, hash, name);
    return hash;
  }
  [[nodiscard]] std::string newest() const {
    fleet::Connection ada = as("hall.ada");
    return fleet::newest_released(ada, "hall")->hash;
  }
  /// Until it has asked the server again, from the beginning to the end.
  void wait_for_a_look() {
    using Clock = std::chrono::steady_clock;
    for (int i = 0; i < 2; ++i) {  // the first to end may have begun before
      const Clock::time_point since = Clock::now();
      EXPECT_TRUE(comes_true([&] {
        const std::string age_s = told("last pull, s ago");
        const std::chrono::duration<double> waited = Clock::now() - since;
        return age_s != "never" && std::atof(age_s.c_str()) < waited.count();
      }));
    }
  }
  runtime::Component& member() { return *host_->components().front(); }

  std::mutex mutex_;
  std::map<std::string, std::string> values_;
  std::unique_ptr<bus::Reader<diagnostic_msgs::msg::DiagnosticArray>> told_;
  std::unique_ptr<runtime::Host> host_;
};

}  // namespace strata::test
