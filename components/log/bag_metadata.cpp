// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <fstream>
#include <limits>
#include <system_error>

#include <yaml-cpp/yaml.h>

#include "components/convert/message_definitions.hpp"
#include "components/convert/type_hash.hpp"
#include "components/log/bag_storage.hpp"
#include "components/log/spooled_input.hpp"
#include "components/log/whole_file.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

bool begins_with(const fs::path& file, std::string_view magic) {
  std::ifstream in(readable_path(file), std::ios::binary);
  std::string head(magic.size(), '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return in && head == magic;
}

/// Throws InputError for a compression that cannot be unpacked here.
bool packs_messages(const YAML::Node& info, const fs::path& metadata) {
  auto mode = info["compression_mode"].as<std::string>("");
  auto format = info["compression_format"].as<std::string>("");
  std::transform(mode.begin(), mode.end(), mode.begin(),
                 [](unsigned char c) { return std::toupper(c); });
  if (mode.empty() || mode == "NONE") return false;
  if (!format.empty() && format != "zstd" && format != "lz4") {
    throw InputError(metadata.string(),
                     "the bag is compressed with " + format + ", which is not known here",
                     "convert it with `ros2 bag convert` to one with zstd or without");
  }
  return mode == "MESSAGE";
}

/// False also for a name that no file can have, as one of 300 letters.
bool is_there(const fs::path& file) {
  std::error_code error;
  return fs::exists(file, error);
}

/// The name as it is, below the folder (bags before Dashing name the folder too), and with or
/// without the ending of a compression: not every release gives the ending to packed files.
fs::path find_file(const fs::path& folder, const fs::path& name) {
  for (const fs::path& base : {folder / name, folder / name.filename()}) {
    if (is_there(base)) return base;
    const std::string ending = base.extension().string();
    if ((ending == ".zstd" || ending == ".lz4") && is_there(fs::path(base).replace_extension())) {
      return fs::path(base).replace_extension();
    }
    for (const char* more : {".zstd", ".lz4"}) {
      if (is_there(base.string() + more)) return base.string() + more;
    }
  }
  return folder / name.filename();
}

BagFolderFiles files_of_metadata(const fs::path& folder) {
  const fs::path path = folder / "metadata.yaml";
  BagFolderFiles found;
  if (!is_there(path)) return found;
  try {
    const YAML::Node info = YAML::LoadFile(path.string())["rosbag2_bagfile_information"];
    found.packed_messages = packs_messages(info, path);
    for (const YAML::Node& entry : info["relative_file_paths"]) {
      found.files.push_back(find_file(folder, entry.as<std::string>()));
    }
  } catch (const YAML::Exception&) {
    found.files.clear();  // a damaged metadata.yaml costs nothing: the files say it all again
  }
  // Names that lead nowhere are those of a bag that was renamed.
  if (std::none_of(found.files.begin(), found.files.end(),
                   [](const fs::path& file) { return is_there(file); })) {
    found.files.clear();
  }
  return found;
}

bool is_storage_file(const fs::path& file) {
  const std::string ending = file.extension().string();
  const bool packed = ending == ".zstd" || ending == ".lz4";
  const std::string inner = packed ? file.stem().extension().string() : ending;
  return inner == ".db3" || inner == ".mcap" || inner == ".bag";
}

/// bag_2 before bag_10.
bool by_number(const fs::path& a, const fs::path& b) {
  const auto key = [](const fs::path& path) {
    const std::string stem = path.filename().string().substr(0, path.filename().string().find('.'));
    const auto digits = std::find_if(stem.rbegin(), stem.rend(),
                                     [](unsigned char c) { return std::isdigit(c) == 0; });
    const auto split = static_cast<std::size_t>(stem.rend() - digits);
    return std::tuple(stem.substr(0, split), stem.size() - split, stem.substr(split));
  };
  return key(a) < key(b);
}

}  // namespace

bool is_sqlite(const fs::path& file) {
  return begins_with(file, std::string_view("SQLite format 3\0", 16));
}
bool is_mcap(const fs::path& file) { return begins_with(file, "\x89MCAP0\r\n"); }
bool is_ros1_bag(const fs::path& file) {
  return begins_with(file, "#ROSBAG V") || begins_with(file, "#ROSRECORD V");
}

BagFolderFiles bag_files(const fs::path& folder) {
  BagFolderFiles found = files_of_metadata(folder);
  if (found.files.empty()) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      if (is_storage_file(entry.path())) found.files.push_back(entry.path());
    }
    if (error) {
      throw InputError(folder.string(), "cannot be read: " + error.message(),
                       "check the folder's permissions");
    }
    std::sort(found.files.begin(), found.files.end(), by_number);
  }
  if (found.files.empty()) {
    throw InputError(folder.string(), "is a folder without a bag in it",
                     "name a folder with metadata.yaml, .db3, .mcap or .bag files");
  }
  return found;
}

TypeDefinition definition_of(const BagTopic& topic) {
  if (!topic.definition.empty()) return {topic.definition_encoding, topic.definition};
  const std::string known = convert::message_definition(topic.type);
  return {known.empty() ? "" : "ros2msg", known};
}

std::string type_hash_of(const BagTopic& topic) {
  return topic.type_hash.empty() ? convert::type_hash(topic.type) : topic.type_hash;
}

namespace {

void emit_span(YAML::Emitter& out, Stamp begin, Stamp end) {
  out << YAML::Key << "starting_time" << YAML::Value << YAML::BeginMap << YAML::Key
      << "nanoseconds_since_epoch" << YAML::Value << begin.ns << YAML::EndMap;
  out << YAML::Key << "duration" << YAML::Value << YAML::BeginMap << YAML::Key << "nanoseconds"
      << YAML::Value << (end - begin).ns << YAML::EndMap;
}

bool is_of_humble(const BagSummary& summary) {
  return summary.storage == BagStorage::kSqlite3 && summary.sqlite_schema < 4;
}

void emit_topics(YAML::Emitter& out, const BagSummary& summary) {
  out << YAML::Key << "topics_with_message_count" << YAML::Value << YAML::BeginSeq;
  for (std::size_t i = 0; i < summary.topics.size(); ++i) {
    const BagTopic& topic = summary.topics[i];
    out << YAML::BeginMap << YAML::Key << "topic_metadata" << YAML::Value << YAML::BeginMap
        << YAML::Key << "name" << YAML::Value << topic.name << YAML::Key << "type" << YAML::Value
        << topic.type << YAML::Key << "serialization_format" << YAML::Value
        << topic.serialization_format << YAML::Key << "offered_qos_profiles" << YAML::Value
        << YAML::DoubleQuoted << topic.offered_qos_profiles;
    if (!is_of_humble(summary)) {
      out << YAML::Key << "type_description_hash" << YAML::Value << YAML::DoubleQuoted
          << type_hash_of(topic);
    }
    out << YAML::EndMap << YAML::Key << "message_count" << YAML::Value << summary.counts[i]
        << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_files(YAML::Emitter& out, const BagSummary& summary) {
  out << YAML::Key << "relative_file_paths" << YAML::Value << YAML::BeginSeq;
  for (const auto& file : summary.files) out << file.name;
  out << YAML::EndSeq;
  out << YAML::Key << "files" << YAML::Value << YAML::BeginSeq;
  for (const auto& file : summary.files) {
    out << YAML::BeginMap << YAML::Key << "path" << YAML::Value << file.name;
    emit_span(out, file.begin, file.end);
    out << YAML::Key << "message_count" << YAML::Value << file.messages << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

void emit_information(YAML::Emitter& out, const BagSummary& summary) {
  std::size_t total = 0;
  Stamp begin{std::numeric_limits<std::int64_t>::max()};
  Stamp end{std::numeric_limits<std::int64_t>::min()};
  for (const auto& file : summary.files) {
    if (file.messages == 0) continue;
    total += file.messages;
    begin = std::min(begin, file.begin);
    end = std::max(end, file.end);
  }
  if (total == 0) begin = end = Stamp{};
  const bool packed = summary.packing != BagPacking::kNone;
  const char* const modes[] = {"", "FILE", "MESSAGE"};
  out << YAML::BeginMap;
  out << YAML::Key << "version" << YAML::Value << (is_of_humble(summary) ? 5 : 7);
  out << YAML::Key << "storage_identifier" << YAML::Value
      << (summary.storage == BagStorage::kMcap ? "mcap" : "sqlite3");
  emit_span(out, begin, end);
  out << YAML::Key << "message_count" << YAML::Value << total;
  emit_topics(out, summary);
  out << YAML::Key << "compression_format" << YAML::Value << YAML::DoubleQuoted
      << (packed ? "zstd" : "");
  out << YAML::Key << "compression_mode" << YAML::Value << YAML::DoubleQuoted
      << modes[static_cast<std::size_t>(summary.packing)];
  emit_files(out, summary);
  if (!is_of_humble(summary)) {
    // A map even though it is empty: some readers take no null here.
    out << YAML::Key << "custom_data" << YAML::Value << YAML::Flow << YAML::BeginMap
        << YAML::EndMap;
  }
  out << YAML::EndMap;
}

}  // namespace

std::string bag_information(const BagSummary& summary) {
  YAML::Emitter out;
  emit_information(out, summary);
  return out.c_str();
}

std::string bag_metadata(const BagSummary& summary) {
  YAML::Emitter out;
  out << YAML::BeginMap << YAML::Key << "rosbag2_bagfile_information" << YAML::Value;
  emit_information(out, summary);
  out << YAML::EndMap;
  return std::string(out.c_str()) + '\n';
}

void write_bag_metadata(const fs::path& folder, const BagSummary& summary) {
  WholeFile file(folder / "metadata.yaml");
  file.stream() << bag_metadata(summary);
  file.commit();
}

}  // namespace strata::log
