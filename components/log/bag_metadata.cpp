// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <system_error>

#include <yaml-cpp/yaml.h>

#include "components/log/bag_storage.hpp"
#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

bool begins_with(const fs::path& file, std::string_view magic) {
  std::ifstream in(file, std::ios::binary);
  std::string head(magic.size(), '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return in && head == magic;
}

std::vector<fs::path> files_of_metadata(const fs::path& folder) {
  const fs::path path = folder / "metadata.yaml";
  std::vector<fs::path> files;
  if (!fs::exists(path)) return files;
  try {
    const YAML::Node info = YAML::LoadFile(path.string())["rosbag2_bagfile_information"];
    const auto mode = info["compression_mode"].as<std::string>("");
    if (!mode.empty() && mode != "NONE" && mode != "none") {
      throw InputError(path.string(), "the bag is compressed by rosbag2 (mode " + mode + ")",
                       "convert it with `ros2 bag convert` to one without, or to MCAP with zstd");
    }
    for (const YAML::Node& entry : info["relative_file_paths"]) {
      const fs::path name(entry.as<std::string>());
      // Bags before Dashing name the folder too.
      files.push_back(fs::exists(folder / name) ? folder / name : folder / name.filename());
    }
  } catch (const YAML::Exception&) {
    files.clear();  // a damaged metadata.yaml costs nothing: the files say it all again
  }
  return files;
}

}  // namespace

bool is_sqlite(const fs::path& file) {
  return begins_with(file, std::string_view("SQLite format 3\0", 16));
}
bool is_mcap(const fs::path& file) { return begins_with(file, "\x89MCAP0\r\n"); }

std::vector<fs::path> bag_files(const fs::path& folder) {
  std::vector<fs::path> files = files_of_metadata(folder);
  if (files.empty()) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".db3" || ending == ".mcap") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
  }
  if (files.empty()) {
    throw InputError(folder.string(), "is a folder without a bag in it",
                     "name a folder with metadata.yaml, .db3 or .mcap files");
  }
  return files;
}

void write_bag_metadata(const fs::path& folder, const BagSummary& summary) {
  std::size_t total = 0;
  for (const std::size_t count : summary.counts) total += count;
  YAML::Emitter out;
  const auto duration = [&] {
    out << YAML::Key << "duration" << YAML::Value << YAML::BeginMap << YAML::Key << "nanoseconds"
        << YAML::Value << (summary.end - summary.begin).ns << YAML::EndMap;
  };
  const auto begin = [&] {
    out << YAML::Key << "starting_time" << YAML::Value << YAML::BeginMap << YAML::Key
        << "nanoseconds_since_epoch" << YAML::Value << summary.begin.ns << YAML::EndMap;
  };
  out << YAML::BeginMap << YAML::Key << "rosbag2_bagfile_information" << YAML::Value
      << YAML::BeginMap;
  out << YAML::Key << "version" << YAML::Value << 5;
  out << YAML::Key << "storage_identifier" << YAML::Value
      << (summary.storage == BagStorage::kMcap ? "mcap" : "sqlite3");
  duration();
  begin();
  out << YAML::Key << "message_count" << YAML::Value << total;
  out << YAML::Key << "topics_with_message_count" << YAML::Value << YAML::BeginSeq;
  for (std::size_t i = 0; i < summary.topics.size(); ++i) {
    const BagTopic& topic = summary.topics[i];
    out << YAML::BeginMap << YAML::Key << "topic_metadata" << YAML::Value << YAML::BeginMap
        << YAML::Key << "name" << YAML::Value << topic.name << YAML::Key << "type" << YAML::Value
        << topic.type << YAML::Key << "serialization_format" << YAML::Value
        << topic.serialization_format << YAML::Key << "offered_qos_profiles" << YAML::Value
        << YAML::DoubleQuoted << topic.offered_qos_profiles << YAML::EndMap << YAML::Key
        << "message_count" << YAML::Value << summary.counts[i] << YAML::EndMap;
  }
  out << YAML::EndSeq;
  out << YAML::Key << "compression_format" << YAML::Value << YAML::DoubleQuoted << "";
  out << YAML::Key << "compression_mode" << YAML::Value << YAML::DoubleQuoted << "";
  out << YAML::Key << "relative_file_paths" << YAML::Value << YAML::BeginSeq << summary.file
      << YAML::EndSeq;
  out << YAML::Key << "files" << YAML::Value << YAML::BeginSeq << YAML::BeginMap << YAML::Key
      << "path" << YAML::Value << summary.file;
  begin();
  duration();
  out << YAML::Key << "message_count" << YAML::Value << total << YAML::EndMap << YAML::EndSeq;
  out << YAML::EndMap << YAML::EndMap;
  WholeFile file(folder / "metadata.yaml");
  file.stream() << out.c_str() << '\n';
  file.commit();
}

}  // namespace strata::log
