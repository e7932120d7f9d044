// SPDX-License-Identifier: Apache-2.0
/// The storage files behind BagReader and BagWriter, and metadata.yaml.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "components/log/bag.hpp"

namespace strata::log {

/// `shown` is the name in messages, where `file` is a temporary copy of it.
[[nodiscard]] std::unique_ptr<BagReader> open_sqlite_bag(const std::filesystem::path& file,
                                                         const std::filesystem::path& shown);
[[nodiscard]] std::unique_ptr<BagReader> open_mcap(const std::filesystem::path& file,
                                                   const std::filesystem::path& shown);
/// A bag of ROS 1, format 2.0, whose messages come out as those of ROS 2.
[[nodiscard]] std::unique_ptr<BagReader> open_ros1_bag(const std::filesystem::path& file,
                                                       const std::filesystem::path& shown);
/// Schema 3 or 4.
[[nodiscard]] std::unique_ptr<BagWriter::File> create_sqlite_bag(const std::filesystem::path& file,
                                                                 int schema);
[[nodiscard]] std::unique_ptr<BagWriter::File> create_mcap(const std::filesystem::path& file,
                                                           BagCompression compression);

[[nodiscard]] bool is_sqlite(const std::filesystem::path& file);
[[nodiscard]] bool is_mcap(const std::filesystem::path& file);
/// Of any format that ROS 1 had.
[[nodiscard]] bool is_ros1_bag(const std::filesystem::path& file);

/// What metadata.yaml of a written bag says.
struct BagSummary {
  struct File {
    std::string name;
    Stamp begin;
    Stamp end;
    std::size_t messages = 0;
  };
  BagStorage storage = BagStorage::kSqlite3;
  int sqlite_schema = 3;  ///< with kSqlite3
  BagPacking packing = BagPacking::kNone;
  std::vector<File> files;
  std::vector<BagTopic> topics;
  std::vector<std::size_t> counts;  ///< per topic
};
/// The text of metadata.yaml, in the form of Humble (version 5) with SQLite schema 3, else of Iron
/// (7), which tells the hashes of types; each reads the other's.
[[nodiscard]] std::string bag_metadata(const BagSummary& summary);
/// What stands in it below its only key. This is what rosbag2 keeps in an MCAP file: its reader
/// takes the record's map for the information itself and throws where that lies a level deeper, as
/// other programs write it.
[[nodiscard]] std::string bag_information(const BagSummary& summary);
/// Throws OutputError.
void write_bag_metadata(const std::filesystem::path& folder, const BagSummary& summary);

struct BagFolderFiles {
  std::vector<std::filesystem::path> files;  ///< in order; one that metadata names may be missing
  bool packed_messages = false;              ///< metadata says that messages are compressed
};
/// The storage files of a bag folder; without a usable metadata.yaml every .db3, .mcap and
/// .bag in it (packed ones too) by name, numbers in it by value. Throws InputError when there is
/// none, or when metadata names a compression that is not known here.
[[nodiscard]] BagFolderFiles bag_files(const std::filesystem::path& folder);

struct TypeDefinition {
  std::string encoding;
  std::string text;
};
/// What the topic brings from another bag, else what we know; of a type that nobody knows both are
/// empty, as rosbag2 has it since Iron.
[[nodiscard]] TypeDefinition definition_of(const BagTopic& topic);
/// The hash of a topic's type, from the bag it comes from or of the types in idl/; else empty.
[[nodiscard]] std::string type_hash_of(const BagTopic& topic);

}  // namespace strata::log
