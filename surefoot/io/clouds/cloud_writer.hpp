// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "surefoot/core/result.hpp"
#include "surefoot/io/clouds/point_cloud.hpp"

namespace surefoot::io {

/// Writes a cloud file block by block: .ply, .pcd (both binary), or .xyz .asc .txt .csv as text.
/// The file grows beside its target ("F.ply.part") and is renamed when it is finished. The
/// destructor removes an unfinished file.
class CloudWriter {
  public:
    /// Fails on an unknown extension and on errors of the operating system.
    [[nodiscard]] static Result<CloudWriter> create(const std::string& path,
                                                    const CloudFormat& format = {});
    ~CloudWriter();
    CloudWriter(CloudWriter&& other) noexcept;
    CloudWriter& operator=(CloudWriter&&) = delete;

    /// Appends points. All blocks must have the colours and scalars of the first block, with equal
    /// types, or `add` fails. Coordinates are doubles if the format or the first block needs them.
    [[nodiscard]] Status add(const PointCloud& block);
    [[nodiscard]] Status finish();
    [[nodiscard]] std::int64_t points() const noexcept { return points_; }
    /// Describes contents of the blocks that the format cannot store, one sentence each.
    [[nodiscard]] const std::vector<std::string>& notes() const noexcept { return notes_; }

  private:
    enum class Kind : std::uint8_t { ply, pcd, text };
    CloudWriter(std::string path, Kind kind, const CloudFormat& format, int descriptor)
        : path_(std::move(path)), kind_(kind), format_(format), descriptor_(descriptor) {}
    [[nodiscard]] std::string part_path() const { return path_ + ".part"; }
    [[nodiscard]] std::string head(std::int64_t points) const;
    void note_losses(const PointCloud& block);

    std::string path_;
    Kind kind_;
    CloudFormat format_;
    int descriptor_ = -1;
    std::string head_;  ///< header of the first block
    PointCloud first_;  ///< first block without its points; gives the layout of all blocks
    std::vector<std::string> notes_;
    std::int64_t points_ = 0;
    std::int64_t size_ = 0;
};

}  // namespace surefoot::io
