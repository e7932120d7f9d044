// SPDX-License-Identifier: Apache-2.0
#include "components/log/relations_file.hpp"

#include <cmath>
#include <string>
#include <string_view>

#include "components/log/text.hpp"
#include "core/base/error.hpp"
#include "core/geometry/angle.hpp"

namespace strata::log {

std::vector<Relation> read_relations(const std::filesystem::path& path) {
  LineReader lines(path);
  std::string line;
  std::vector<std::string_view> words;
  std::vector<Relation> relations;
  while (lines.next(line)) {
    split(line, words);
    if (words.empty() || words[0].front() == '#') continue;
    bool good = words.size() >= 8;
    double values[6] = {};
    for (std::size_t i = 0; good && i < 6; ++i) {
      const auto value = parse_double(words[i + 2]);
      good = value && std::isfinite(*value);
      values[i] = value.value_or(0.0);
    }
    const auto first = good ? parse_stamp(words[0]) : std::nullopt;
    const auto second = good ? parse_stamp(words[1]) : std::nullopt;
    if (!first || !second) {
      throw InputError(lines.place(), "is not a relation", "rows are `t1 t2 x y z roll pitch yaw`");
    }
    relations.push_back({*first, *second, {values[0], values[1], wrap_angle(values[5])}});
  }
  if (!lines.damage().empty()) throw lines.damage_error();
  if (relations.empty()) {
    throw InputError(path.string(), "holds no relation", "rows are `t1 t2 x y z roll pitch yaw`");
  }
  return relations;
}

}  // namespace strata::log
