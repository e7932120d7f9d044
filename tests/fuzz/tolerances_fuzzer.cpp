// SPDX-License-Identifier: Apache-2.0
/// What a replay test expects: tolerances.yaml, a table and a JSON file, in this order. Results
/// are as expected when they are compared with themselves.
#include "tests/fuzz/fuzz_target.hpp"
#include "tools/expect/compare_results.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace strata;
  static const fuzz::ScratchFolder scratch;
  return fuzz::expect_value_or_error([&] {
    const auto [tolerances_text, results_text] = fuzz::split({data, size});
    const auto [table, json] = fuzz::split(results_text);
    scratch.write(expect::kTolerancesFile, tolerances_text);
    scratch.write("states.csv", table);
    scratch.write("summary.json", json);
    const expect::Tolerances tolerances = expect::load_tolerances(scratch.path());
    const expect::Results results = expect::read_results(scratch.path());
    if (!expect::compare_results(results, results, tolerances).empty()) __builtin_trap();
    // Nothing that differs: the patterns are asked about every value.
    expect::Results others = results;
    for (auto& [name, series] : others) {
      for (expect::Entry& entry : series.entries) {
        for (log::FieldValue& value : entry.values) {
          value.number += 1.0;
          value.text += "!";
        }
      }
    }
    for (const auto& difference : expect::compare_results(results, others, tolerances)) {
      if (expect::describe(difference).empty()) __builtin_trap();
    }
  });
}
