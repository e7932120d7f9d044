// SPDX-License-Identifier: Apache-2.0
/// `strata convert IN OUT`: CARMEN, rosbag2 SQLite and MCAP into each other.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "components/log/bag_copy.hpp"
#include "components/log/carmen.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "components/log/ros_stamps.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "tools/strata/convert_output.hpp"
#include "tools/strata/run_options.hpp"
#include "tools/strata/verbs.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

struct ConvertOptions {
  std::string in;
  std::string out;
  std::vector<std::string> to_values;  ///< as given: --to is a format here, and a cut everywhere
  std::string to;
  std::string compression = "zstd";
  std::string compression_mode = "none";
  int sqlite_schema = 3;
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  double max_range_m = 0.0;
  std::vector<std::string> scan_topics;
  CloudSliceConfig cloud;
};

/// By --to, else by OUT's ending.
std::string target_format(const ConvertOptions& options) {
  if (!options.to.empty()) return options.to;
  fs::path out = options.out;
  const bool is_packed = out.extension() == ".gz";  // as write_carmen then writes
  if (is_packed) out.replace_extension();
  const std::string ending = out.extension().string();
  if (ending == ".log" || ending == ".clf") return "carmen";
  if (ending == ".db3" && !is_packed) return "sqlite3";
  if (ending == ".mcap" && !is_packed) return "mcap";
  throw InputError(options.out, "its ending does not say what to write",
                   "end it in .clf, .log (or .clf.gz), .db3 or .mcap, or give --to");
}

log::BagOptions bag_format(const ConvertOptions& options, const std::string& format) {
  log::BagOptions bag;
  bag.storage = format == "mcap" ? log::BagStorage::kMcap : log::BagStorage::kSqlite3;
  bag.sqlite_schema = options.sqlite_schema;
  if (options.compression_mode == "file") bag.packing = log::BagPacking::kFile;
  if (options.compression_mode == "message") bag.packing = log::BagPacking::kMessage;
  if (format == "mcap" && bag.packing == log::BagPacking::kNone) {
    if (options.compression == "zstd") bag.chunks = log::BagCompression::kZstd;
    if (options.compression == "lz4") bag.chunks = log::BagCompression::kLz4;
  }
  return bag;
}

void sort_out_to(ConvertOptions& options) {
  for (const std::string& value : options.to_values) {
    const auto seconds = log::parse_double(value);
    if (seconds && !std::isnan(*seconds)) {
      options.to_s = *seconds;
    } else if (value == "carmen" || value == "sqlite3" || value == "mcap") {
      options.to = value;
    } else {
      throw InputError("--to", "`" + value + "` is neither a format nor a time",
                       "give carmen, sqlite3, mcap, or seconds");
    }
  }
}

/// Bag to bag: every message of every topic, as it is.
void copy(const ConvertOptions& options, const std::string& format, VerbContext& context) {
  const log::CopyOptions cut{options.from_s, options.to_s, context.progress()};
  log::CopyReport report;
  write_bag_or_file(options.out, context.staged(), [&](const fs::path& folder) {
    report = log::copy_bag(options.in, folder, bag_format(options, format), cut);
  });
  if (report.damage.count > 0) {
    context.note("note: " + std::to_string(report.damage.count) +
                 " unreadable places left out, first: " + report.damage.first);
  }
  for (const std::string& topic : report.left_out) {
    context.note("note: left out, what ROS 1 serialized and Strata does not know: " + topic);
  }
  std::size_t messages = 0;
  for (const auto& [topic, count] : report.messages) messages += count;
  context.note(options.out + ": " + std::to_string(messages) + " messages on " +
               std::to_string(report.messages.size()) + " topics");
}

/// What the target has no place for, by name and number.
std::string left_out(const log::ReadReport& report) {
  std::string text;
  for (const auto& [name, count] : report.messages) {
    const auto type = report.types.find(name);
    const bool is_scanner =
        std::any_of(report.scanners.begin(), report.scanners.end(),
                    [&, &topic = name](const auto& scanner) { return scanner.topic == topic; });
    const bool carried = type != report.types.end()
                             ? is_scanner || name == report.odometry_source ||
                                   type->second == "tf2_msgs/msg/TFMessage"
                             : name == "FLASER" || name == "ROBOTLASER1" || name == "ODOM";
    if (carried) continue;
    text += (text.empty() ? "" : ", ") + name + " (" + std::to_string(count) +
            (type != report.types.end() ? " " + type->second : "") + ")";
  }
  return text;
}

/// Throws InputError where scanners sit at several places: CARMEN's lines tell no two apart.
void require_one_scanner(const ConvertOptions& options, const log::LogContent& content) {
  const Pose2& first = content.observations.front().scan.robot_from_laser;
  for (const Observation& observation : content.observations) {
    if (observation.scan.robot_from_laser == first) continue;
    throw InputError(options.in, "has several scanners, and a CARMEN log holds one",
                     "name one with --scan-topic, or write a bag");
  }
}

/// Through scans and odometry, where one side is CARMEN.
void translate(const ConvertOptions& options, const std::string& format, VerbContext& context) {
  log::ReadOptions read;
  read.from_s = options.from_s;
  read.to_s = options.to_s;
  read.max_range_m = options.max_range_m;
  read.scan_topics = options.scan_topics;
  read.cloud = options.cloud;
  read.undistort = false;  // the copy keeps what was recorded
  read.odometry_lag_s = 0.0;
  read.progress = context.progress();
  log::ReadReport report;
  const log::LogContent content = log::read_log(options.in, read, &report);
  if (format == "carmen") {
    require_one_scanner(options, content);
  } else {
    log::require_ros_stamps(content.observations, content.odometry, options.in);
  }
  for (const std::string& warning : report.warnings) context.note("note: " + warning);
  if (report.bad_lines > 0) {
    context.note("note: " + std::to_string(report.bad_lines) +
                 " unreadable places left out, first: " + report.first_bad);
  }
  const std::size_t unused = report.scans_without_beams + report.scans_without_odometry;
  if (unused > 0) {
    context.note("note: " + std::to_string(unused) + " scans without beams or odometry left out");
  }
  if (const std::string names = left_out(report); !names.empty()) {
    context.note("note: left out, the target has no place for it: " + names);
  }
  if (format == "carmen") {
    log::write_carmen(options.out, content);
  } else {
    write_bag_or_file(options.out, context.staged(), [&](const fs::path& folder) {
      log::write_bag(folder, content, bag_format(options, format));
    });
  }
  context.note(options.out + ": " + std::to_string(content.observations.size()) + " scans, " +
               std::to_string(content.odometry.size()) + " odometry samples");
}

void run(ConvertOptions& options, VerbContext& context) {
  sort_out_to(options);
  refuse_to_write_over(options.in, options.out);
  const std::string format = target_format(options);
  if (options.compression_mode != "none" && format == "carmen") {
    throw InputError("--compression-mode", "is for bags, and CARMEN logs are text",
                     "leave it out, or write a bag");
  }
  require_scan_topics(options.scan_topics, options.cloud, options.in);
  if (!options.scan_topics.empty() && format != "carmen") {
    throw InputError("--scan-topic", "is for CARMEN logs, and a bag keeps every topic",
                     "leave it out");
  }
  const bool is_cut = options.cloud.min_height_m != CloudSliceConfig{}.min_height_m ||
                      options.cloud.max_height_m != CloudSliceConfig{}.max_height_m;
  if (is_cut && format != "carmen") {
    throw InputError("--min-height, --max-height",
                     "are for CARMEN logs, and a bag keeps clouds as they are", "leave them out");
  }
  const std::string ending = fs::path(options.out).extension().string();
  require_writable(options.out, format == "carmen" || ending == ".db3" || ending == ".mcap");
  const bool from_bag = log::detect_format(options.in) != log::LogFormat::kCarmen;
  if (from_bag && format != "carmen") {
    copy(options, format, context);
  } else {
    translate(options, format, context);
  }
}

}  // namespace

void add_convert(CLI::App& app, VerbContext& context) {
  const auto [verb, options] =
      add_verb<ConvertOptions>(app, context, "convert", "a log into another format",
                               "strata convert office.clf.gz office.mcap", run);
  verb->add_option("IN", options->in, "CARMEN log, rosbag2 folder, .db3, .mcap or ROS 1 .bag")
      ->required();
  verb->add_option("OUT", options->out,
                   "file (.clf, .log, .clf.gz, .db3, .mcap), or a folder for a bag with --to")
      ->required();
  verb->add_option("--to", options->to_values,
                   "format (carmen, sqlite3, mcap) when OUT's ending does not say it; or a number: "
                   "cut, seconds from the first scan")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--compression", options->compression, "of MCAP chunks")
      ->check(CLI::IsMember({"none", "zstd", "lz4"}))
      ->capture_default_str();
  verb->add_option("--compression-mode", options->compression_mode,
                   "rosbag2's: pack whole files or single messages with zstd")
      ->check(CLI::IsMember({"none", "file", "message"}))
      ->capture_default_str();
  verb->add_option("--sqlite-schema", options->sqlite_schema,
                   "3 as Humble, 4 as Iron and later (with message definitions)")
      ->check(CLI::IsMember({3, 4}))
      ->capture_default_str();
  verb->add_option("--from", options->from_s, "cut, seconds from the first scan");
  add_scan_topics(*verb, options->scan_topics, options->cloud);
  add_max_range(*verb, options->max_range_m);
}

}  // namespace strata::tools
