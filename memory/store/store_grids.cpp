// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "core/base/damage.hpp"
#include "memory/store/detail/blob.hpp"
#include "memory/store/detail/store_impl.hpp"

namespace strata::memory {
namespace detail {
namespace {

template <typename T>
struct GridKind;
template <>
struct GridKind<float> {
  static constexpr const char* name = "reflection";
};
template <>
struct GridKind<CellCounts> {
  static constexpr const char* name = "counts";
};
template <>
struct GridKind<std::uint8_t> {
  static constexpr const char* name = "mask";
};

template <>
struct GridKind<SurfaceCell> {
  static constexpr const char* name = "surfaces";
};

/// Grids that belong to a larger value have names with this mark, and are not listed.
constexpr char kInnerMark = '/';
/// The surfaces of a grid: a list, kept as a grid of one row, which older programs pass over.
constexpr const char* kSurfaces = "/surfaces";

/// Calls visit(Cell first, std::span<const T>) row by row, as TiledGrid::visit_rows does.
template <typename T, typename Visit>
void visit_rows(const Grid<T>& grid, Visit&& visit) {
  const auto width = static_cast<std::size_t>(grid.width());
  for (int y = grid.rect().min.y; y < grid.rect().max.y && width > 0; ++y) {
    const Cell first{grid.rect().min.x, y};
    visit(first, std::span<const T>(&grid.at(first), width));
  }
}
template <typename T, typename Visit>
void visit_rows(const TiledGrid<T>& grid, Visit&& visit) {
  grid.visit_rows(visit);
}

template <typename T>
std::byte byte_of(const T& value, std::size_t place) {
  std::byte raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  return raw[place];
}

/// to_planes of the values of the dense grid, compressed a row at a time: the planes of a large
/// building take more memory than all else.
template <typename T, template <typename> typename AnyGrid>
std::vector<std::byte> packed_planes(const AnyGrid<T>& grid) {
  const CellRect& rect = grid.rect();
  Compressor planes(grid.size() * sizeof(T));
  std::vector<std::byte> row(rect.empty() ? 0 : static_cast<std::size_t>(rect.width()));
  for (std::size_t place = 0; place < sizeof(T); ++place) {
    const std::byte fill = byte_of(grid.fill(), place);
    std::fill(row.begin(), row.end(), fill);
    int y = rect.min.y;
    const auto go_on_to = [&](int next) {
      for (; y < next; ++y) {
        planes.add(row);
        std::fill(row.begin(), row.end(), fill);
      }
    };
    visit_rows(grid, [&](const Cell& first, std::span<const T> cells) {
      go_on_to(first.y);
      std::byte* to = &row[static_cast<std::size_t>(first.x - rect.min.x)];
      for (const T& cell : cells) *to++ = byte_of(cell, place);
    });
    go_on_to(rect.max.y);
  }
  return planes.finish();
}

template <typename AnyGrid>
void write_any(Database& database, const std::string& name, const char* kind, const AnyGrid& grid) {
  const CellRect& rect = grid.rect();
  Statement(database,
            "REPLACE INTO grid (name, kind, resolution_m, min_x, min_y, max_x, max_y, fill, data) "
            "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)")
      .bind(name)
      .bind(std::string(kind))
      .bind(grid.resolution_m())
      .bind(rect.min.x)
      .bind(rect.min.y)
      .bind(rect.max.x)
      .bind(rect.max.y)
      .bind(std::as_bytes(std::span(&grid.fill(), 1)))
      .bind(packed_planes(grid))
      .run();
}

}  // namespace

template <typename T>
void write_grid(Database& database, const std::string& name, const Grid<T>& grid) {
  write_any(database, name, GridKind<T>::name, grid);
}

template <typename T>
Grid<T> read_grid(Database& database, const std::string& name) {
  Statement statement(database,
                      "SELECT kind, resolution_m, min_x, min_y, max_x, max_y, fill, data "
                      "FROM grid WHERE name = ?");
  if (!statement.bind(name).step()) throw_missing(database.place(), "grid '" + name + "'");
  if (statement.text(0) != GridKind<T>::name) {
    throw_missing(database.place(), std::string(GridKind<T>::name) + " grid '" + name +
                                        "' (it is a " + statement.text(0) + " grid)");
  }
  const std::string place = database.place() + ": grid '" + name + "'";
  auto coordinate = [&](int column) { return static_cast<int>(statement.integer(column)); };
  const CellRect rect{{coordinate(2), coordinate(3)}, {coordinate(4), coordinate(5)}};
  const std::vector<std::byte> fill_bytes = statement.blob(6);
  if (fill_bytes.size() != sizeof(T)) {
    throw DamageError(place, "its fill value is damaged", "take the store from a backup");
  }
  T fill{};
  std::memcpy(&fill, fill_bytes.data(), sizeof(T));
  const std::vector<std::byte> planes =
      decompress(statement.blob(7), rect.area() * sizeof(T), place);
  const double resolution_m = statement.real(1);
  if (!(resolution_m > 0.0)) {
    throw DamageError(place, "its cells have no size", "take the store from a backup");
  }
  Grid<T> grid(resolution_m, rect, fill);
  from_planes(planes, std::span<T>(grid.values()));
  return grid;
}

/// The grid of one row is as long as the list.
SurfaceLayer layer_of(const Grid<SurfaceCell>& row, const std::string& place) {
  if (!(row.rect().min == Cell{}) || row.rect().max.y != 1) {
    throw DamageError(place, "its surfaces are no list", "take the store from a backup");
  }
  return {row.resolution_m(), row.values()};
}

template void write_grid(Database&, const std::string&, const Grid<float>&);
template void write_grid(Database&, const std::string&, const Grid<CellCounts>&);
template void write_grid(Database&, const std::string&, const Grid<std::uint8_t>&);
template Grid<float> read_grid(Database&, const std::string&);
template Grid<CellCounts> read_grid(Database&, const std::string&);
template Grid<std::uint8_t> read_grid(Database&, const std::string&);

}  // namespace detail

void Store::save_grid(const std::string& name, const ReflectionGrid& grid) {
  transaction([&] { detail::write_grid(impl_->database, name, grid); });
}

void Store::save_grid(const std::string& name, const Grid<CellCounts>& grid) {
  transaction([&] { detail::write_grid(impl_->database, name, grid); });
}

void Store::save_grid(const std::string& name, const TiledGrid<CellCounts>& grid) {
  transaction(
      [&] { detail::write_any(impl_->database, name, detail::GridKind<CellCounts>::name, grid); });
}

void Store::save_surfaces(const std::string& name, const SurfaceLayer& layer) {
  const std::string inner = name + detail::kSurfaces;
  transaction([&] {
    detail::Statement(impl_->database, "DELETE FROM grid WHERE name = ?").bind(inner).run();
    if (layer.cells.empty()) return;
    const int count = static_cast<int>(layer.cells.size());
    Grid<SurfaceCell> row(layer.resolution_m, CellRect{{0, 0}, {count, 1}});
    std::copy(layer.cells.begin(), layer.cells.end(), row.values().begin());
    detail::write_grid(impl_->database, inner, row);
  });
}

SurfaceLayer Store::load_surfaces(const std::string& name) const {
  const std::string inner = name + detail::kSurfaces;
  if (!has_grid(inner)) return {};
  const auto row = detail::read_grid<SurfaceCell>(impl_->database, inner);
  return detail::layer_of(row, impl_->database.place() + ": grid '" + inner + "'");
}

ReflectionGrid Store::load_reflection_grid(const std::string& name) const {
  return detail::read_grid<float>(impl_->database, name);
}

Grid<CellCounts> Store::load_counts_grid(const std::string& name) const {
  return detail::read_grid<CellCounts>(impl_->database, name);
}

bool Store::has_grid(const std::string& name) const {
  detail::Statement statement(impl_->database, "SELECT 1 FROM grid WHERE name = ?");
  return statement.bind(name).step();
}

std::vector<std::string> Store::grid_names() const {
  detail::Statement statement(impl_->database, "SELECT name FROM grid ORDER BY name");
  std::vector<std::string> names;
  while (statement.step()) {
    if (std::string name = statement.text(0); name.find(detail::kInnerMark) == std::string::npos) {
      names.push_back(std::move(name));
    }
  }
  return names;
}

}  // namespace strata::memory
