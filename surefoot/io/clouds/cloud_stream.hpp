// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/result.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"

namespace surefoot::io {

/// Reads the points of a cloud file block by block, for clouds larger than the memory. Binary PLY
/// and PCD, LAS, and text with one point per line are read in pieces. Other files of read_cloud are
/// read whole, such as VTK, text PLY and PCD, compressed PCD, and PLY vertices with lists.
class CloudStream {
  public:
    [[nodiscard]] static Result<CloudStream> open(const std::string& path);
    ~CloudStream();
    CloudStream(CloudStream&&) noexcept;
    CloudStream& operator=(CloudStream&&) noexcept;

    /// Returns the next points with all their values; no points at the end.
    [[nodiscard]] Result<PointCloud> next();
    /// Restarts at the first point.
    void rewind();
    /// Calls `use` for all blocks, from the first point on. `use` takes a PointCloud& and returns a
    /// Status; a status that is not success ends the loop.
    template <typename Use>
    [[nodiscard]] Status each_block(const Use& use) {
        rewind();
        while (true) {
            auto block = next();
            if (!block) return block.error();
            if (block->points_m.empty()) return {};
            if (Status status = use(*block); !status) return status;
        }
    }
    /// Returns the number of points; no value for text with one point per line.
    [[nodiscard]] std::optional<std::uint64_t> points() const;
    /// Returns notes about contents of the file that the blocks do not keep, one sentence each. The
    /// notes cover the part that is read so far. PointCloud::notes of a block is empty.
    [[nodiscard]] std::vector<std::string> notes() const;

  private:
    class Part;
    explicit CloudStream(std::unique_ptr<Part> part);
    std::unique_ptr<Part> part_;

    class Rows;
    class Lines;
    class Whole;
};

/// Origin for float coordinates. A float resolves 0.06 mm at 1 km, but only half a metre in a
/// national grid. From 1 km on, an axis therefore starts at the multiple of 100 m nearest to the
/// first point. Near this point the shift changes no digit of a coordinate that was a float.
[[nodiscard]] Eigen::Vector3d shift_for(const Eigen::Vector3d& first_m);

/// Points as floats relative to a shift.
struct ShiftedCloud {
    Eigen::Vector3d shift_m = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3f> points_m;  ///< points minus the shift
    std::int64_t skipped = 0;               ///< number of left-out points (not finite)
};

/// Converts points to floats block by block. The shift comes from the first finite point, unless
/// the caller gives a shift. Fails on a point more than 100 km from the shift along an axis.
class ShiftedReader {
  public:
    ShiftedReader(std::string path, std::optional<Eigen::Vector3d> shift_m)
        : path_(std::move(path)), shift_m_(shift_m) {}

    /// Appends the finite points of a block to `out`.
    [[nodiscard]] Status add(const PointCloud& block, std::vector<Eigen::Vector3f>& out);
    [[nodiscard]] Eigen::Vector3d shift_m() const {
        return shift_m_.value_or(Eigen::Vector3d::Zero());
    }
    [[nodiscard]] std::int64_t skipped() const noexcept { return skipped_; }

  private:
    /// Shifts one point; no value if the point is not finite.
    [[nodiscard]] Result<std::optional<Eigen::Vector3f>> shifted(const Eigen::Vector3d& p_m);

    std::string path_;
    std::optional<Eigen::Vector3d> shift_m_;
    std::int64_t skipped_ = 0;
};

/// Reads all points of a file; the result takes 12 bytes of memory per point.
[[nodiscard]] Result<ShiftedCloud> read_shifted(
    const std::string& path, const std::optional<Eigen::Vector3d>& shift_m = std::nullopt);

}  // namespace surefoot::io
