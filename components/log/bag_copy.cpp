// SPDX-License-Identifier: Apache-2.0
#include "components/log/bag_copy.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "components/log/whole_folder.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

struct Window {
  Stamp begin{std::numeric_limits<std::int64_t>::min()};
  Stamp end{std::numeric_limits<std::int64_t>::max()};
};

/// Adds seconds without running over the range of stamps.
Stamp shift(Stamp stamp, double seconds) {
  const double ns = static_cast<double>(stamp.ns) + seconds * 1e9;
  if (!(ns > -9.2e18)) return {std::numeric_limits<std::int64_t>::min()};
  if (!(ns < 9.2e18)) return {std::numeric_limits<std::int64_t>::max()};
  return stamp + Duration::from_seconds(seconds);
}

bool is_cut(const CopyOptions& options) {
  return options.from_s > 0.0 || !std::isinf(options.to_s);
}

Window find_window(const fs::path& in, const CopyOptions& options) {
  if (!is_cut(options)) return {};
  const auto reader = BagReader::open(in);
  BagMessage message;
  Stamp start;
  bool any = false;
  while (reader->next(message)) {
    const bool is_scan = reader->topics()[message.topic].type == "sensor_msgs/msg/LaserScan";
    if (!any || is_scan) start = message.stamp;
    any = true;
    if (is_scan) break;
  }
  return {shift(start, options.from_s), shift(start, options.to_s)};
}

}  // namespace

CopyReport copy_bag(const fs::path& in, const fs::path& folder, const BagOptions& format,
                    const CopyOptions& options) {
  const Window window = find_window(in, options);
  const auto reader = BagReader::open(in);
  WholeFolder whole(folder);
  BagWriter writer(whole.aside(), format);
  CopyReport report;
  std::vector<std::optional<std::size_t>> places;
  const auto place_of = [&](std::size_t topic) {
    while (places.size() <= topic) {
      const BagTopic& known = reader->topics()[places.size()];
      if (known.serialization_format == kRos1Format) {
        places.emplace_back(std::nullopt);
        continue;
      }
      const bool is_new = report.messages.try_emplace(known.name, 0).second;
      // rosbag2 knows one type a name; a second one finds no place.
      places.push_back(is_new ? std::optional(writer.add_topic(known)) : std::nullopt);
      if (known.type == "sensor_msgs/msg/LaserScan" && report.first_topic_of_scans.empty()) {
        report.first_topic_of_scans = known.name;
      }
    }
    return places[topic];
  };
  BagMessage message;
  BagDamage other_type;
  std::map<std::size_t, std::size_t> of_ros1;
  std::size_t done = 0;
  bool any_inside = false;
  while (reader->next(message)) {
    const std::optional<std::size_t> place = place_of(message.topic);
    const std::string& name = reader->topics()[message.topic].name;
    const bool latched = name.find("tf_static") != std::string::npos;
    const bool inside = message.stamp >= window.begin && message.stamp <= window.end;
    any_inside = any_inside || inside;
    if (!inside && !(latched && message.stamp < window.begin)) continue;
    if (reader->topics()[message.topic].serialization_format == kRos1Format) {
      ++of_ros1[message.topic];
      continue;
    }
    if (!place) {
      other_type.add(in.string() + ": " + name + " has messages of more than one type");
      continue;
    }
    writer.write(*place, std::max(message.stamp, window.begin), message.data);
    ++report.messages[name];
    if (++done % 1000 == 0) report_progress(options.progress, "copy bag", done, 0);
  }
  if (!reader->topics().empty()) place_of(reader->topics().size() - 1);
  for (const auto& [topic, count] : of_ros1) {
    const BagTopic& known = reader->topics()[topic];
    report.left_out.push_back(known.name + " (" + std::to_string(count) + " " + known.type + ")");
  }
  report.damage = reader->damage();
  if (report.damage.count == 0) report.damage.first = other_type.first;
  report.damage.count += other_type.count;
  if (!any_inside && is_cut(options)) {
    throw InputError("--from, --to", "leave no message of " + in.string(),
                     "give seconds from the first scan, within the log");
  }
  writer.close();
  whole.commit();
  return report;
}

}  // namespace strata::log
