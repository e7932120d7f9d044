// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include <nlohmann/json.hpp>

#include "components/log/bag.hpp"
#include "components/log/map_file.hpp"
#include "components/log/trajectory_file.hpp"
#include "core/base/error.hpp"
#include "tools/expect/results.hpp"

namespace fs = std::filesystem;

namespace strata::expect {
namespace {

using log::FieldValue;
using nlohmann::json;

std::function<std::string(std::size_t)> names(std::vector<std::string> list) {
  const auto shared = std::make_shared<const std::vector<std::string>>(std::move(list));
  return [shared](std::size_t i) { return i < shared->size() ? (*shared)[i] : std::string(); };
}

FieldValue number(double value) { return {value, {}, false}; }
FieldValue text(std::string value) { return {0.0, std::move(value), true}; }

Series read_trajectory(const fs::path& file) {
  Series series{"scan", {}};
  const auto name_of = names({"x", "y", "theta"});
  for (const log::StampedPose& row : log::read_trajectory(file)) {
    series.entries.push_back({row.stamp,
                              {number(row.pose.x), number(row.pose.y), number(row.pose.theta)},
                              name_of,
                              {},
                              {}});
  }
  return series;
}

/// A table whose first column is the time and whose first line names the columns.
Series read_table(const fs::path& file) {
  std::ifstream in(file);
  const auto cells_of = [](const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  std::getline(in, line);
  std::vector<std::string> columns = cells_of(line);
  if (!columns.empty()) columns.erase(columns.begin());
  const auto name_of = names(std::move(columns));
  Series series{"row", {}};
  for (std::size_t number_of_line = 2; std::getline(in, line); ++number_of_line) {
    Entry entry;
    entry.name_of = name_of;
    try {
      const auto cells = cells_of(line);
      for (std::size_t i = 1; i < cells.size(); ++i) {
        entry.values.push_back(number(std::stod(cells[i])));
      }
      entry.stamp = Stamp::from_seconds(std::stod(cells.at(0)));
    } catch (const std::exception&) {
      throw InputError(file.string() + ":" + std::to_string(number_of_line), "is not a row",
                       "make the result again");
    }
    series.entries.push_back(std::move(entry));
  }
  return series;
}

void flatten(const json& value, const std::string& path, std::vector<std::string>& paths,
             std::vector<FieldValue>& values) {
  if (value.is_object()) {
    for (const auto& [key, child] : value.items()) {
      flatten(child, path.empty() ? key : path + "." + key, paths, values);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      flatten(value[i], path + "[" + std::to_string(i) + "]", paths, values);
    }
  } else {
    paths.push_back(path);
    values.push_back(value.is_number()   ? number(value.get<double>())
                     : value.is_string() ? text(value.get<std::string>())
                                         : text(value.dump()));
  }
}

Series read_json(const fs::path& file) {
  std::ifstream in(file);
  Entry entry;
  std::vector<std::string> paths;
  try {
    json content = json::parse(in);
    // What the folder is: expected results of before do not say it.
    if (file.filename() == "summary.json" && content.is_object()) content.erase("kind");
    flatten(content, "", paths, entry.values);
  } catch (const json::exception& error) {
    throw InputError(file.string(), std::string("is no JSON: ") + error.what(),
                     "make the result again");
  }
  entry.name_of = names(std::move(paths));
  return {"file", {std::move(entry)}};
}

Series read_map(const fs::path& file) {
  const ReflectionGrid grid = log::read_map(file);
  Entry entry;
  const CellRect rect = grid.rect();
  entry.values = {number(grid.resolution_m()), number(rect.min.x), number(rect.min.y),
                  number(rect.max.x), number(rect.max.y)};
  for (const float value : grid.values())
    entry.values.push_back(number(static_cast<double>(value)));
  const auto head = names({"resolution", "min_x", "min_y", "max_x", "max_y"});
  entry.name_of = [head, rect](std::size_t i) {
    if (i < 5) return head(i);
    const auto cell = static_cast<int>(i - 5);
    const int width = rect.max.x - rect.min.x;
    return "cell (" + std::to_string(rect.min.x + cell % width) + ", " +
           std::to_string(rect.min.y + cell / width) + ")";
  };
  return {"map", {std::move(entry)}};
}

void read_topics(const fs::path& bag, const std::string& prefix, Results& results) {
  const auto reader = log::BagReader::open(bag);
  for (const log::BagTopic& topic : reader->topics()) {
    results[prefix + topic.name] = {"message", {}};
  }
  log::BagMessage message;
  while (reader->next(message)) {
    const log::BagTopic& topic = reader->topics()[message.topic];
    Entry entry;
    entry.stamp = message.stamp;
    entry.type = topic.type;
    entry.bytes = message.data;
    results[prefix + topic.name].entries.push_back(std::move(entry));
  }
}

/// The folders of topics at and below `folder`.
std::vector<fs::path> topic_folders(const fs::path& folder) {
  std::vector<fs::path> found;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::end(it); ++it) {
    if (!it->is_directory() || it->path().filename() != kTopicsFolder) continue;
    found.push_back(it->path());
    it.disable_recursion_pending();
  }
  return found;
}

}  // namespace

Results read_results(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw InputError(folder.string(), "is no folder of results", "make it with --accept");
  }
  Results results;
  for (auto it = fs::recursive_directory_iterator(folder); it != fs::end(it); ++it) {
    const fs::path& path = it->path();
    const std::string name = path.lexically_relative(folder).string();
    if (it->is_directory()) {
      if (path.filename() == kTopicsFolder) it.disable_recursion_pending();
    } else if (path.extension() == ".tum") {
      results[name] = read_trajectory(path);
    } else if (path.extension() == ".csv") {
      results[name] = read_table(path);
    } else if (path.extension() == ".json") {
      results[name] = read_json(path);
    } else if (path.extension() == ".yaml" && fs::exists(fs::path(path).replace_extension("pgm"))) {
      results[name] = read_map(path);
    }
  }
  for (const fs::path& bag : topic_folders(folder)) {
    const std::string parent = bag.parent_path().lexically_relative(folder).string();
    read_topics(bag, parent == "." ? "" : parent + ":", results);
  }
  return results;
}

std::vector<std::string> recorded_topics(const fs::path& folder) {
  std::vector<std::string> topics;
  if (!fs::exists(folder / kTopicsFolder)) return topics;
  const auto reader = log::BagReader::open(folder / kTopicsFolder);
  for (const log::BagTopic& topic : reader->topics()) {
    topics.push_back(topic.name + ":" + topic.type);
  }
  std::sort(topics.begin(), topics.end());
  return topics;
}

}  // namespace strata::expect
