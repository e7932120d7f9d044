// SPDX-License-Identifier: Apache-2.0
#include "components/site/zone_feature.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "components/settings/settings.hpp"
#include "core/base/error.hpp"

namespace strata::site {
namespace {

using Document = Zones::Document;

constexpr double kMaxReach_m = 10'000.0;
constexpr std::size_t kMaxCorners = 1'000'000;
constexpr double kMinArea_m2 = 1e-6;
constexpr std::size_t kMaxNameBytes = 200;
constexpr std::size_t kMaxTypo = 2;  // letters

constexpr std::array kKinds{ZoneKind::kLearn, ZoneKind::kKeepout, ZoneKind::kSpeed,
                            ZoneKind::kPreferred, ZoneKind::kLift};
constexpr std::array kControls{LearnControl::kLearn, LearnControl::kNeverLearn,
                               LearnControl::kStaticOnly};

constexpr const char* kName = "name";
constexpr const char* kKind = "kind";
constexpr const char* kControl = "control";
constexpr const char* kCost = "cost_percent";
constexpr const char* kPercent = "speed_percent";
constexpr const char* kMetres = "speed_m_s";
constexpr const char* kLevelNames = "levels";  // of other kinds it is its owner's

/// What a property is for; of those that not every kind has.
struct OwnKey {
  const char* name;
  ZoneKind kind;
};
constexpr std::array kOwnKeys{OwnKey{kControl, ZoneKind::kLearn}, OwnKey{kCost, ZoneKind::kKeepout},
                              OwnKey{kPercent, ZoneKind::kSpeed},
                              OwnKey{kMetres, ZoneKind::kSpeed}};

class FeatureReader {
 public:
  FeatureReader(const Document& feature, std::string place, std::size_t& corners)
      : feature_(feature), place_(std::move(place)), corners_(corners) {}

  [[nodiscard]] Zone read() {
    if (!feature_.is_object() || feature_.value("type", Document()) != "Feature") {
      fail("type", "is no Feature", "write {\"type\": \"Feature\", ...}");
    }
    if (!feature_.contains("properties") || !feature_["properties"].is_object()) {
      fail("properties", "are missing", "give the zone a name and a kind");
    }
    properties_ = &feature_["properties"];
    Zone zone;
    zone.name = text(kName);
    if (zone.name.empty() || zone.name.size() > kMaxNameBytes) {
      fail("properties.name", zone.name.empty() ? "is empty" : "is longer than 200 bytes",
           "give each zone a name of its own");
    }
    place_ +=
        "(" + Document(zone.name).dump(-1, ' ', true, Document::error_handler_t::replace) + ") ";
    zone.kind = choice(kKind, kKinds);
    require_fitting_keys(zone.kind);
    if (zone.kind == ZoneKind::kLearn) zone.control = choice(kControl, kControls);
    if (zone.kind == ZoneKind::kKeepout) {
      zone.cost_percent = number(kCost, 1.0, 100.0).value_or(zone.cost_percent);
    }
    if (zone.kind == ZoneKind::kSpeed) read_speed(zone);
    if (zone.kind == ZoneKind::kLift) read_levels(zone);
    read_geometry(zone);
    return zone;
  }

 private:
  [[noreturn]] void fail(const std::string& path, const std::string& what,
                         const std::string& remedy) const {
    throw InputError(place_ + path, what, remedy);
  }

  /// A table that many programs write has a column of every name: null is nothing.
  [[nodiscard]] const Document* property(const char* key) const {
    const auto found = properties_->find(key);
    return found == properties_->end() || found->is_null() ? nullptr : &*found;
  }

  [[nodiscard]] std::string text(const char* key) const {
    const Document* value = property(key);
    const std::string path = std::string("properties.") + key;
    if (value == nullptr) fail(path, "is missing", "each zone has a name and a kind");
    if (!value->is_string()) fail(path, "is no text", "put it in quotes");
    return value->get<std::string>();
  }

  template <typename Value, std::size_t kCount>
  [[nodiscard]] Value choice(const char* key, const std::array<Value, kCount>& values) const {
    const std::string name = text(key);
    std::string known;
    for (const Value value : values) {
      if (name == name_of(value)) return value;
      known += (known.empty() ? "" : ", ") + std::string(name_of(value));
    }
    fail(std::string("properties.") + key,
         "is " + Document(name.substr(0, kMaxNameBytes))
                     .dump(-1, ' ', true, Document::error_handler_t::replace),
         "choose among " + known);
  }

  [[nodiscard]] std::optional<double> number(const char* key, double least, double greatest) const {
    const Document* value = property(key);
    if (value == nullptr) return std::nullopt;
    const std::string path = std::string("properties.") + key;
    const std::string range = "write a number from " + Document(least).dump() + " to " +
                              Document(greatest).dump() + ", without quotes";
    if (!value->is_number()) fail(path, "is no number", range);
    const double given = value->get<double>();
    if (!(given >= least && given <= greatest)) fail(path, "is " + value->dump(), range);
    return given;
  }

  /// What others keep there is theirs; what is nearly ours, or ours elsewhere, is a mistake.
  void require_fitting_keys(ZoneKind kind) const {
    for (const auto& [key, value] : properties_->items()) {
      for (const OwnKey& own : kOwnKeys) {
        if (key == own.name && own.kind != kind && !value.is_null()) {
          fail("properties." + key, std::string("is for zones of kind ") + name_of(own.kind),
               "take it away, or change the kind");
        }
      }
      if (is_ours(key) || value.is_null() || key.size() > kMaxNameBytes) continue;
      for (const char* own : {kControl, kCost, kPercent, kMetres, kLevelNames}) {
        if (own == kLevelNames && (kind != ZoneKind::kLift || key == own)) continue;
        if (settings::detail::edit_distance(key, own) > kMaxTypo) continue;
        fail("properties." + key, "is unknown", std::string("did you mean '") + own + "'?");
      }
    }
  }

  [[nodiscard]] static bool is_ours(const std::string& key) {
    return key == kName || key == kKind ||
           std::any_of(kOwnKeys.begin(), kOwnKeys.end(),
                       [&](const OwnKey& own) { return key == own.name; });
  }

  void read_speed(Zone& zone) const {
    // What rounds to 0 would be no limit to nav2.
    zone.speed_percent = number(kPercent, 1.0, 100.0);
    zone.speed_m_s = number(kMetres, 0.01, 10.0);
    if (zone.speed_percent.has_value() == zone.speed_m_s.has_value()) {
      fail("properties", zone.speed_m_s ? "have speed_percent and speed_m_s" : "have no speed",
           "give one of speed_percent (1 to 100) and speed_m_s (0.01 to 10)");
    }
  }

  void read_levels(Zone& zone) const {
    const Document* names = property(kLevelNames);
    if (names == nullptr) return;
    const std::string path = std::string("properties.") + kLevelNames;
    const char* remedy = "write the names of two levels or more, [\"0\", \"1\"], or leave it out";
    if (!names->is_array() || names->size() < 2) fail(path, "is no list of two or more", remedy);
    for (const Document& name : *names) {
      if (!name.is_string()) fail(path, "holds what is no text", remedy);
      zone.levels.push_back(name.get<std::string>());
    }
  }

  void read_geometry(Zone& zone) {
    if (!feature_.contains("geometry") || !feature_["geometry"].is_object()) {
      fail("geometry", "is missing", "draw a polygon, or take the feature away");
    }
    const Document& geometry = feature_["geometry"];
    const Document type = geometry.value("type", Document());
    if (type != "Polygon" && type != "MultiPolygon") {
      fail("geometry.type", "is neither Polygon nor MultiPolygon",
           "draw it as a polygon; a line needs a width");
    }
    const std::string path = "geometry.coordinates";
    const Document& coordinates = array_at(geometry, "coordinates", path);
    if (type == "Polygon") {
      zone.shape.push_back(read_polygon(coordinates, path));
      return;
    }
    for (std::size_t i = 0; i < coordinates.size(); ++i) {
      zone.shape.push_back(read_polygon(coordinates[i], path + "[" + std::to_string(i) + "]"));
    }
  }

  [[nodiscard]] const Document& array_at(const Document& object, const char* key,
                                         const std::string& path) const {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_array() || found->empty()) {
      fail(path, "is empty", "draw a polygon, or take the feature away");
    }
    return *found;
  }

  [[nodiscard]] MetricPolygon read_polygon(const Document& rings, const std::string& path) {
    if (!rings.is_array() || rings.empty()) {
      fail(path, "is an empty polygon", "draw it, or take it away");
    }
    MetricPolygon polygon;
    for (std::size_t i = 0; i < rings.size(); ++i) {
      MetricRing ring = read_ring(rings[i], path + "[" + std::to_string(i) + "]");
      if (i == 0) {
        polygon.outer = std::move(ring);
      } else {
        polygon.holes.push_back(std::move(ring));
      }
    }
    return polygon;
  }

  [[nodiscard]] MetricRing read_ring(const Document& points, const std::string& path) {
    if (!points.is_array() || points.size() < 4) {
      fail(path, "has fewer than four positions",
           "a ring has at least three corners, and the "
           "first one again at its end");
    }
    corners_ += points.size();
    if (corners_ > kMaxCorners) {
      fail(path, "makes more than 1,000,000 corners of all zones", "draw fewer");
    }
    MetricRing ring;
    for (std::size_t i = 0; i < points.size(); ++i) {
      ring.push_back(read_point(points[i], path + "[" + std::to_string(i) + "]"));
    }
    if (ring.front() != ring.back()) {
      fail(path, "does not end where it begins", "repeat its first position at its end");
    }
    ring.pop_back();
    if (std::abs(signed_area_m2(ring)) < kMinArea_m2) {
      fail(path, "holds no area, or as much on one side of itself as on the other",
           "draw a polygon whose sides do not cross");
    }
    return ring;
  }

  [[nodiscard]] Eigen::Vector2d read_point(const Document& point, const std::string& path) const {
    if (!point.is_array() || point.size() < 2 || !point[0].is_number() || !point[1].is_number()) {
      fail(path, "is no position", "write [x, y] in metres of the site's frame");
    }
    const Eigen::Vector2d read(point[0].get<double>(), point[1].get<double>());
    if (!(read.cwiseAbs().maxCoeff() <= kMaxReach_m)) {
      fail(path, "is further than 10 km from the origin",
           "write metres in the site's frame; coordinates of the earth have to be moved there");
    }
    return read;
  }

  const Document& feature_;
  const Document* properties_ = nullptr;
  std::string place_;
  std::size_t& corners_;
};

}  // namespace

std::string feature_place(const std::string& place, std::size_t index) {
  return place + ": feature " + std::to_string(index + 1) + ": ";
}

Zone read_feature(const Document& feature, std::size_t index, const std::string& place,
                  std::size_t& corners) {
  return FeatureReader(feature, feature_place(place, index), corners).read();
}

}  // namespace strata::site
