// SPDX-License-Identifier: Apache-2.0
#include "components/log/set_back_clock.hpp"

#include <algorithm>
#include <cstdint>
#include <iomanip>
#include <map>
#include <sstream>

#include "components/log/set_back_watch.hpp"

namespace strata::log {
namespace {

constexpr double kMinPeriods = 2.5;
/// Neighbours nearer than this many periods have no message missing between them.
constexpr double kNoHole = 1.5;

Duration median_period(const std::vector<Stamp>& stamps) {
  std::vector<std::int64_t> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) steps.push_back((stamps[i] - stamps[i - 1]).ns);
  }
  if (steps.empty()) return {};
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return {*middle};
}

/// Mended stamps and whose they are.
using Recorded = std::map<Stamp, std::size_t>;

/// Whether the messages about that time leave no room for another: before all of them there is
/// only what a clock makes up.
bool is_taken(const Recorded& recorded, Stamp stamp, double period_s) {
  const auto after = recorded.lower_bound(stamp);
  if (after == recorded.begin() || after->first == stamp) return true;
  return (after->first - std::prev(after)->first).seconds() <= kNoHole * period_s;
}

}  // namespace

std::string SetBackClock::sentence() const {
  if (times == 0) return "";
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "the clock was set back " << times
       << (times == 1 ? " time, by " : " times, by at most ") << furthest_s << " s, first at "
       << first_s << " s: later stamps are moved so that time goes on";
  return text.str();
}

SetBackClock mend_set_back_clock(std::vector<Stamp>& stamps,
                                 const std::function<bool(std::size_t, std::size_t)>& same) {
  SetBackClock result;
  if (std::is_sorted(stamps.begin(), stamps.end())) return result;
  const Duration period = median_period(stamps);
  const double min_s = std::max(kMinSetBackS, kMinPeriods * period.seconds());
  const Stamp begin = stamps.front();
  Recorded recorded;
  Duration ahead;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    Stamp stamp = stamps[i] + ahead;
    const Stamp latest = recorded.empty() ? stamp : recorded.rbegin()->first;
    const bool back = (latest - stamp).seconds() > min_s && i + 1 < stamps.size() &&
                      stamps[i + 1] + ahead < latest && stamps[i + 1] >= stamps[i];
    const auto copy = back ? recorded.find(stamp) : recorded.end();
    const bool repeated = copy != recorded.end() && same(i, copy->second);
    if (back && !repeated && is_taken(recorded, stamp, period.seconds())) {
      if (result.times++ == 0) result.first_s = (latest - begin).seconds();
      result.furthest_s = std::max(result.furthest_s, (latest - stamp).seconds());
      ahead = ahead + ((latest + period) - stamp);
      stamp = latest + period;
    }
    stamps[i] = stamp;
    recorded.emplace(stamp, i);
  }
  return result;
}

}  // namespace strata::log
