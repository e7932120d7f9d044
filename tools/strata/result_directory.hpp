// SPDX-License-Identifier: Apache-2.0
/// Folders of results that say what they are, so that no verb replaces another one's.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "tools/strata/output_directory.hpp"
#include "tools/strata/verb_context.hpp"

namespace strata::tools {

/// What a folder holds, as "maps" or "comparison": key `kind` of its summary.json, else told by its
/// files; empty for what no verb wrote.
[[nodiscard]] std::string kind_of(const std::filesystem::path& folder);

/// How many runs the maps in a folder were learned from; 0 when there are none, or they cannot be
/// read.
[[nodiscard]] std::size_t runs_in(const std::filesystem::path& folder);

/// Adds --force to a verb that writes such a folder.
void add_force(CLI::App& verb, VerbContext& context);

/// Unless --force was given, throws OutputError where `folder` holds results of another kind, or,
/// in one that no verb wrote, something that those of this kind would replace
/// (written_names.hpp). kind: empty fits all.
void require_kind(const std::filesystem::path& folder, const std::string& kind,
                  const VerbContext& context);
/// The same where it holds maps of more than `runs` runs, which would be lost.
void require_no_more_runs(const std::filesystem::path& folder, std::size_t runs,
                          const VerbContext& context);

/// An OutputDirectory of one kind. Make it before the work: what is wrong with --out is then told
/// at once.
class ResultDirectory {
 public:
  /// Throws as OutputDirectory and require_kind.
  ResultDirectory(const std::filesystem::path& target, std::string kind, VerbContext& context);
  [[nodiscard]] const std::filesystem::path& path() const { return out_.path(); }
  /// Puts the kind into summary.json, which is made where there is none, and the folder in place.
  /// Throws OutputError.
  void commit();

 private:
  std::string kind_;
  OutputDirectory out_;
};

}  // namespace strata::tools
