// SPDX-License-Identifier: Apache-2.0
/// How long the first call of a client that was just made takes, against later ones: our own
/// client, and one of ROS 2 on Cyclone DDS where that is installed. docs/networks.md has the
/// figures.
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "components/bus/service.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/filter_composition.hpp"
#ifdef STRATA_CYCLONE_PEER
#include "tests/interop/cyclone/process.hpp"
#endif

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kClients = 40;
constexpr int kCallsEach = 50;

/// A process whose component answers services of its life.
class Server {
 public:
  Server() {
    const std::filesystem::path file = test::write_filter_composition(folder_.path());
    child_ = std::make_unique<test::ChildProcess>(
        std::vector<std::string>{STRATA_PROGRAM, "run", file.string()}, std::vector<std::string>{},
        test::ChildProcess::Errors::kMerged);
    runs_ = !child_->wait_for_line("process p runs").empty();
  }
  [[nodiscard]] bool runs() const { return runs_; }

 private:
  test::TemporaryDirectory folder_;
  std::unique_ptr<test::ChildProcess> child_;
  bool runs_ = false;
};

/// Times of calls, in ms.
struct Calls {
  std::vector<double> first_ms;
  std::vector<double> later_ms;
};

double at(std::vector<double> each, double share) {
  if (each.empty()) return 0.0;
  std::sort(each.begin(), each.end());
  return each[static_cast<std::size_t>(share * static_cast<double>(each.size() - 1))];
}

void tell(benchmark::State& state, const Calls& calls) {
  state.counters["clients"] = static_cast<double>(calls.first_ms.size());
  state.counters["first_median_ms"] = at(calls.first_ms, 0.5);
  state.counters["first_p95_ms"] = at(calls.first_ms, 0.95);
  state.counters["first_max_ms"] = at(calls.first_ms, 1.0);
  state.counters["first_over_10_ms"] = static_cast<double>(std::count_if(
      calls.first_ms.begin(), calls.first_ms.end(), [](double ms) { return ms > 10; }));
  state.counters["later_median_ms"] = at(calls.later_ms, 0.5);
  state.counters["later_p95_ms"] = at(calls.later_ms, 0.95);
}

/// Ours finds the server in its first call.
void own_client(benchmark::State& state) {
  const Server server;
  if (!server.runs()) return state.SkipWithError("strata run does not run");
  const auto participant = test::make_participant();
  const auto request = convert::to_cdr(lifecycle_msgs::srv::GetState_Request());
  Calls calls;
  for (auto _ : state) {
    for (int i = 0; i < kClients; ++i) {
      bus::ServiceClient client(participant, "/filter/get_state", "lifecycle_msgs/srv/GetState");
      for (int call = 0; call < kCallsEach; ++call) {
        const Clock::time_point begin = Clock::now();
        if (!client.call(request, std::chrono::seconds(20))) {
          return state.SkipWithError("nobody answers");
        }
        const double took_ms =
            std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
        (call == 0 ? calls.first_ms : calls.later_ms).push_back(took_ms);
      }
    }
  }
  tell(state, calls);
}
BENCHMARK(own_client)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();

#ifdef STRATA_CYCLONE_PEER
/// A process each, which knows the server when it calls, as rclcpp's wait_for_service has it.
void cyclone_client(benchmark::State& state) {
  const Server server;
  if (!server.runs()) return state.SkipWithError("strata run does not run");
  Calls calls;
  for (auto _ : state) {
    for (int i = 0; i < kClients; ++i) {
      test::CycloneProcess client({"time_get_state", "/filter", std::to_string(kCallsEach)});
      std::istringstream line(client.wait_for_line("took"));
      std::string word;
      line >> word;
      bool is_first = true;
      for (double took_ms = 0.0; line >> took_ms; is_first = false) {
        (is_first ? calls.first_ms : calls.later_ms).push_back(took_ms);
      }
      if (is_first) return state.SkipWithError("nobody answers");
    }
  }
  tell(state, calls);
}
BENCHMARK(cyclone_client)->Iterations(1)->Unit(benchmark::kSecond)->UseRealTime();
#endif

}  // namespace
}  // namespace strata
