// SPDX-License-Identifier: Apache-2.0
#include "components/site/zones.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include "components/site/zone_feature.hpp"
#include "core/base/error.hpp"

namespace fs = std::filesystem;

namespace strata::site {
namespace {

using Document = Zones::Document;

constexpr std::size_t kMaxBytes = 16'000'000;
constexpr int kMaxDepth = 32;
constexpr std::size_t kMaxFeatures = 10'000;

const char* kWhole = "give a GeoJSON FeatureCollection of polygons (docs/site.md, \"Zones\")";

std::size_t line_of(const std::string& text, std::size_t byte) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(byte, text.size()));
  return 1 + static_cast<std::size_t>(std::count(text.begin(), end, '\n'));
}

/// Throws InputError.
Document parsed(const std::string& text, const std::string& place) {
  if (text.size() > kMaxBytes) {
    throw InputError(place, "is larger than 16 MB", "draw zones with fewer corners");
  }
  const auto within_depth = [&](int depth, Document::parse_event_t, Document&) {
    if (depth > kMaxDepth) throw InputError(place, "is nested more than 32 deep", kWhole);
    return true;
  };
  try {
    return Document::parse(text, within_depth);
  } catch (const Document::parse_error& error) {
    throw InputError(place + ":" + std::to_string(line_of(text, error.byte)), "is no JSON",
                     "mend it there; NaN and Infinity are none either");
  } catch (const Document::exception&) {
    throw InputError(place, "has a number that is too large", "write coordinates in metres");
  }
}

std::string words_of(const std::string& name) {
  return Document(name).dump(-1, ' ', false, Document::error_handler_t::replace);
}

}  // namespace

const char* name_of(ZoneKind kind) {
  constexpr std::array kNames{"learn", "keepout", "speed", "preferred", "lift"};
  return kNames.at(static_cast<std::size_t>(kind));
}

const char* name_of(LearnControl control) {
  constexpr std::array kNames{"learn", "static_only", "never_learn"};
  return kNames.at(static_cast<std::size_t>(control));
}

double area_m2(const Zone& zone) {
  double area = 0.0;
  for (const MetricPolygon& polygon : zone.shape) area += area_m2(polygon);
  return area;
}

const Zone* Zones::find(const std::string& name) const {
  const auto found =
      std::find_if(zones.begin(), zones.end(), [&](const Zone& zone) { return zone.name == name; });
  return found == zones.end() ? nullptr : &*found;
}

Zones no_zones() { return {{{"type", "FeatureCollection"}, {"features", Document::array()}}, {}}; }

Zones zones_of(Document document, const std::string& place) {
  if (document.is_object() && document.value("type", Document()) == "Feature") {
    document = {{"type", "FeatureCollection"}, {"features", Document::array({document})}};
  }
  if (!document.is_object() || document.value("type", Document()) != "FeatureCollection" ||
      !document.contains("features") || !document["features"].is_array()) {
    throw InputError(place, "is no FeatureCollection", kWhole);
  }
  const Document& features = document["features"];
  if (features.size() > kMaxFeatures) {
    throw InputError(place, "has more than 10,000 features", "draw several as a MultiPolygon");
  }
  Zones result;
  std::set<std::string> names;
  std::size_t corners = 0;
  for (std::size_t i = 0; i < features.size(); ++i) {
    result.zones.push_back(read_feature(features[i], i, place, corners));
    const std::string& name = result.zones.back().name;
    if (!names.insert(name).second) {
      throw InputError(feature_place(place, i) + "properties.name",
                       "is " + words_of(name) + ", as another zone's",
                       "give each zone a name of its own");
    }
  }
  result.document = std::move(document);
  return result;
}

Zones parse_zones(const std::string& text, const std::string& place) {
  return zones_of(parsed(text, place), place);
}

namespace {

/// Throws InputError.
std::string text_of(const fs::path& file) {
  std::error_code error;
  std::ifstream in(file, std::ios::binary);
  if (!in || fs::is_directory(file, error)) {
    throw InputError(file.string(), "cannot be read as a file", "name a GeoJSON file of polygons");
  }
  std::string text;
  std::array<char, 65536> part{};
  while (text.size() <= kMaxBytes && (in.read(part.data(), part.size()), in.gcount() > 0)) {
    text.append(part.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) {
    throw InputError(file.string(), "cannot be read to its end", "check the disk");
  }
  return text;
}

/// The same shape as a zone that says nothing.
Document as_zone(const Document& feature, std::size_t index) {
  Document zone = {
      {"type", "Feature"},
      {"properties", {{"name", std::to_string(index)}, {"kind", "learn"}, {"control", "learn"}}}};
  if (feature.is_object() && feature.contains("geometry")) zone["geometry"] = feature["geometry"];
  return zone;
}

}  // namespace

Zones read_zones(const fs::path& file) { return parse_zones(text_of(file), file.string()); }

std::vector<MetricPolygon> read_region(const fs::path& file) {
  return parse_region(text_of(file), file.string());
}

std::vector<MetricPolygon> parse_region(const std::string& text, const std::string& place) {
  Document document = parsed(text, place);
  const Document type = document.is_object() ? document.value("type", Document()) : Document();
  if (type == "Polygon" || type == "MultiPolygon") document = {{"geometry", std::move(document)}};
  Document features = Document::array({document});
  if (type == "FeatureCollection") features = document.value("features", Document());
  if (features.empty()) {
    throw InputError(place, "has no polygon", "draw the region that is meant");
  }
  Document zones = Document::array();
  for (const Document& feature : features) zones.push_back(as_zone(feature, zones.size()));
  std::vector<MetricPolygon> region;
  const Document collection = {{"type", "FeatureCollection"}, {"features", std::move(zones)}};
  for (Zone& zone : zones_of(collection, place).zones) {
    std::move(zone.shape.begin(), zone.shape.end(), std::back_inserter(region));
  }
  return region;
}

void add(Zones& zones, const Zones& more, const std::string& place) {
  for (std::size_t i = 0; i < more.zones.size(); ++i) {
    if (zones.find(more.zones[i].name) == nullptr) continue;
    throw InputError(feature_place(place, i) + "properties.name",
                     "is " + words_of(more.zones[i].name) + ", which the site has already",
                     "name it otherwise, or `strata site zones SITE remove` that one first");
  }
  if (zones.zones.size() + more.zones.size() > kMaxFeatures) {
    throw InputError(place, "would make more than 10,000 features", "remove some first");
  }
  if (zones.zones.empty() && zones.document.size() <= 2) {
    zones = more;  // with what else its writer put there
    return;
  }
  for (const Document& feature : more.document["features"]) {
    zones.document["features"].push_back(feature);
  }
  zones.zones.insert(zones.zones.end(), more.zones.begin(), more.zones.end());
}

void remove(Zones& zones, const std::string& name, const std::string& place) {
  const Zone* found = zones.find(name);
  if (found == nullptr) {
    std::string there;
    for (const Zone& zone : zones.zones) there += (there.empty() ? "" : ", ") + words_of(zone.name);
    throw InputError(place, "has no zone " + words_of(name),
                     there.empty() ? "add some with `strata site zones SITE add`"
                                   : "there are " + there.substr(0, 500));
  }
  const auto number = static_cast<std::size_t>(found - zones.zones.data());
  zones.document["features"].erase(number);
  zones.zones.erase(zones.zones.begin() + static_cast<std::ptrdiff_t>(number));
}

std::string to_text(const Zones& zones) {
  const auto written = [](const Document& value) {
    return value.dump(-1, ' ', false, Document::error_handler_t::replace);
  };
  std::string text = "{";
  for (const auto& [key, value] : zones.document.items()) {
    text += (text.size() > 1 ? ",\n" : "\n") + written(key) + ": ";
    if (key != "features") {
      text += written(value);
      continue;
    }
    text += "[";
    for (std::size_t i = 0; i < value.size(); ++i) {
      text += (i > 0 ? ",\n" : "\n") + written(value[i]);
    }
    text += "\n]";
  }
  return text + "\n}\n";
}

Document to_feature(const std::vector<MetricPolygon>& shape, Document properties) {
  const auto ring_of = [](const MetricRing& ring, bool is_outer) {
    MetricRing turned = ring;
    if ((signed_area_m2(ring) < 0.0) == is_outer) std::reverse(turned.begin(), turned.end());
    Document points = Document::array();
    for (const Eigen::Vector2d& corner : turned) points.push_back({corner.x(), corner.y()});
    if (!points.empty()) points.push_back(Document(points.front()));
    return points;
  };
  Document polygons = Document::array();
  for (const MetricPolygon& polygon : shape) {
    Document rings = Document::array({ring_of(polygon.outer, true)});
    for (const MetricRing& hole : polygon.holes) rings.push_back(ring_of(hole, false));
    polygons.push_back(std::move(rings));
  }
  return {{"type", "Feature"},
          {"properties", std::move(properties)},
          {"geometry", {{"type", "MultiPolygon"}, {"coordinates", std::move(polygons)}}}};
}

Document to_collection(Document features, const std::string& frame) {
  return {{"type", "FeatureCollection"},
          {"frame", frame},  // metres in it, no degrees
          {"unit", "m"},
          {"features", std::move(features)}};
}

}  // namespace strata::site
