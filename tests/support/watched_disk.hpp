// SPDX-License-Identifier: Apache-2.0
/// A disk that writes down what is done to it, and may stop working after some steps.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "components/log/disk.hpp"

namespace strata::test {

class WatchedDisk : public log::Disk {
 public:
  /// Called before every step with its number, from 0.
  std::function<void(std::size_t)> before_step = [](std::size_t) {};
  bool can_exchange = true;

  void sync(const std::filesystem::path& path) const override {
    step("sync " + name_of(path));
    Disk::sync(path);
  }
  void rename(const std::filesystem::path& from, const std::filesystem::path& to) const override {
    step("rename " + name_of(from) + " to " + name_of(to));
    Disk::rename(from, to);
  }
  [[nodiscard]] bool exchange(const std::filesystem::path& a,
                              const std::filesystem::path& b) const override {
    if (!can_exchange) return false;
    step("exchange " + name_of(a) + " and " + name_of(b));
    return Disk::exchange(a, b);
  }
  void remove(const std::filesystem::path& path) const override {
    step("remove " + name_of(path));
    Disk::remove(path);
  }
  /// Names without their folders; numbers of processes are left out.
  [[nodiscard]] const std::vector<std::string>& steps() const { return steps_; }

 private:
  static std::string name_of(const std::filesystem::path& path) {
    std::string name = path.filename().string();
    const auto mark = name.find(".partial-");
    return mark == std::string::npos ? name : name.substr(0, mark) + ".partial";
  }
  void step(const std::string& what) const {
    before_step(steps_.size());
    steps_.push_back(what);
  }
  mutable std::vector<std::string> steps_;
};

}  // namespace strata::test
