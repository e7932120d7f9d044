// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/paper/paper_command.hpp"

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>

#include <CLI/CLI.hpp>

#include "tools/laboratory/paper/figures.hpp"
#include "tools/laboratory/paper/make_figures.hpp"
#include "tools/laboratory/paper/paper_page.hpp"

namespace strata::paper {
namespace {

void run(const std::vector<std::string>& names, const Setting& setting,
         const std::filesystem::path& out, bool as_json) {
  if (names == std::vector<std::string>{"list"}) {
    for (const Figure& figure : all_figures())
      std::cout << figure.id << ": " << figure.title << "\n";
    return;
  }
  const std::vector<Figure> figures = select(all_figures(), names);
  std::filesystem::create_directories(out);
  // Written after every row: what is cut short leaves what it made.
  std::string missing;
  const std::vector<Row> rows = make_all(figures, setting, [&](const std::vector<Row>& so_far) {
    missing = write_page(out, so_far);
    const Row& row = so_far.back();
    std::cerr << row.figure.id << ": " << word(row.outcome.verdict) << ", "
              << report::fixed(row.took_s, 0) << " s\n";
  });
  std::cout << (as_json ? to_json(rows).dump(2) + "\n" : text_table(rows));
  if (!missing.empty()) std::cerr << missing << "\n";
}

}  // namespace

int paper_command(int count, char** words, const char* scenarios) {
  Setting setting;
  setting.scenarios = scenarios;
  const char* data = std::getenv("STRATA_DATA_DIR");
  setting.data = data == nullptr ? "../shared/data" : data;
  std::vector<std::string> names;
  std::filesystem::path out = "paper";
  bool as_json = false;
  CLI::App app{"figures and tables of the papers, with numbers and whether they hold"};
  app.add_option("NAME", names,
                 "a figure as `list` names it, em, patch, kessler, ptm, all, or list")
      ->required();
  app.add_option("--out", out, "folder of index.html, results.json and pictures");
  app.add_option("--data", setting.data,
                 "folder of the real logs; by itself STRATA_DATA_DIR, else ../shared/data");
  app.add_option("--scenarios", setting.scenarios, "folder of the scenario files");
  app.add_option("--seeds", setting.seeds, "how many; 0: as each figure has them")
      ->check(CLI::Range(0, 1000));
  app.add_option("--first-seed", setting.first_seed, "the first of them");
  app.add_option("--threads", setting.threads, "for the work inside")->check(CLI::Range(1, 64));
  app.add_flag("--json", as_json, "prints JSON instead of a table");
  CLI11_PARSE(app, count, words);
  try {
    run(names, setting, out, as_json);
  } catch (const std::exception& error) {
    std::cerr << "strata-experiments: error: " << error.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace strata::paper
