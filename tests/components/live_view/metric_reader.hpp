// SPDX-License-Identifier: Apache-2.0
/// Reads metrics as strictly as the texts of the formats ask: OpenMetrics 1.0 (with `counter`
/// families named without _total) and Prometheus' text format 0.0.4.
#pragma once

#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace strata::test {

struct ReadMetrics {
  struct Family {
    std::string type;
    std::string unit;
    std::string help;
  };
  std::map<std::string, Family> families;
  std::map<std::string, double> samples;  ///< by name and labels as written
};

class MetricReader {
 public:
  explicit MetricReader(bool is_openmetrics) : is_openmetrics_(is_openmetrics) {}

  /// Throws std::runtime_error that names the line.
  ReadMetrics read(const std::string& text) {
    if (!text.ends_with("# EOF\n")) fail("does not end with # EOF");
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
      line_ = line;
      if (has_ended_) fail("something stands behind # EOF");
      if (line == "# EOF") {
        has_ended_ = true;
      } else if (line.starts_with("# ")) {
        read_comment(line.substr(2));
      } else {
        read_sample(line);
      }
    }
    for (const auto& [name, family] : result_.families) check_family(name, family);
    return result_;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw std::runtime_error(why + ": '" + line_ + "'");
  }
  static bool is_name(const std::string& name) {
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) return false;
    return name.find_first_not_of(
               "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
           std::string::npos;
  }
  void read_comment(const std::string& comment) {
    std::istringstream words(comment);
    std::string kind;
    std::string name;
    words >> kind >> name;
    std::string rest;
    std::getline(words, rest);
    if (rest.size() < 2 || rest[0] != ' ') fail("a comment without text");
    rest = rest.substr(1);
    if (!is_name(name)) fail("no name of a metric");
    if (kind == "HELP") {
      if (result_.families.contains(name)) fail("a family comes twice");
      family_ = name;
      result_.families[name].help = rest;
      return;
    }
    if (name != family_) fail("a comment of another family");
    if (kind == "TYPE") {
      result_.families[name].type = rest;
    } else if (kind == "UNIT") {
      if (!name.ends_with("_" + rest) && !name.ends_with("_" + rest + "_total")) {
        fail("the unit does not end the name");
      }
      result_.families[name].unit = rest;
    } else {
      fail("a comment of no known kind");
    }
  }
  void read_sample(const std::string& line) {
    const std::size_t space = line.rfind(' ');
    if (space == std::string::npos) fail("a sample without value");
    const std::string head = line.substr(0, space);
    const std::string name = head.substr(0, head.find('{'));
    if (!is_name(name)) fail("no name of a metric");
    if (!belongs(name)) fail("a sample outside its family");
    if (head.size() > name.size()) check_labels(head.substr(name.size()));
    std::size_t used = 0;
    const std::string number = line.substr(space + 1);
    const double value = std::stod(number, &used);
    if (used != number.size()) fail("no number");
    if (!result_.samples.emplace(head, value).second) fail("a sample comes twice");
  }
  bool belongs(const std::string& name) const {
    if (family_.empty()) return false;
    const std::string& type = result_.families.at(family_).type;
    if (type == "histogram") {
      return name == family_ + "_bucket" || name == family_ + "_count" || name == family_ + "_sum";
    }
    if (is_openmetrics_ && type == "counter") return name == family_ + "_total";
    if (is_openmetrics_ && type == "info") return name == family_ + "_info";
    return name == family_;
  }
  void check_labels(const std::string& labels) const {
    if (!labels.ends_with('}')) fail("labels without end");
    std::set<std::string> names;
    for (std::size_t at = 1; at < labels.size();) {
      const std::size_t equals = labels.find("=\"", at);
      if (equals == std::string::npos) fail("a label without value");
      const std::string name = labels.substr(at, equals - at);
      if (!is_name(name) || !names.insert(name).second) fail("a label's name");
      at = equals + 2;
      while (at < labels.size() && labels[at] != '"') {
        const auto c = static_cast<unsigned char>(labels[at]);
        if (c < ' ' || c > '~') fail("a byte that is no printable ASCII");
        if (c == '\\' && std::string("\\\"n").find(labels.at(++at)) == std::string::npos) {
          fail("an escape that is none");
        }
        ++at;
      }
      if (at + 1 >= labels.size()) fail("a label without end");
      ++at;
      if (labels[at] == '}') return;
      if (labels[at] != ',') fail("something between labels");
      ++at;
    }
    fail("labels without end");
  }
  void check_family(const std::string& name, const ReadMetrics::Family& family) const {
    const std::set<std::string> types{"gauge", "counter", "histogram", "info"};
    if (!types.contains(family.type)) throw std::runtime_error(name + ": type " + family.type);
    if (family.help.empty()) throw std::runtime_error(name + ": no help");
    if (is_openmetrics_ == name.ends_with("_total") && family.type == "counter") {
      throw std::runtime_error(name + ": a counter's name");
    }
    if (family.type != "histogram") return;
    check_histograms(name);
  }
  /// Cumulative, the last is +Inf, which is the count.
  void check_histograms(const std::string& name) const {
    std::map<std::string, std::map<double, double>> buckets;
    for (const auto& [head, value] : result_.samples) {
      if (!head.starts_with(name + "_bucket{")) continue;
      const std::size_t at = head.rfind("le=\"");
      const std::string bound = head.substr(at + 4, head.size() - at - 6);
      if (is_openmetrics_ && bound != "+Inf" && bound.find_first_of(".e") == std::string::npos) {
        throw std::runtime_error(head + ": the bound is no float");
      }
      std::string labels = head.substr(name.size() + 7, at - name.size() - 7);
      labels = labels == "{" ? "" : labels.substr(0, labels.size() - 1) + "}";
      buckets[labels][std::stod(bound)] = value;
    }
    if (buckets.empty()) throw std::runtime_error(name + ": a histogram without buckets");
    for (const auto& [labels, counts] : buckets) {
      double before = 0.0;
      for (const auto& [bound, count] : counts) {
        if (count < before) throw std::runtime_error(name + labels + ": falls");
        before = count;
      }
      if (!std::isinf(counts.rbegin()->first) ||
          result_.samples.at(name + "_count" + labels) != before ||
          !result_.samples.contains(name + "_sum" + labels)) {
        throw std::runtime_error(name + labels + ": +Inf, count or sum");
      }
    }
  }

  bool is_openmetrics_;
  bool has_ended_ = false;
  std::string line_;
  std::string family_;
  ReadMetrics result_;
};

}  // namespace strata::test
