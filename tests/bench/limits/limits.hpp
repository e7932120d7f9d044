// SPDX-License-Identifier: Apache-2.0
/// What this machine can do at best: the bare form of each hot loop, without the exactness,
/// reproducibility and options of the real one, compiled for each SIMD target and run with the one
/// that the real one runs with. Benchmarks quote ratios to these, measured in the same run. Plain
/// arrays only: these files are compiled with other flags than the rest, so no type of another
/// library may pass.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace strata::limit {

/// Poses in cells and radians; arrays of equal length.
struct Particles {
  std::vector<float> x, y, theta, cosine, sine, sum, weight;
  explicit Particles(std::size_t count);
  [[nodiscard]] std::size_t size() const { return x.size(); }
};

/// A table of log-likelihoods, row by row.
struct Field {
  std::int32_t width = 0;
  std::int32_t height = 0;
  const float* values = nullptr;
};

/// End points in cells, in the frame of the robot.
struct Points {
  const float* x = nullptr;
  const float* y = nullptr;
  std::size_t count = 0;
};

/// particles.sum[i] = sum over points of the table: lanes are particles, one gather a point.
void weigh_gather(const Field& field, const Points& points, Particles& particles);
/// The same as a plain loop, left to the compiler.
void weigh_plain(const Field& field, const Points& points, Particles& particles);

struct Motion {
  float rotation1 = 0.0F, translation = 0.0F, rotation2 = 0.0F;
  float rotation_stddev = 0.0F, translation_stddev = 0.0F;
};
/// All of an update around the weights, in single precision: three normals a particle from a
/// shift register, weights, estimate, systematic resampling in one pass.
class Mcl {
 public:
  explicit Mcl(std::size_t count);
  [[nodiscard]] Particles& particles() { return now_; }
  /// The weighted mean after `points` were seen.
  struct Mean {
    float x = 0.0F, y = 0.0F, cosine = 0.0F, sine = 0.0F;
  };
  Mean update(const Motion& motion, const Field& field, const Points& points, float tempering);

 private:
  Particles now_, next_;
  std::vector<std::uint32_t> state_;
};

struct CellSum {
  float length = 0.0F;
  std::int32_t count = 0;
};
/// Segments in cells.
struct Segment {
  float x0, y0, x1, y1;
};
/// Adds length and count of each crossed cell, step by step with the crossing parameters added up
/// (Amanatides and Woo). Returns the number of cells.
std::size_t traverse(const std::vector<Segment>& segments, std::int32_t width, CellSum* cells);

/// Ranges in cells of `count` rays from (x, y) in the directions (c, s): sphere tracing, as many
/// rays at once as there are lanes, on a table of distances to the nearest obstacle in cells.
/// Stops below 0.75 cells; no exactness at the surface.
void cast(const Field& distances, const float* x, const float* y, const float* c, const float* s,
          std::size_t count, float most, float* ranges);

}  // namespace strata::limit
