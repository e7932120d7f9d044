// SPDX-License-Identifier: Apache-2.0
/// A counting map that keeps, beside hits and misses, where in each cell the hits lay, and a match
/// field that follows it scan by scan.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/grid/counting_map.hpp"
#include "core/grid/grid.hpp"
#include "core/grid/tiled_grid.hpp"
#include "core/registration/match_field.hpp"
#include "core/scan/scan.hpp"

namespace strata::slam {

/// What a cell of a surface map says about a point.
enum class SurfaceState : std::uint8_t { kUnknown, kFree, kOccupied };
[[nodiscard]] constexpr SurfaceState last_enumerator(SurfaceState /*of*/) {
  return SurfaceState::kOccupied;
}

/// Counts as in CountingMap (length-weighted misses), in floats: it is made and thrown away often.
class SurfaceMap {
 public:
  SurfaceMap(double resolution_m, const registration::MatchFieldConfig& config)
      : cells_(resolution_m), field_(resolution_m, config) {}
  /// Without a match field, whose memory is that of the whole rectangle: for surfaces().
  explicit SurfaceMap(double resolution_m)
      : cells_(resolution_m), field_(resolution_m), has_field_(false) {}

  /// Adds a scan taken at frame_from_laser. beam_weights: e(t,n), empty: 1. Beams longer than
  /// max_range_m carve free space up to there and end in nothing. carve = false: only hits enter,
  /// for scans whose weights already say what is static. O(cells crossed), or O(beams).
  void add(const Scan& scan, const Pose2& frame_from_laser, std::span<const float> beam_weights,
           double max_range_m, bool carve = true);

  [[nodiscard]] const registration::MatchField& field() const { return field_; }
  /// The surface in each cell that has one, row by row. O(cells).
  [[nodiscard]] std::vector<registration::SurfacePoint> surfaces() const;
  [[nodiscard]] SurfaceState state(const Eigen::Vector2d& point_m) const;
  /// Share of the beams that reached the point's cell which ended there; 0 where none did.
  [[nodiscard]] double reflection(double x_m, double y_m) const {
    const HitCell* hit = hit_cell(
        {cell_coordinate(x_m, cells_.resolution_m()), cell_coordinate(y_m, cells_.resolution_m())});
    if (hit == nullptr || !(hit->hits > 0.0F)) return 0.0;
    return static_cast<double>(hit->hits / (hit->hits + hit->misses));
  }
  /// Occupied somewhere in the 3 x 3 cells about the point.
  [[nodiscard]] bool occupied_near(const Eigen::Vector2d& point_m) const;
  /// The rectangle of cells touched so far.
  [[nodiscard]] const CellRect& touched() const { return touched_; }
  /// Makes room for scans within the rectangle at once, as MatchField::reserve does.
  void reserve(const CellRect& rect);
  /// Gives the counts back and keeps only the field, to which nothing can be added any more.
  void forget_counts();

  /// For saved states; resolution and config are the constructor's.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    const double resolution_m = self.cells_.resolution_m();
    if constexpr (Archive::kReads) {
      Grid<HitCell> saved;
      archive(saved);
      archive(self.field_);
      archive(self.touched_);
      if (saved.resolution_m() != resolution_m || self.field_.resolution_m() != resolution_m) {
        archive.fail("has a map of another resolution");
      }
      const auto count = static_cast<std::int64_t>(self.field_.points().size());
      for (const HitCell& cell : saved.values()) {
        if (cell.point < -1 || cell.point >= count) archive.fail("has a damaged map");
      }
      self.restore_cells(saved);
    } else {
      archive(self.saved_cells());
      archive(self.field_);
      archive(self.touched_);
    }
  }

 private:
  /// A cell that beams ended in.
  struct HitCell {
    float hits = 0.0F;
    float misses = 0.0F;
    float sum_x = 0.0F;  // of hits, relative to the cell's least corner
    float sum_y = 0.0F;
    registration::NormalScatter normals;
    float slack_m = std::numeric_limits<float>::infinity();  // the least of all hits
    std::int32_t point = -1;                                 // index in the field
  };
  /// Most cells were only passed: one holds the bits of its misses, which are not negative, or
  /// ~index of its HitCell.
  using Code = std::int32_t;
  [[nodiscard]] static float misses_of(Code code) { return std::bit_cast<float>(code); }
  [[nodiscard]] static Code code_of(float misses) { return std::bit_cast<Code>(misses); }
  [[nodiscard]] static bool is_hit(Code code) { return code < 0; }
  [[nodiscard]] static std::size_t index_of(Code code) {
    const Code index = ~code;
    return static_cast<std::size_t>(index);
  }
  /// Null where no beam ended.
  [[nodiscard]] const HitCell* hit_cell(const Cell& cell) const {
    const Code code = cells_.get(cell);
    return is_hit(code) ? &hit_cells_[index_of(code)] : nullptr;
  }
  /// The cell as one that beams end in. Requires a cell of the grid.
  [[nodiscard]] HitCell& begin_hit_cell(Code& code);
  void carve_ray(const Ray& ray);
  void add_hit(const Cell& cell, const Eigen::Vector2d& at_m, float weight,
               const registration::SweepSurface& surface, double c2, double s2);
  [[nodiscard]] Grid<HitCell> saved_cells() const;
  void restore_cells(const Grid<HitCell>& saved);
  [[nodiscard]] bool is_surface(const HitCell& data) const {
    return data.hits >= static_cast<float>(field_.config().occupied_reflection) *
                            (data.hits + data.misses) &&
           data.hits > 0.0F;
  }
  /// Whether no scan told which way the surface runs, as when the beams lie far apart.
  [[nodiscard]] static bool is_unresolved(const HitCell& data) {
    return data.normals.xx + data.normals.yy < 0.5F * data.hits;
  }
  /// How far about a cell others tell which way its surface runs.
  static constexpr int kAmong = 6;
  [[nodiscard]] Eigen::Vector2d mean_hit(const Cell& cell, const HitCell& data) const;
  /// Which way the surface runs by the cells about it; empty where they are too few.
  [[nodiscard]] registration::NormalScatter normal_among(const Cell& cell) const;
  /// Nothing where there is no surface, or nobody can tell which way it runs.
  [[nodiscard]] std::optional<registration::NormalScatter> normals_of(const Cell& cell,
                                                                      const HitCell& data) const;
  void refresh(const Cell& cell);
  void set_point(registration::SurfacePoint& point, const Cell& cell, const HitCell& data,
                 const registration::NormalScatter& normals) const;

  TiledGrid<Code> cells_;
  std::vector<HitCell> hit_cells_;
  registration::MatchField field_;
  bool has_field_ = true;
  CellRect touched_;
  // Scratch.
  std::vector<std::pair<std::size_t, Ray>> rays_;
  std::vector<Cell> changed_;
  std::vector<registration::SweepSurface> surfaces_;
};

}  // namespace strata::slam
