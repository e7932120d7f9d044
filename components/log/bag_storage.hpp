// SPDX-License-Identifier: Apache-2.0
/// The storage files behind BagReader and BagWriter, and metadata.yaml.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "components/log/bag.hpp"

namespace strata::log {

[[nodiscard]] std::unique_ptr<BagReader> open_sqlite_bag(const std::filesystem::path& file);
[[nodiscard]] std::unique_ptr<BagReader> open_mcap(const std::filesystem::path& file);
[[nodiscard]] std::unique_ptr<BagWriter::File> create_sqlite_bag(const std::filesystem::path& file);
[[nodiscard]] std::unique_ptr<BagWriter::File> create_mcap(const std::filesystem::path& file,
                                                           BagCompression compression);

[[nodiscard]] bool is_sqlite(const std::filesystem::path& file);
[[nodiscard]] bool is_mcap(const std::filesystem::path& file);

/// What metadata.yaml of a written bag says.
struct BagSummary {
  BagStorage storage = BagStorage::kSqlite3;
  std::string file;
  std::vector<BagTopic> topics;
  std::vector<std::size_t> counts;  ///< per topic
  Stamp begin;
  Stamp end;
};
/// In the form of Humble (version 5). Throws OutputError.
void write_bag_metadata(const std::filesystem::path& folder, const BagSummary& summary);
/// The storage files of a bag folder in order; without a usable metadata.yaml every .db3 and .mcap
/// in it by name. Throws InputError when there is none, or when messages are compressed one by one.
[[nodiscard]] std::vector<std::filesystem::path> bag_files(const std::filesystem::path& folder);

/// The .msg text of a type with its dependencies as MCAP keeps it; empty for types we do not know.
[[nodiscard]] std::string message_definition(const std::string& type);

}  // namespace strata::log
