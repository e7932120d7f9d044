// SPDX-License-Identifier: Apache-2.0
/// `strata info LOG`: what is in a log.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "components/log/json_text.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/spooled_input.hpp"
#include "components/maps/summary.hpp"
#include "core/base/error.hpp"
#include "memory/store/store_summary.hpp"
#include "tools/strata/info_bag.hpp"
#include "tools/strata/info_folder.hpp"
#include "tools/strata/info_kept.hpp"
#include "tools/strata/info_scans.hpp"
#include "tools/strata/info_store.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/verbs.hpp"

namespace strata::tools {
namespace {

using Json = nlohmann::ordered_json;

struct InfoOptions {
  std::string log;
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  double max_range_m = 0.0;
  std::optional<double> odometry_lag_s;
  std::vector<std::string> scan_topics;
  CloudSliceConfig cloud;
  bool json = false;
};

double path_length_m(const std::vector<Observation>& observations) {
  double length_m = 0.0;
  for (std::size_t i = 1; i < observations.size(); ++i) {
    length_m +=
        translation_distance(observations[i - 1].odom_from_robot, observations[i].odom_from_robot);
  }
  return length_m;
}

Json describe(const std::string& path, const log::LogContent& content,
              const log::ReadReport& report) {
  const auto& observations = content.observations;
  const Stamp begin = observations.front().scan.stamp;
  const Stamp end = observations.back().scan.stamp;
  const double duration_s = (end - begin).seconds();
  Json info;
  info["log"] = path;
  info["format"] = log::format_name(report.format);
  if (!report.storage.empty()) info["storage"] = report.storage;
  info["begin_s"] = begin.seconds();
  info["end_s"] = end.seconds();
  info["duration_s"] = duration_s;
  info["path_m"] =
      observations.front().has_odometry ? Json(path_length_m(observations)) : Json(nullptr);
  info["scans"] = describe_scans(observations, duration_s);
  const std::vector<ScannerOfLog> scanners = scanners_of(observations, report.scanners);
  for (const ScannerOfLog& scanner : scanners) {
    Json entry{{"topic", scanner.topic}};
    entry.update(describe_scans(scanner.observations, duration_s));
    info["scanners"].push_back(entry);
  }
  info["no_return"] = maps::summarize_no_returns(report);
  info["odometry"] = {{"source", report.odometry_source}, {"samples", content.odometry.size()}};
  info["odometry_lag_s"] = report.clock.lag_s ? Json(*report.clock.lag_s) : Json(nullptr);
  info["mounting_source"] = report.mounting_source;
  info["messages"] = Json::object();
  for (const auto& [name, count] : report.messages) {
    Json entry{{"count", count}};
    if (const auto type = report.types.find(name); type != report.types.end()) {
      entry["type"] = type->second;
    }
    entry["rate_hz"] =
        duration_s > 0.0 ? Json(static_cast<double>(count) / duration_s) : Json(nullptr);
    info["messages"][name] = entry;
  }
  info["bad"] = {{"count", report.bad_lines}, {"first", report.first_bad}};
  info["skipped_scans"] = {{"without_beams", report.scans_without_beams},
                           {"without_odometry", report.scans_without_odometry}};
  info["out_of_order"] = report.scans_out_of_order;
  info["warnings"] = report.warnings;
  return info;
}

void print(const Json& info) {
  const Json& scans = info["scans"];
  std::cout << info["log"].get<std::string>() << ": " << info["format"].get<std::string>();
  if (info.contains("storage")) std::cout << " (" << info["storage"].get<std::string>() << ")";
  std::cout << "\n";
  std::cout << "  duration   " << number(info["duration_s"], "%.1f s") << "\n";
  if (!info["path_m"].is_null()) {
    std::cout << "  path       " << number(info["path_m"], "%.1f m") << " by odometry ("
              << info["odometry"]["source"].get<std::string>() << ")\n";
    if (!info["odometry_lag_s"].is_null()) {
      std::cout << "  clock      odometry is stamped " << number(info["odometry_lag_s"], "%+.2f s")
                << " against the scans, as turns show\n";
    }
  } else {
    std::cout << "  path       no odometry\n";
  }
  std::cout << "  scans      " << scans["count"];
  if (!scans["rate_hz"].is_null()) std::cout << ", " << number(scans["rate_hz"], "%.2f Hz");
  std::cout << "\n";
  if (info.contains("scanners")) {
    for (const Json& scanner : info["scanners"]) print_scanner(scanner);
  } else {
    std::cout << "  beams      " << beams_of(scans) << "\n";
  }
  std::cout << "  readings   " << scans["hits"] << " hits, " << scans["no_returns"]
            << " without return, " << scans["too_close"] << " too close, " << scans["invalid"]
            << " invalid\n";
  for (const Json& limit : info["no_return"]) {
    const std::string scanner = limit.value("scanner", "");
    std::cout << "  no return  " << (scanner.empty() ? "" : scanner + ": ") << "from "
              << number(limit["from_m"], "%.2f m") << " on: " << limit["why"].get<std::string>()
              << "\n";
  }
  std::cout << "  mounting   ";
  if (!info.contains("scanners")) std::cout << mounting_of(scans) << " ";
  std::cout << "(" << info["mounting_source"].get<std::string>() << ")\n";
  std::cout << "  messages\n";
  for (const auto& [name, entry] : info["messages"].items()) {
    std::cout << "    " << name << " " << entry["count"];
    if (!entry["rate_hz"].is_null()) std::cout << ", " << number(entry["rate_hz"], "%.2f Hz");
    if (entry.contains("type")) std::cout << ", " << entry["type"].get<std::string>();
    std::cout << "\n";
  }
  if (info["bad"]["count"] != 0) {
    std::cout << "  unreadable " << info["bad"]["count"]
              << ", first: " << info["bad"]["first"].get<std::string>() << "\n";
  }
  for (const auto& [reason, count] : info["skipped_scans"].items()) {
    if (count != 0) std::cout << "  skipped    " << count << " scans " << reason << "\n";
  }
  if (info["out_of_order"] != 0) {
    std::cout << "  sorted     " << info["out_of_order"] << " scans came out of order\n";
  }
  for (const auto& warning : info["warnings"]) {
    std::cout << "  note       " << warning.get<std::string>() << "\n";
  }
}

/// Without the advice to see what is being shown.
std::string reason(const Error& why) {
  const bool points_here = why.remedy().find("`strata info`") != std::string::npos;
  return why.place() + ": " + why.problem() + (points_here ? "" : "; " + why.remedy());
}

/// A bag without scans, or with several topics of them, is told by its topics all the same.
bool told_as_bag(const InfoOptions& options, const InputError& why) {
  const log::LogFormat format = log::detect_format(options.log);
  const bool is_whole =
      options.from_s <= 0.0 && std::isinf(options.to_s) && options.scan_topics.empty();
  if (format == log::LogFormat::kCarmen || !is_whole) return false;
  try {
    return print_bag(options.log, log::format_name(format), reason(why), options.json);
  } catch (const InputError&) {
    return false;  // why says more
  }
}

void run_info(const InfoOptions& options, VerbContext& context) {
  if (memory::is_store(log::readable_path(options.log)))
    return print_store(options.log, options.json);
  if (is_result_folder(options.log)) return print_folder(options.log, options.json);
  require_scan_topics(options.scan_topics, options.cloud, options.log);
  log::ReadOptions read;
  read.scan_topics = options.scan_topics;
  read.cloud = options.cloud;
  read.from_s = options.from_s;
  read.to_s = options.to_s;
  read.undistort = false;
  read.max_range_m = options.max_range_m;
  read.odometry_lag_s = options.odometry_lag_s;
  read.progress = context.progress();
  log::ReadReport report;
  Json info;
  try {
    info = describe(options.log, log::read_log(options.log, read, &report), report);
  } catch (const InputError& error) {
    if (print_kept(options.log, options.json) || told_as_bag(options, error)) return;
    throw;
  }
  if (options.json) {
    std::cout << log::json_text(info);
  } else {
    print(info);
  }
}

}  // namespace

void add_info(CLI::App& app, VerbContext& context) {
  const auto [verb, options] = add_verb<InfoOptions>(
      app, context, "info",
      "what is in a log, in a folder of maps or results, or in what components keep",
      "strata info office.log.gz", run_info);
  verb->add_option("LOG", options->log,
                   "CARMEN log, rosbag2 folder, .db3, .mcap or ROS 1 .bag; or a folder that a verb "
                   "or a component wrote, or a file in it")
      ->required();
  verb->add_option("--from", options->from_s, "cut, seconds from the first scan");
  verb->add_option("--to", options->to_s, "cut, seconds from the first scan");
  add_scan_topics(*verb, options->scan_topics, options->cloud);
  add_max_range(*verb, options->max_range_m);
  add_odometry_lag(*verb, options->odometry_lag_s);
  verb->add_flag("--json", options->json, "as JSON on stdout");
}

}  // namespace strata::tools
