// SPDX-License-Identifier: Apache-2.0
#include "components/log/log_reader.hpp"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "components/log/bag_observations.hpp"
#include "components/log/bag_storage.hpp"
#include "components/log/carmen.hpp"
#include "components/log/compression.hpp"
#include "components/log/odometry_clock.hpp"
#include "components/log/spooled_input.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

bool is_carmen_keyword(std::string_view word) {
  constexpr std::string_view known[] = {"FLASER",      "RLASER",      "ODOM",        "PARAM",
                                        "ROBOTLASER1", "ROBOTLASER2", "RAWLASER1",   "RAWLASER2",
                                        "TRUEPOS",     "SYNC",        "LASER_RANGES"};
  return std::find(std::begin(known), std::end(known), word) != std::end(known);
}

/// Looks at the first lines of a text file, plain or gzipped.
LogFormat detect_text(const fs::path& path) {
  LineReader lines(path);
  std::string line;
  std::vector<std::string_view> words;
  for (int i = 0; i < 400 && lines.next(line); ++i) {
    if (line.size() > 1'000'000) break;
    split(line, words);
    if (words.empty() || words[0].front() == '#') continue;
    if (is_carmen_keyword(words[0])) return LogFormat::kCarmen;
    if (words[0] == "NODE") {
      throw InputError(path.string(), "is a 3D log of point clouds (OctoMap), not a laser log",
                       "this verb takes planar scans; 3D logs are for `strata volume`");
    }
  }
  if (!lines.damage().empty()) throw lines.damage_error();
  throw InputError(path.string(), "is no log that is known here",
                   "give a CARMEN log, a rosbag2 folder, .db3, .mcap or a ROS 1 .bag");
}

void cut(LogContent& content, const ReadOptions& options) {
  auto& scans = content.observations;
  if (scans.empty()) return;
  const Stamp start = scans.front().scan.stamp;
  const auto outside = [&](Stamp stamp) {
    const double s = (stamp - start).seconds();
    return s < options.from_s || s > options.to_s;
  };
  std::erase_if(scans, [&](const Observation& o) { return outside(o.scan.stamp); });
  std::erase_if(content.odometry, [&](const OdometrySample& o) { return outside(o.stamp); });
}

LogContent read_as(const fs::path& path, LogFormat format, const ReadOptions& options,
                   ReadReport& report) {
  return format == LogFormat::kCarmen ? read_carmen(path, options, report)
                                      : read_bag(path, options, report);
}

/// Every scan with the odometry of its moment, whatever the stamps say. A bag is read again with
/// the lag that was found: its scans are joined, undistorted and judged by odometry.
LogContent read_by_one_clock(const fs::path& path, LogFormat format, const ReadOptions& options,
                             ReadReport& report) {
  ReadOptions by_lag = options;
  if (!options.odometry_lag_s) by_lag.odometry_lag_s = 0.0;
  LogContent content = read_as(path, format, by_lag, report);
  if (!options.use_odometry || content.observations.empty()) return content;
  OdometryClock clock;
  if (options.odometry_lag_s) {
    clock.is_given = true;
    clock.lag_s = options.odometry_lag_s;
    if (*clock.lag_s != 0.0) clock.corrected_s = clock.lag_s;
  } else {
    clock = find_odometry_clock(content, report);
    if (clock.corrected_s && format != LogFormat::kCarmen) {
      by_lag.odometry_lag_s = clock.corrected_s;
      report = ReadReport{};
      content = read_as(path, format, by_lag, report);
    }
  }
  if (clock.corrected_s && format == LogFormat::kCarmen) {
    shift_scan_odometry(content, *clock.corrected_s);
  }
  report.clock = clock;
  if (const std::string said = sentence_of(clock); !said.empty()) report.warnings.push_back(said);
  return content;
}

}  // namespace

LogFormat detect_format(const fs::path& path) {
  std::error_code error;
  require_reachable(path);
  if (fs::is_directory(path, error)) return LogFormat::kBagFolder;
  if (is_mcap(path)) return LogFormat::kMcap;
  if (is_sqlite(path)) return LogFormat::kSqlite3;
  if (is_ros1_bag(path)) return LogFormat::kRos1Bag;
  if (compression_of_file(path) != BagCompression::kNone) return LogFormat::kPackedFile;
  return detect_text(path);
}

const char* format_name(LogFormat format) {
  switch (format) {
    case LogFormat::kCarmen:
      return "CARMEN log";
    case LogFormat::kSqlite3:
      return "rosbag2 SQLite file";
    case LogFormat::kMcap:
      return "MCAP file";
    case LogFormat::kBagFolder:
      return "bag folder";
    case LogFormat::kPackedFile:
      return "packed bag file";
    case LogFormat::kRos1Bag:
      return "ROS 1 bag";
  }
  return "?";
}

LogContent read_log(const fs::path& path, const ReadOptions& options, ReadReport* report) {
  ReadReport own;
  ReadReport& used = report != nullptr ? *report : own;
  used = ReadReport{};
  const LogFormat format = detect_format(path);
  LogContent content = read_by_one_clock(path, format, options, used);
  used.format = format;
  const bool whole = options.from_s <= 0.0 && options.to_s > 1e300;
  if (content.observations.empty()) {
    throw InputError(path.string(), "holds no scan with odometry near it",
                     "leave odometry out with --no-odometry");
  }
  // Odometry is kept whole when nothing is cut; it often begins before the first scan.
  if (!whole) cut(content, options);
  if (content.observations.empty()) {
    throw InputError("--from, --to", "leave no scan of " + path.string(),
                     "give seconds from the first scan, within the log");
  }
  if (!options.use_odometry) {
    for (Observation& observation : content.observations) {
      observation.has_odometry = false;
      observation.odom_from_robot = Pose2{};
    }
    content.odometry.clear();
    used.odometry_source = "none";
  }
  return content;
}

std::vector<Observation> read_observations(const fs::path& path, const ReadOptions& options,
                                           ReadReport* report) {
  return read_log(path, options, report).observations;
}

}  // namespace strata::log
