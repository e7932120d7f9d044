// SPDX-License-Identifier: Apache-2.0
#include "core/base/config.hpp"

#include <cmath>
#include <set>
#include <sstream>

namespace strata::detail {
namespace {

std::string text_of(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace

std::string join_path(const std::string& path, std::string_view name) {
  if (path.empty()) return std::string(name);
  return path + "." + std::string(name);
}

void check_range(double value, const FieldInfo& info, const std::string& path, Problems& problems) {
  if (std::isnan(value)) {
    problems.push_back({path, "is not a number", "give a number"});
  } else if (value < info.min) {
    problems.push_back({path,
                        "is " + text_of(value) + ", below the least value " + text_of(info.min),
                        "choose a value of at least " + text_of(info.min)});
  } else if (value > info.max) {
    problems.push_back({path,
                        "is " + text_of(value) + ", above the greatest value " + text_of(info.max),
                        "choose a value of at most " + text_of(info.max)});
  }
}

void throw_problems(const Problems& problems, const std::string& place) {
  std::string what;
  std::string remedy;
  std::set<std::string> told;
  for (const Problem& problem : problems) {
    // A value out of its range often breaks a requirement too, which says no more.
    if (!told.insert(problem.path).second) continue;
    if (!what.empty()) what += ", and ";
    what += problem.path + " " + problem.what;
    if (remedy.find(problem.remedy) != std::string::npos) continue;
    if (!remedy.empty()) remedy += ", and ";
    remedy += problem.remedy;
  }
  throw ConfigError(place, what, remedy);
}

}  // namespace strata::detail
