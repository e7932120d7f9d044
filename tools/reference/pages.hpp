// SPDX-License-Identifier: Apache-2.0
/// The reference pages of docs/reference, made from the config structs, so that they cannot drift.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/settings/reference_page.hpp"

namespace strata::reference {

struct Page {
  std::string file;  ///< name in docs/reference, "scenario.md"
  std::string text;
  std::vector<settings::ReferenceRow> rows;
  std::vector<settings::PresetLine> presets;
};

/// Every page. A new config struct that users can set gets a line in pages.cpp.
[[nodiscard]] std::vector<Page> make_pages();

/// Writes the pages into a folder. Throws OutputError.
void write_pages(const std::filesystem::path& folder);

/// The files of the folder that are not as write_pages would write them; missing ones too.
[[nodiscard]] std::vector<std::string> outdated_pages(const std::filesystem::path& folder);

}  // namespace strata::reference
