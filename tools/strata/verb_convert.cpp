// SPDX-License-Identifier: Apache-2.0
/// `strata convert IN OUT`: CARMEN, rosbag2 SQLite and MCAP into each other.
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "components/log/carmen.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "tools/strata/verbs.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

struct Options {
  std::string in;
  std::string out;
  std::vector<std::string> to_values;  ///< as given: --to is a format here, and a cut everywhere
  std::string to;
  std::string compression = "zstd";
  double from_s = 0.0;
  double to_s = std::numeric_limits<double>::infinity();
};

/// By --to, else by OUT's ending.
std::string target_format(const Options& options) {
  if (!options.to.empty()) return options.to;
  const std::string ending = fs::path(options.out).extension().string();
  if (ending == ".log" || ending == ".clf") return "carmen";
  if (ending == ".db3") return "sqlite3";
  if (ending == ".mcap") return "mcap";
  throw InputError(options.out, "its ending does not say what to write",
                   "end it in .clf, .log, .db3 or .mcap, or give --to");
}

/// A bag is a folder. For an OUT that names a storage file the file alone is put there.
void write_bag_or_file(const Options& options, const log::LogContent& content,
                       log::BagStorage storage, StagedPaths& staged) {
  auto compression = log::BagCompression::kNone;
  if (storage == log::BagStorage::kMcap) {
    if (options.compression == "zstd") compression = log::BagCompression::kZstd;
    if (options.compression == "lz4") compression = log::BagCompression::kLz4;
  }
  const fs::path out = options.out;
  const std::string ending = out.extension().string();
  if (ending != ".db3" && ending != ".mcap") {
    log::write_bag(out, content, storage, compression);
    return;
  }
  fs::path aside = out;
  aside += ".parts";
  if (fs::exists(aside)) {
    throw OutputError(aside.string(), "is in the way", "remove it");
  }
  staged.add(aside);
  try {
    log::write_bag(aside, content, storage, compression);
    for (const auto& entry : fs::directory_iterator(aside)) {
      if (entry.path().extension() == ending) fs::rename(entry.path(), out);
    }
    fs::remove_all(aside);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(aside, ignored);
    staged.forget(aside);
    throw;
  }
  staged.forget(aside);
}

void sort_out_to(Options& options) {
  for (const std::string& value : options.to_values) {
    if (const auto seconds = log::parse_double(value)) {
      options.to_s = *seconds;
    } else if (value == "carmen" || value == "sqlite3" || value == "mcap") {
      options.to = value;
    } else {
      throw InputError("--to", "`" + value + "` is neither a format nor a time",
                       "give carmen, sqlite3, mcap, or seconds");
    }
  }
}

void run(Options& options, VerbContext& context) {
  sort_out_to(options);
  const std::string format = target_format(options);
  log::ReadOptions read;
  read.from_s = options.from_s;
  read.to_s = options.to_s;
  read.undistort = false;  // the copy keeps what was recorded
  read.progress = context.progress();
  log::ReadReport report;
  const log::LogContent content = log::read_log(options.in, read, &report);
  for (const std::string& warning : report.warnings) context.note("note: " + warning);
  if (report.bad_lines > 0) {
    context.note("note: " + std::to_string(report.bad_lines) +
                 " unreadable places left out, first: " + report.first_bad);
  }
  if (format == "carmen") {
    log::write_carmen(options.out, content);
  } else {
    write_bag_or_file(options, content,
                      format == "mcap" ? log::BagStorage::kMcap : log::BagStorage::kSqlite3,
                      context.staged());
  }
  context.note(options.out + ": " + std::to_string(content.observations.size()) + " scans, " +
               std::to_string(content.odometry.size()) + " odometry samples");
}

}  // namespace

void add_convert(CLI::App& app, VerbContext& context) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = add_verb(app, context, "convert", "a log into another format",
                            "strata convert office.clf.gz office.mcap",
                            [options, &context] { run(*options, context); });
  verb->add_option("IN", options->in, "CARMEN log, rosbag2 folder, .db3 or .mcap")->required();
  verb->add_option("OUT", options->out,
                   "file (.clf, .log, .db3, .mcap), or a folder for a bag with --to")
      ->required();
  verb->add_option("--to", options->to_values,
                   "format (carmen, sqlite3, mcap) when OUT's ending does not say it; or a number: "
                   "cut, seconds from the first scan")
      ->take_all()
      ->allow_extra_args(false);
  verb->add_option("--compression", options->compression, "of MCAP chunks")
      ->check(CLI::IsMember({"none", "zstd", "lz4"}))
      ->capture_default_str();
  verb->add_option("--from", options->from_s, "cut, seconds from the first scan");
}

}  // namespace strata::tools
