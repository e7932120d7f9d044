// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <sstream>

#include <Eigen/Eigenvalues>

#include "tools/pipeline/topology_files.hpp"
#include "tools/report/plot.hpp"

namespace strata::pipeline {
namespace {

using report::fixed;

constexpr double kMarginPixels = 30.0;
/// Standard deviations that an ellipse shows: 95 % in the plane.
constexpr double kEllipseSigmas = 2.448;

/// Metres to pixels, north up, all points in a box.
class Frame {
 public:
  Frame(const std::vector<Eigen::Vector2d>& points_m, double x, double y, double width,
        double height)
      : left_(x + kMarginPixels), bottom_(y + height - kMarginPixels) {
    Eigen::Vector2d max = points_m.front();
    min_ = max;
    for (const Eigen::Vector2d& point : points_m) {
      min_ = min_.cwiseMin(point);
      max = max.cwiseMax(point);
    }
    const Eigen::Vector2d size = (max - min_).cwiseMax(1.0);
    scale_ = std::min((width - 2.0 * kMarginPixels) / size.x(),
                      (height - 2.0 * kMarginPixels) / size.y());
  }
  [[nodiscard]] double x(double x_m) const { return left_ + scale_ * (x_m - min_.x()); }
  [[nodiscard]] double y(double y_m) const { return bottom_ - scale_ * (y_m - min_.y()); }
  [[nodiscard]] double scale() const { return scale_; }

 private:
  double left_;
  double bottom_;
  double scale_ = 1.0;
  Eigen::Vector2d min_;
};

std::string begin_svg(double width, double height) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + fixed(width, 0) + "\" height=\"" +
         fixed(height, 0) +
         "\" font-family=\"sans-serif\"><rect width=\"100%\" height=\"100%\" "
         "fill=\"white\"/>\n";
}

void line(std::ostringstream& out, double x0, double y0, double x1, double y1,
          const std::string& style) {
  out << "<line x1=\"" << fixed(x0, 1) << "\" y1=\"" << fixed(y0, 1) << "\" x2=\"" << fixed(x1, 1)
      << "\" y2=\"" << fixed(y1, 1) << "\" " << style << "/>\n";
}

void text(std::ostringstream& out, double x, double y, double size, const std::string& words,
          const std::string& style) {
  out << "<text x=\"" << fixed(x, 1) << "\" y=\"" << fixed(y, 1) << "\" font-size=\""
      << fixed(size, 0) << "\" " << style << ">" << report::escape(words) << "</text>\n";
}

/// Edges between the first visits of landmarks, then the landmarks with their numbers.
void draw_graph(std::ostringstream& out, const topology::Hypothesis& hypothesis, const Frame& frame,
                double dot) {
  const std::vector<std::size_t> firsts = topology::first_visits(hypothesis.labels);
  const auto at = [&](int label) -> const Pose2& {
    return hypothesis.poses[firsts[static_cast<std::size_t>(label)]];
  };
  std::set<std::pair<int, int>> drawn;
  for (std::size_t i = 1; i < hypothesis.labels.size(); ++i) {
    const auto pair = std::minmax({hypothesis.labels[i - 1], hypothesis.labels[i]});
    if (pair.first == pair.second || !drawn.insert(pair).second) continue;
    line(out, frame.x(at(pair.first).x), frame.y(at(pair.first).y), frame.x(at(pair.second).x),
         frame.y(at(pair.second).y), "stroke=\"#2a5caa\" stroke-width=\"2\"");
  }
  for (const std::size_t first : firsts) {
    const int label = hypothesis.labels[first];
    const auto visits = std::count(hypothesis.labels.begin(), hypothesis.labels.end(), label);
    const double x = frame.x(hypothesis.poses[first].x);
    const double y = frame.y(hypothesis.poses[first].y);
    out << "<circle cx=\"" << fixed(x, 1) << "\" cy=\"" << fixed(y, 1) << "\" r=\"" << fixed(dot, 1)
        << "\" fill=\"" << (visits > 1 ? "#c0392b" : "#555") << "\"/>\n";
    text(out, x + dot + 1.0, y - dot - 1.0, 12.0, std::to_string(label), "fill=\"#222\"");
  }
}

std::vector<Eigen::Vector2d> positions(const std::vector<Pose2>& poses) {
  std::vector<Eigen::Vector2d> points;
  for (const Pose2& pose : poses) points.push_back(pose.translation());
  return points;
}

void draw_ellipse(std::ostringstream& out, const Pose2Gaussian& location, const Frame& frame) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(
      location.covariance.topLeftCorner<2, 2>());
  const Eigen::Vector2d sigmas = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const double angle =
      -std::atan2(axes.eigenvectors()(1, 1), axes.eigenvectors()(0, 1)) * 180.0 / std::numbers::pi;
  out << "<ellipse rx=\"" << fixed(kEllipseSigmas * sigmas(1) * frame.scale(), 2) << "\" ry=\""
      << fixed(kEllipseSigmas * sigmas(0) * frame.scale(), 2) << "\" transform=\"translate("
      << fixed(frame.x(location.mean.x), 1) << " " << fixed(frame.y(location.mean.y), 1)
      << ") rotate(" << fixed(angle, 1)
      << ")\" fill=\"none\" stroke=\"#1e9e4a\" stroke-width=\"1.5\"/>\n";
}

}  // namespace

std::string draw_topologies(const TopologyMap& result, std::size_t count) {
  constexpr double kWidth = 460.0;
  constexpr double kHeight = 400.0;
  const std::size_t drawn = std::min(count, result.posterior.size());
  const std::size_t columns = std::min<std::size_t>(3, drawn);
  const std::size_t rows = (drawn + columns - 1) / columns;
  std::ostringstream out;
  out << begin_svg(kWidth * static_cast<double>(columns), kHeight * static_cast<double>(rows));
  for (std::size_t i = 0; i < drawn; ++i) {
    const topology::Hypothesis& hypothesis = result.posterior[i];
    const double x = kWidth * static_cast<double>(i % columns);
    const std::size_t row = i / columns;
    const double y = kHeight * static_cast<double>(row);
    draw_graph(out, hypothesis,
               Frame(positions(hypothesis.poses), x, y + 20.0, kWidth, kHeight - 20.0), 4.0);
    text(out, x + 12.0, y + 20.0, 15.0,
         "probability " + fixed(hypothesis.probability, 4) + ", " +
             std::to_string(topology::landmark_count(hypothesis.labels)) + " landmarks, " +
             std::to_string(hypothesis.labels.size()) + " visits",
         "fill=\"#000\"");
  }
  out << "</svg>\n";
  return out.str();
}

std::string draw_landmarks(const TopologyMap& result) {
  constexpr double kSide = 1400.0;
  const topology::Hypothesis& hypothesis = result.posterior.front();
  std::vector<Eigen::Vector2d> points;
  for (std::size_t i = 0; i < result.visits.size(); ++i) {
    for (const Eigen::Vector2d& point : result.visits[i].visit.cloud.points_m) {
      points.push_back(hypothesis.poses[i] * point);
    }
    points.push_back(hypothesis.poses[i].translation());
  }
  Eigen::Vector2d size = points.front();
  Eigen::Vector2d min = size;
  for (const Eigen::Vector2d& point : points) {
    min = min.cwiseMin(point);
    size = size.cwiseMax(point);
  }
  size -= min;
  const double longer = std::max({size.x(), size.y(), 1.0});
  const double width = std::max(500.0, kSide * size.x() / longer);
  const double height = std::max(500.0, kSide * size.y() / longer);
  const Frame frame(points, 0.0, 0.0, width, height);
  std::ostringstream out;
  out << begin_svg(width, height) << "<g fill=\"#334\">\n";
  for (const Eigen::Vector2d& point : points) {
    out << "<rect x=\"" << fixed(frame.x(point.x()), 1) << "\" y=\"" << fixed(frame.y(point.y()), 1)
        << "\" width=\"2.4\" height=\"2.4\"/>\n";
  }
  out << "</g>\n";
  draw_graph(out, hypothesis, frame, 4.0);
  for (const std::size_t first : topology::first_visits(hypothesis.labels)) {
    draw_ellipse(out, result.locations[first], frame);
  }
  out << "</svg>\n";
  return out.str();
}

}  // namespace strata::pipeline
