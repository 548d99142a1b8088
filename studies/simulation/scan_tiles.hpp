// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/clouds/cloud_writer.hpp"

namespace surefoot::app {

/// Scene, seed and stations of a scan, for the index file.
struct ScanOrigin {
    std::string scene;
    std::uint64_t seed = 0;
    std::vector<Eigen::Vector3d> stations_m;
    bool complete = true;  ///< false = an error or the user ended the scan early
};

/// Writes a scan as a folder of square tiles. "tile_X_Y.ply" holds the points with x from X to X +
/// 1 and y from Y to Y + 1, in units of the tile side. A point on a border belongs to the tile with
/// the greater number. finish() writes index.json last; a folder without index.json is incomplete.
class ScanTiles {
  public:
    /// `format`: "ply" or "pcd", both binary. Removes an existing index first.
    [[nodiscard]] static Result<ScanTiles> create(const std::string& folder,
                                                  const std::string& format,
                                                  double side_m);

    /// Adds points: x, y, z [m, world], station and mixed flag of each point, one point after the
    /// other.
    [[nodiscard]] Status add(std::span<const float> values);
    [[nodiscard]] Status finish(const ScanOrigin& origin);

    [[nodiscard]] std::int64_t points() const noexcept { return points_; }
    [[nodiscard]] int tiles() const noexcept { return static_cast<int>(tiles_.size()); }

  private:
    struct Tile {
        io::CloudWriter writer;
        io::PointCloud block;  ///< points that are not written yet
        std::int64_t points = 0;
    };
    using Place = std::pair<int, int>;

    ScanTiles(std::string folder, std::string format, double side_m)
        : folder_(std::move(folder)), format_(std::move(format)), side_m_(side_m) {}
    [[nodiscard]] std::string name_of(const Place& place) const;
    [[nodiscard]] Result<Tile*> tile_at(const Place& place);
    [[nodiscard]] Status flush(Tile& tile);

    std::string folder_;
    std::string format_;
    double side_m_;
    std::map<Place, Tile> tiles_;
    std::int64_t points_ = 0;
};

}  // namespace surefoot::app
