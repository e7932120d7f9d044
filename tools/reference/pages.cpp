// SPDX-License-Identifier: Apache-2.0
#include "tools/reference/pages.hpp"

#include <fstream>
#include <sstream>

#include "components/settings/reference_page.hpp"
#include "core/base/error.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/slam/slam.hpp"
#include "memory/nodes/timescale_config.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::reference {
namespace {

template <typename Config>
Page page(const std::string& file, const std::string& title, const std::string& about) {
  return {file, "# " + title + "\n\n" + about +
                    "\n\nMade by `strata-reference` from the code; do not edit. Keys of groups are "
                    "joined by dots, as `--set` takes them; `[]` stands for each item of a "
                    "list.\n\n" +
                    settings::reference_markdown<Config>()};
}

}  // namespace

std::vector<Page> make_pages() {
  return {
      page<slam::SlamConfig>("slam.md", "Settings of mapping",
                             "How scans become poses, beam labels and maps (`core/slam`)."),
      page<patch::PatchLearnerConfig>(
          "patch_learner.md", "Settings of patch learning",
          "How sub-maps and their configurations are found (`core/patch`)."),
      page<memory::TimescaleConfig>("timescale.md", "Settings of the timescale memory",
                                    "Nodes, levels and how fast they forget (`memory/nodes`)."),
      page<simulate::ScenarioConfig>("scenario.md", "Scenario files",
                                     "What `strata simulate SCENARIO.yaml` reads; a file begins "
                                     "with `version: 1`. Examples lie "
                                     "in `tools/simulate/scenarios`."),
  };
}

void write_pages(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const Page& page : make_pages()) {
    std::ofstream out(folder / page.file, std::ios::binary);
    out << page.text;
    out.close();
    if (!out) {
      throw OutputError((folder / page.file).string(), "cannot be written",
                        "check the folder and the free space");
    }
  }
}

std::vector<std::string> outdated_pages(const std::filesystem::path& folder) {
  std::vector<std::string> outdated;
  for (const Page& page : make_pages()) {
    std::ifstream in(folder / page.file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    if (!in || text.str() != page.text) outdated.push_back(page.file);
  }
  return outdated;
}

}  // namespace strata::reference
