// SPDX-License-Identifier: Apache-2.0
/// A robot as a process of its own, for benchmarks:
///
///   robot_process DOMAIN TRANSPORT drive SCOPE SCANS READERS located|alone
///       drives round the block at 40 Hz, its scans reliable on SCOPE/scan; located: somebody
///       answers on SCOPE/amcl_pose. "sent S poses P late L median M p99 Q", in ms; late: than the
///       next scan
///   robot_process DOMAIN TRANSPORT hop SCANS
///       scans on /scan, one every 2 ms, stamped with the steady clock when handed over. "sent S"
///
/// Says "ready" when its readers are there, and begins when its input ends.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/ring_drive.hpp"

namespace strata::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kPatience = std::chrono::seconds(60);
constexpr std::size_t kWarmUp = 40;  // the filter narrows, the middleware allocates

void wait_for_the_start() {
  std::cout << "ready" << std::endl;
  while (std::cin.get() != EOF) {
  }
}

/// Poses of the robot's own scans.
class Answers {
 public:
  Answers(const std::shared_ptr<bus::Participant>& participant, const std::string& scope)
      : reader_(participant, scope + "/amcl_pose", bus::qos_profile("default"),
                [this](const geometry_msgs::msg::PoseWithCovarianceStamped& pose) {
                  const Clock::time_point now = Clock::now();
                  const std::lock_guard lock(mutex_);
                  came_.try_emplace(convert::from_message(pose.header().stamp()).ns, now);
                }) {}
  /// After handing over [ms], in order; of the scans that were answered.
  [[nodiscard]] std::vector<double> latencies_ms(
      const std::map<std::int64_t, Clock::time_point>& sent) {
    const std::lock_guard lock(mutex_);
    std::vector<double> each_ms;
    for (const auto& [stamp, at] : sent) {
      const auto came = came_.find(stamp);
      if (came == came_.end()) continue;
      each_ms.push_back(std::chrono::duration<double, std::milli>(came->second - at).count());
    }
    std::sort(each_ms.begin(), each_ms.end());
    return each_ms;
  }

 private:
  std::mutex mutex_;
  std::map<std::int64_t, Clock::time_point> came_;
  bus::Reader<geometry_msgs::msg::PoseWithCovarianceStamped> reader_;
};

int drive(const std::shared_ptr<bus::Participant>& participant, const std::string& scope,
          std::size_t scans, int readers, bool is_located) {
  std::vector<Observation> log = ring_log();
  log.resize(std::min(scans, log.size()));
  Robot robot(participant, scope, "default");
  Answers answers(participant, scope);
  robot.tell_mounting();
  if (!robot.scans.raw().wait_for_readers(readers, kPatience) ||
      (is_located && !robot.odometry.raw().wait_for_readers(1, kPatience))) {
    return 1;
  }
  wait_for_the_start();
  std::map<std::int64_t, Clock::time_point> sent;
  const Clock::time_point start = Clock::now();
  for (std::size_t i = 0; i < log.size(); ++i) {
    std::this_thread::sleep_until(start + static_cast<int>(i) * kPeriod);
    const Clock::time_point handed_over = robot.see(log[i]);
    if (i >= kWarmUp) sent[log[i].scan.stamp.ns] = handed_over;
  }
  const Clock::time_point end = Clock::now() + std::chrono::seconds(2);
  while (is_located && Clock::now() < end && answers.latencies_ms(sent).size() < sent.size()) {
    std::this_thread::sleep_for(kPeriod);
  }
  const std::vector<double> each_ms = answers.latencies_ms(sent);
  const double period_ms = std::chrono::duration<double, std::milli>(kPeriod).count();
  const auto late = each_ms.end() - std::upper_bound(each_ms.begin(), each_ms.end(), period_ms);
  const auto at = [&](double share) {
    return each_ms.empty()
               ? 0.0
               : each_ms[static_cast<std::size_t>(share * static_cast<double>(each_ms.size() - 1))];
  };
  std::printf("sent %zu poses %zu late %td median %.3f p99 %.3f\n", sent.size(), each_ms.size(),
              late, at(0.5), at(0.99));
  return 0;
}

int hop(const std::shared_ptr<bus::Participant>& participant, std::size_t scans) {
  bus::Writer<sensor_msgs::msg::LaserScan> writer(participant, "/scan",
                                                  bus::qos_profile("sensor_data"));
  if (!writer.raw().wait_for_readers(1, kPatience)) return 1;
  wait_for_the_start();
  auto cdr = convert::to_cdr(convert::to_message(ring_log().front().scan, "laser"));
  for (std::size_t i = 0; i < scans; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const std::int64_t now_ns = std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
    const auto sec = static_cast<std::int32_t>(now_ns / 1'000'000'000);
    const auto nanosec = static_cast<std::uint32_t>(now_ns % 1'000'000'000);
    std::memcpy(cdr.data() + 4, &sec, sizeof sec);  // the stamp comes first
    std::memcpy(cdr.data() + 8, &nanosec, sizeof nanosec);
    writer.raw().publish(cdr);
  }
  std::printf("sent %zu\n", scans);
  return 0;
}

int run(const std::vector<std::string>& words) {
  bus::ParticipantOptions options;
  options.domain = std::stoi(words.at(0));
  options.transport = bus::transport_from_name(words.at(1));
  const auto participant = std::make_shared<bus::Participant>(options);
  if (words.at(2) == "hop") return hop(participant, std::stoul(words.at(3)));
  return drive(participant, words.at(3), std::stoul(words.at(4)), std::stoi(words.at(5)),
               words.at(6) == "located");
}

}  // namespace
}  // namespace strata::bench

int main(int argc, char** argv) { return strata::bench::run({argv + 1, argv + argc}); }
