// SPDX-License-Identifier: Apache-2.0
/// Any recorded log as scans with odometry, at wire precision.
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/log/odometry_track.hpp"
#include "core/base/progress.hpp"
#include "core/scan/cloud_slice.hpp"
#include "core/scan/scan.hpp"
#include "core/scan/undistort.hpp"

namespace strata::log {

enum class LogFormat { kCarmen, kSqlite3, kMcap, kBagFolder, kPackedFile, kRos1Bag };

/// Told by content, never by name. Throws InputError for anything else, with what it looks like.
[[nodiscard]] LogFormat detect_format(const std::filesystem::path& path);
[[nodiscard]] const char* format_name(LogFormat format);

struct ReadOptions {
  int run = 0;  ///< given to every observation
  /// Seconds from the first scan; scans outside [from_s, to_s] are left out.
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
  bool use_odometry = true;
  bool undistort = true;  ///< scans with time_increment; the corrected scan has none
  /// Bags: empty takes the only topic of the type, or /scan and /odom among several.
  std::string scan_topic;
  /// Bags: the topics of several scanners, each with a mounting of its own; scan_topic is then not
  /// looked at. Their scans become observations in order of time. Of a topic with PointCloud2 the
  /// slice `cloud` is taken for a scan.
  std::vector<std::string> scan_topics;
  CloudSliceConfig cloud;
  std::string odom_topic;
  std::string odom_frame = "odom";  ///< when odometry comes from tf
  /// What poses are of. Odometry of another frame that tf connects to it is transformed; where tf
  /// does not know this one, poses are of odometry's child frame.
  std::string robot_frame = "base_link";
  /// A scan further than this from any odometry is skipped.
  double max_odometry_gap_s = 1.0;
  /// CARMEN's FLASER does not say its field of view; it is taken as centred on straight ahead.
  double flaser_field_of_view_deg = 180.0;
  /// Readings from here on say that nothing came back, whatever the log states; 0: what it states,
  /// or what the readings tell (settle_no_returns).
  double max_range_m = 0.0;
  /// Odometry of a scan's moment has the scan's stamp plus this [s]; nothing: as the scans' turns
  /// tell, where they do (find_odometry_clock).
  std::optional<double> odometry_lag_s;
  Progress* progress = nullptr;
};

/// How odometry is stamped against the scans.
struct OdometryClock {
  std::optional<double> lag_s;        ///< positive: late; nothing: the log does not tell
  std::optional<double> corrected_s;  ///< the lag that was taken out, if it matters
  bool is_given = false;              ///< by ReadOptions
};

/// From where on a scanner's readings are taken for no return.
struct NoReturnLimit {
  std::string scanner;  ///< a topic, or empty where there is one scanner
  float from_m = 0.0F;
  std::string why;
};

/// A scanner of a bag that gave observations.
struct ReadScanner {
  std::string topic;
  Pose2 robot_from_laser;  ///< as in its scans
};

/// What reading met. Nothing is skipped without being counted here.
struct ReadReport {
  LogFormat format = LogFormat::kCarmen;
  std::string storage;                          ///< how a bag is stored, for people
  std::map<std::string, std::size_t> messages;  ///< per CARMEN keyword or topic
  std::map<std::string, std::string> types;     ///< per topic of a bag
  std::size_t bad_lines = 0;                    ///< unreadable lines or messages
  std::string first_bad;                        ///< where the first one is and why
  std::size_t scans_without_beams = 0;          ///< skipped: no beams, or NaN in every one
  std::size_t scans_without_odometry = 0;       ///< skipped: odometry exists but not at that time
  std::size_t scans_out_of_order = 0;           ///< came later than a younger one; sorted
  std::string scan_topic;                       ///< of a bag: what was used, "/a, /b"
  std::vector<ReadScanner> scanners;            ///< of a bag, as they were named
  std::string odometry_source;                  ///< "scan", a topic, "tf", or "none"
  OdometryClock clock;                          ///< of odometry against the scans
  SweepTiming sweep;                            ///< how scans of the first scanner were undistorted
  std::vector<NoReturnLimit> no_returns;        ///< one a scanner
  std::string mounting_source;  ///< "tf_static", "tf", "laser - odometry", "assumed"
  std::vector<std::string> warnings;
};

/// What a log calls the frame of the scanner that is mounted there.
struct ScannerFrame {
  Pose2 robot_from_laser;
  std::string name;
};

/// A log with everything of it that Strata understands.
struct LogContent {
  std::vector<Observation> observations;     ///< by stamp
  std::vector<OdometrySample> odometry;      ///< by stamp; without the scans' own in CARMEN
  std::string scan_frame = "laser";          ///< of the first scanner
  std::vector<ScannerFrame> scanner_frames;  ///< of a bag, without its clouds
  std::string robot_frame = "base_link";
  std::string odom_frame = "odom";
};

/// Throws InputError when the file cannot be read or holds no usable scan; what is damaged in part
/// is read up to the damage and counted. O(size of the log).
[[nodiscard]] LogContent read_log(const std::filesystem::path& path,
                                  const ReadOptions& options = {}, ReadReport* report = nullptr);
[[nodiscard]] std::vector<Observation> read_observations(const std::filesystem::path& path,
                                                         const ReadOptions& options = {},
                                                         ReadReport* report = nullptr);

}  // namespace strata::log
