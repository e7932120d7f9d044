// SPDX-License-Identifier: Apache-2.0
/// Zones that people draw over a site's maps: a GeoJSON file in metres of the site's frame
/// (docs/site.md, "Zones").
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/grid/metric_polygon.hpp"

namespace strata::site {

inline constexpr const char* kZonesFile = "zones.geojson";

enum class ZoneKind {
  kLearn,      ///< what may be learned there: LearnControl
  kKeepout,    ///< robots do not drive there, or at a cost
  kSpeed,      ///< robots are no faster there
  kPreferred,  ///< robots rather drive there
  kLift,       ///< takes robots from level to level
};
[[nodiscard]] const char* name_of(ZoneKind kind);

enum class LearnControl {
  kLearn,       ///< everything, as where no zone is
  kStaticOnly,  ///< the map, but no areas that change
  kNeverLearn,  ///< nothing: what is known stays
};
[[nodiscard]] const char* name_of(LearnControl control);

struct Zone {
  std::string name;  ///< no other zone's
  ZoneKind kind = ZoneKind::kKeepout;
  LearnControl control = LearnControl::kLearn;  ///< of kLearn
  double cost_percent = 100.0;                  ///< of kKeepout; 100: not at all
  std::optional<double> speed_percent;          ///< of kSpeed, this or the next
  std::optional<double> speed_m_s;
  std::vector<std::string> levels;   ///< of kLift, those that it serves; empty: all
  std::vector<MetricPolygon> shape;  ///< in the site's frame
};
/// Without what lies in holes; parts that overlap count twice. O(corners).
[[nodiscard]] double area_m2(const Zone& zone);

/// A zones file: what this program knows of it, and the whole as it was written, so that what other
/// programs keep in it is theirs to find again.
struct Zones {
  using Document = nlohmann::ordered_json;  // keys stay where their writer put them
  Document document;                        ///< a FeatureCollection
  std::vector<Zone> zones;                  ///< one each feature, in order

  [[nodiscard]] const Zone* find(const std::string& name) const;
};

/// None, in a document without features.
[[nodiscard]] Zones no_zones();
/// Of the text of a FeatureCollection, or of one Feature. place: the file, for errors. Throws
/// InputError at "PLACE: feature N: PATH" for what is no zone (docs/site.md says what is one), is
/// larger than any building, or has a name twice. O(bytes).
[[nodiscard]] Zones parse_zones(const std::string& text, const std::string& place);
/// Throws InputError, also where there is no such file.
[[nodiscard]] Zones read_zones(const std::filesystem::path& file);
/// A region: the polygons of a FeatureCollection, a Feature, a Polygon or a MultiPolygon, whatever
/// their properties say, such as features of diff.geojson. Throws InputError as read_zones.
[[nodiscard]] std::vector<MetricPolygon> read_region(const std::filesystem::path& file);
/// Of its text; place: the file, for errors.
[[nodiscard]] std::vector<MetricPolygon> parse_region(const std::string& text,
                                                      const std::string& place);
/// Of a document of one's own making, such as features of a mask; else as parse_zones().
[[nodiscard]] Zones zones_of(Zones::Document document, const std::string& place);

/// Adds the features of `more`. Throws InputError where a name is there already; place: of `more`.
void add(Zones& zones, const Zones& more, const std::string& place);
/// Throws InputError where there is no zone of that name; place: of the zones.
void remove(Zones& zones, const std::string& name, const std::string& place);

/// The document, a line a feature.
[[nodiscard]] std::string to_text(const Zones& zones);

/// A feature without further properties than `properties`; closed rings, outer ones
/// counterclockwise, holes clockwise, as RFC 7946 has them. O(corners).
[[nodiscard]] Zones::Document to_feature(const std::vector<MetricPolygon>& shape,
                                         Zones::Document properties);
/// The document of such features, which says that its coordinates are metres in `frame`.
[[nodiscard]] Zones::Document to_collection(Zones::Document features, const std::string& frame);

}  // namespace strata::site
